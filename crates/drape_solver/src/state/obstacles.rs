//! The obstacles of a world, and the search for those near a box.
//!
//! Their boxes lie in a tree (parry's [`Bvh`]), which is refitted as they move. The time of a search grows with its
//! results, not with the number of obstacles. Results come in the order of the obstacles, so that nothing depends on
//! the tree's shape.
//!
//! Design: `docs/design/broad_phase.md`.

use core::fmt;
use core::ops::{Deref, Index, IndexMut};

use glam::Vec3;
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhWorkspace, TraversalAction};

use crate::constants::MAX_MAGNITUDE;
use crate::geometry::pose::Placement;
use crate::state::obstacle::Obstacle;

/// A list of obstacles with a tree of their boxes.
///
/// It reads like a slice, and indexing changes an obstacle. The next search sees every change.
///
/// ```
/// use drape_solver::glam::Vec3;
/// use drape_solver::{Environment, Obstacle, Placement, Shape};
///
/// let ball = Obstacle::new(Shape::Sphere { radius: 1.0 }, Placement::at(Vec3::X * 10.0), 0.5)?;
/// let mut environment = Environment { obstacles: vec![Obstacle::ground(), ball].into(), ..Environment::default() };
/// let mut near = Vec::new();
/// environment.obstacles.near(Vec3::ZERO, Vec3::ONE, &mut near);
/// assert_eq!(near, [0]);
///
/// near.clear();
/// environment.obstacles[1].teleport(Placement::at(Vec3::ZERO));
/// environment.obstacles.near(Vec3::ZERO, Vec3::ONE, &mut near);
/// assert_eq!(near, [0, 1]);
/// # Ok::<(), drape_solver::BuildError>(())
/// ```
#[derive(Clone, Default)]
pub struct Obstacles {
    all: Vec<Obstacle>,
    /// Box of each when it was inserted into the tree; `None` for those without bounds or out of reach.
    homes: Vec<Option<Aabb>>,
    /// The box of each that has bounds, through the whole step.
    tree: Bvh,
    /// Obstacles without bounds, in ascending order; every search finds them. One that was moved out of reach is neither here
    /// nor in the tree.
    unbounded: Vec<u32>,
    /// The obstacle last lent by a mutable borrow. Its box in the tree may be stale, so a search tests the obstacle
    /// itself.
    lent: Option<usize>,
    /// The number of changes since the last refit, which left the tree less tight or with dead branches.
    changes: usize,
    workspace: BvhWorkspace,
}

impl Obstacles {
    /// No obstacles.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an obstacle and returns its index.
    pub fn push(&mut self, obstacle: Obstacle) -> usize {
        self.settle();
        let index = self.all.len();
        self.all.push(obstacle);
        self.homes.push(None);
        self.unbounded.push(index as u32);
        self.place(index);
        index
    }

    /// Removes the obstacle at `index`. The last one takes its place and its index.
    ///
    /// # Panics
    /// If there is no such obstacle.
    pub fn swap_remove(&mut self, index: usize) -> Obstacle {
        self.settle();
        let last = self.all.len() - 1;
        self.displace(index);
        if index != last {
            self.displace(last);
        }
        let removed = self.all.swap_remove(index);
        self.homes.truncate(last);
        if index != last {
            self.note_unbounded(index);
            self.place(index);
        }
        removed
    }

    /// Takes all places to other coordinates, by a function of an index and a place of that obstacle: each is where it was, and moves on as
    /// before.
    pub fn change_coordinates(&mut self, changed: impl Fn(usize, Vec3) -> Vec3) {
        let all = core::mem::take(&mut self.all).into_iter().enumerate().map(|(index, mut obstacle)| {
            obstacle.change_coordinates(|place| changed(index, place));
            obstacle
        });
        *self = all.collect();
    }

    /// Removes all obstacles.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The obstacle at `index`, by mutable borrow.
    pub fn get_mut(&mut self, index: usize) -> Option<&mut Obstacle> {
        if self.lent != Some(index) {
            self.settle();
        }
        let obstacle = self.all.get_mut(index)?;
        self.lent = Some(index);
        Some(obstacle)
    }

    /// Moves the obstacle at `index` as [`Obstacle::move_to`] does where nothing can touch it in the coming step. No search
    /// finds it until it is moved again, so that this costs a fraction. An invalid placement is ignored. Not for obstacles with
    /// a [rigid body](Obstacle::with_rigid_body), which fly.
    ///
    /// # Panics
    /// If there is no such obstacle.
    pub fn move_out_of_reach(&mut self, index: usize, placement: Placement, dt: f32) {
        if !placement.is_valid() {
            return;
        }
        let is_lent = self.lent == Some(index);
        if is_lent || !self.all[index].is_out_of_reach() {
            self.displace(index);
            self.lent = self.lent.filter(|_| !is_lent);
        }
        self.all[index].move_out_of_reach(placement, dt);
    }

    /// Appends to `found` the indices of the obstacles whose boxes, through the whole step, overlap the box between the
    /// corners `low` and `high`: in order, each once.
    pub fn near(&self, low: Vec3, high: Vec3, found: &mut Vec<u32>) {
        self.search(low, high, found);
    }

    /// The same as [`near`](Self::near); returns the number of boxes that were tested.
    fn search(&self, low: Vec3, high: Vec3, found: &mut Vec<u32>) -> usize {
        let first = found.len();
        let (_, tests) = self.visit(low, high, |index| {
            found.push(index);
            false
        });
        found[first..].sort_unstable();
        tests
    }

    /// True if `is_wanted` holds for an obstacle whose box, through the whole step, overlaps the box between two corners.
    pub(crate) fn is_any_near(
        &self,
        low: Vec3,
        high: Vec3,
        mut is_wanted: impl FnMut(&Obstacle) -> bool,
    ) -> bool {
        self.visit(low, high, |index| is_wanted(&self.all[index as usize])).0
    }

    /// Visits the obstacles whose boxes overlap a box, in any order, until `is_last` holds. Returns if it held, and the
    /// number of boxes that were tested.
    fn visit(&self, low: Vec3, high: Vec3, mut is_last: impl FnMut(u32) -> bool) -> (bool, usize) {
        let meets = |mins: Vec3, maxs: Vec3| low.cmple(maxs).all() && high.cmpge(mins).all();
        let lent = self.lent.map(|index| index as u32);
        let mut tests = self.unbounded.len();
        if self.unbounded.iter().any(|&index| Some(index) != lent && is_last(index)) {
            return (true, tests);
        }
        if let Some(index) = lent {
            let (mins, maxs) = self.all[index as usize].swept_bounds();
            tests += 1;
            if meets(mins, maxs) && is_last(index) {
                return (true, tests);
            }
        }
        let mut is_over = false;
        self.tree.traverse(|node| {
            tests += 1;
            if !meets(node.mins(), node.maxs()) {
                return TraversalAction::Prune;
            }
            is_over = node.leaf_data().is_some_and(|index| Some(index) != lent && is_last(index));
            if is_over { TraversalAction::EarlyExit } else { TraversalAction::Continue }
        });
        (is_over, tests)
    }

    /// Updates the tree for the lent obstacle.
    fn settle(&mut self) {
        if let Some(index) = self.lent.take() {
            self.place(index);
        }
    }

    /// Updates the tree for one obstacle.
    fn place(&mut self, index: usize) {
        let (low, high) = self.all[index].swept_bounds();
        if low.cmpgt(high).any() {
            self.displace(index);
            return;
        }
        let is_bounded = low.abs().max(high.abs()).cmple(Vec3::splat(MAX_MAGNITUDE)).all();
        if !is_bounded {
            self.displace(index);
            self.note_unbounded(index);
            return;
        }
        let now = Aabb::new(low, high);
        match self.homes[index] {
            Some(_) if self.tree.leaf_node(index as u32).is_some_and(|leaf| leaf.aabb() == now) => return,
            // Its leaf keeps its place in the tree: the branches above grow now, and shrink at the next refit.
            Some(home) if overlap(&home, &now) => {}
            _ => {
                self.displace(index);
                self.homes[index] = Some(now);
            }
        }
        self.tree.insert(now, index as u32);
        self.changes += 1;
        // A refit visits all obstacles once, after as many changes as there are obstacles, so that a change stays
        // cheap.
        if self.changes > self.all.len() {
            self.tree.refit(&mut self.workspace);
            self.changes = 0;
        }
    }

    /// Removes an obstacle from the tree, or from the list of those without bounds.
    fn displace(&mut self, index: usize) {
        if self.homes[index].take().is_some() {
            self.tree.remove(index as u32);
            self.changes += 1;
        } else if let Ok(place) = self.unbounded.binary_search(&(index as u32)) {
            self.unbounded.remove(place);
        }
    }

    fn note_unbounded(&mut self, index: usize) {
        if let Err(place) = self.unbounded.binary_search(&(index as u32)) {
            self.unbounded.insert(place, index as u32);
        }
    }
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    a.mins.cmple(b.maxs).all() && a.maxs.cmpge(b.mins).all()
}

impl Deref for Obstacles {
    type Target = [Obstacle];

    fn deref(&self) -> &[Obstacle] {
        &self.all
    }
}

impl Index<usize> for Obstacles {
    type Output = Obstacle;

    fn index(&self, index: usize) -> &Obstacle {
        &self.all[index]
    }
}

impl IndexMut<usize> for Obstacles {
    fn index_mut(&mut self, index: usize) -> &mut Obstacle {
        if self.lent != Some(index) {
            self.settle();
            self.lent = (index < self.all.len()).then_some(index);
        }
        &mut self.all[index]
    }
}

impl<'a> IntoIterator for &'a Obstacles {
    type Item = &'a Obstacle;
    type IntoIter = core::slice::Iter<'a, Obstacle>;

    fn into_iter(self) -> Self::IntoIter {
        self.all.iter()
    }
}

impl FromIterator<Obstacle> for Obstacles {
    fn from_iter<I: IntoIterator<Item = Obstacle>>(obstacles: I) -> Self {
        let mut all = Self::default();
        all.extend(obstacles);
        all
    }
}

impl Extend<Obstacle> for Obstacles {
    fn extend<I: IntoIterator<Item = Obstacle>>(&mut self, obstacles: I) {
        for obstacle in obstacles {
            self.push(obstacle);
        }
    }
}

impl From<Vec<Obstacle>> for Obstacles {
    fn from(obstacles: Vec<Obstacle>) -> Self {
        obstacles.into_iter().collect()
    }
}

impl<const N: usize> From<[Obstacle; N]> for Obstacles {
    fn from(obstacles: [Obstacle; N]) -> Self {
        obstacles.into_iter().collect()
    }
}

impl fmt::Debug for Obstacles {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.debug_list().entries(&self.all).finish()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::shape::Shape;
    use crate::random::{between, cases};

    fn sphere(centre: Vec3) -> Obstacle {
        Obstacle::new(Shape::Sphere { radius: 0.4 }, Placement::at(centre), 0.5).expect("valid")
    }

    /// A square of obstacles, a metre from each other.
    fn field(side: usize) -> Obstacles {
        (0..side * side).map(|i| sphere(Vec3::new((i % side) as f32, 0.0, (i / side) as f32))).collect()
    }

    /// The obstacles that a search one by one finds.
    fn found_one_by_one(obstacles: &Obstacles, low: Vec3, high: Vec3) -> Vec<u32> {
        let is_near = |obstacle: &Obstacle| {
            let (mins, maxs) = obstacle.swept_bounds();
            low.cmple(maxs).all() && high.cmpge(mins).all()
        };
        (0..obstacles.len() as u32).filter(|&i| is_near(&obstacles[i as usize])).collect()
    }

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(between(-4.0, 4.0)).prop_map(Vec3::from_array)
    }

    #[derive(Clone, Debug)]
    enum Change {
        Push(Obstacle),
        Move(usize, Vec3),
        MoveOutOfReach(usize, Vec3),
        Teleport(usize, Vec3),
        Replace(usize, Obstacle),
        Remove(usize),
    }

    fn obstacle() -> impl Strategy<Value = Obstacle> {
        let shape = prop_oneof![
            4 => between(0.1, 1.0).prop_map(|radius| Shape::Sphere { radius }),
            3 => prop::array::uniform3(between(0.1, 1.5))
                .prop_map(|half| Shape::Cuboid { half_extents: Vec3::from_array(half) }),
            1 => Just(Shape::HalfSpace { normal: Vec3::Y }),
            1 => Just(Shape::Container { half_extents: Vec3::ONE }),
        ];
        (shape, point()).prop_map(|(shape, at)| Obstacle::new(shape, Placement::at(at), 0.5).expect("valid"))
    }

    fn change() -> impl Strategy<Value = Change> {
        prop_oneof![
            3 => obstacle().prop_map(Change::Push),
            3 => (any::<usize>(), point()).prop_map(|(i, to)| Change::Move(i, to)),
            2 => (any::<usize>(), point()).prop_map(|(i, to)| Change::MoveOutOfReach(i, to)),
            1 => (any::<usize>(), point()).prop_map(|(i, to)| Change::Teleport(i, to * 1e3)),
            1 => (any::<usize>(), obstacle()).prop_map(|(i, to)| Change::Replace(i, to)),
            2 => any::<usize>().prop_map(Change::Remove),
        ]
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_search_of_random_obstacles_finds_what_looking_at_each_finds(
            changes in prop::collection::vec(change(), 1..120),
            corners in prop::array::uniform2(point()),
        ) {
            let mut obstacles = Obstacles::new();
            let (low, high) = (corners[0].min(corners[1]), corners[0].max(corners[1]));
            for change in changes {
                let count = obstacles.len().max(1);
                match change {
                    Change::Push(obstacle) => {
                        obstacles.push(obstacle);
                    }
                    _ if obstacles.is_empty() => {}
                    Change::Move(i, to) => obstacles[i % count].move_to(Placement::at(to), 0.1),
                    Change::MoveOutOfReach(i, to) => {
                        obstacles.move_out_of_reach(i % count, Placement::at(to), 0.1);
                    }
                    Change::Teleport(i, to) => obstacles[i % count].teleport(Placement::at(to)),
                    Change::Replace(i, other) => obstacles[i % count] = other,
                    Change::Remove(i) => {
                        obstacles.swap_remove(i % count);
                    }
                }
                let mut found = Vec::new();
                obstacles.near(low, high, &mut found);
                prop_assert_eq!(found, found_one_by_one(&obstacles, low, high));
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "it searches among ten thousand obstacles")]
    fn a_search_looks_at_what_is_near_only() {
        let mut found = Vec::new();
        let middle = Vec3::new(50.0, 0.0, 50.0);
        let tests = |obstacles: &Obstacles, found: &mut Vec<u32>| {
            found.clear();
            obstacles.search(middle - 0.7, middle + 0.7, found)
        };
        let mut obstacles = field(100);
        let before = tests(&obstacles, &mut found);
        assert!(before < 200, "{before} tests among ten thousand obstacles");
        assert_eq!(found.len(), 9);
        // All obstacles move far, each in its own direction: the tree must stay as good.
        for _ in 0..20 {
            for i in 0..obstacles.len() {
                let Placement { translation, .. } = obstacles[i].placement();
                let way = Vec3::new((i * 7919 % 201) as f32 - 100.0, 0.0, (i * 104_729 % 201) as f32 - 100.0);
                let to = translation + way * 0.01;
                obstacles[i].move_to(Placement::at(to), 1.0 / 60.0);
            }
        }
        let after = tests(&obstacles, &mut found);
        assert!(after < 600, "{after} tests once all have moved, {before} before");
    }

    #[test]
    fn what_is_nowhere_finds_nothing() {
        let obstacles = field(3);
        let mut found = Vec::new();
        obstacles.near(Vec3::NAN, Vec3::NAN, &mut found);
        obstacles.near(Vec3::INFINITY, Vec3::NEG_INFINITY, &mut found);
        assert!(found.is_empty());
    }
}
