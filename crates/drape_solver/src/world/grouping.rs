//! Forms islands: groups what could touch within a step, directly or through others.

use glam::Vec3;

use crate::union_find::Groups;
use crate::world::bounds::Bounds;
use crate::world::kind::Kind;

/// Something on its way into an island.
#[derive(Clone, Copy, Debug)]
pub struct Member<K> {
    /// Its place in the order of creation, unique among all members. Islands and their members come in this order, so that
    /// keys do not matter to the result.
    pub order: u64,
    /// The name that the caller knows it by.
    pub key: K,
    /// Its kind. Obstacles join what they touch, and are in no island themselves.
    pub kind: Kind,
    /// The box that it does not leave within the step.
    pub bounds: Bounds,
}

impl<K> Member<K> {
    fn may_touch(&self, other: &Self) -> bool {
        self.kind.touches(other.kind) && self.bounds.overlaps(other.bounds)
    }
}

/// Groups members whose boxes meet into islands. Keeps its memory from step to step.
#[derive(Clone, Debug)]
pub struct Grouping<K> {
    members: Vec<Member<K>>,
    groups: Groups,
    /// Members in order of where their boxes begin, and those whose boxes reach on.
    sweep: Vec<u32>,
    open: Vec<u32>,
    /// The island of each group, by the group's first member.
    island_of: Vec<u32>,
}

impl<K> Default for Grouping<K> {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            groups: Groups::default(),
            sweep: Vec::new(),
            open: Vec::new(),
            island_of: Vec::new(),
        }
    }
}

impl<K> Grouping<K> {
    /// Takes all members out.
    pub fn clear(&mut self) {
        self.members.clear();
    }

    /// Adds a member.
    pub fn push(&mut self, member: Member<K>) {
        self.members.push(member);
    }

    /// Groups the members and returns the number of islands. Calls `place` with the island's number for each body and ball,
    /// in order of creation; an island's number is new if it equals the number of islands so far.
    pub fn form(&mut self, mut place: impl FnMut(usize, &Member<K>)) -> usize {
        self.drop_far_obstacles();
        self.members.sort_unstable_by_key(|member| member.order);
        self.groups.reset(self.members.len());
        self.join_neighbours();
        self.island_of.clear();
        self.island_of.resize(self.members.len(), NO_ISLAND);
        let mut count = 0;
        for (i, member) in self.members.iter().enumerate() {
            if member.kind == Kind::Obstacle {
                continue;
            }
            let island = &mut self.island_of[self.groups.root(i as u32) as usize];
            if *island == NO_ISLAND {
                *island = count;
                count += 1;
            }
            place(*island as usize, member);
        }
        count as usize
    }

    /// Takes out the obstacles that are far from all bodies and balls.
    fn drop_far_obstacles(&mut self) {
        let is_obstacle = |member: &Member<K>| member.kind == Kind::Obstacle;
        let others = self.members.iter().filter(|member| !is_obstacle(member)).map(|member| member.bounds);
        // A box that is not a number does not even meet itself.
        let all = others.filter(|bounds| bounds.overlaps(*bounds)).fold(Bounds::EMPTY, Bounds::joined);
        self.members.retain(|member| !is_obstacle(member) || member.bounds.overlaps(all));
    }

    /// Joins the members that may touch each other, by a sweep along the axis on which they lie farthest apart: each box is
    /// compared with those that have begun before it and not yet ended.
    fn join_neighbours(&mut self) {
        let Self { members, groups, sweep, open, .. } = self;
        let axis = widest_axis(members);
        let begin = |member: u32| members[member as usize].bounds.low[axis];
        sweep.clear();
        sweep.extend(0..members.len() as u32);
        sweep.sort_unstable_by(|&a, &b| begin(a).total_cmp(&begin(b)).then(a.cmp(&b)));
        open.clear();
        for &next in sweep.iter() {
            let member = &members[next as usize];
            open.retain(|&other| members[other as usize].bounds.high[axis] >= member.bounds.low[axis]);
            for &other in open.iter() {
                if member.may_touch(&members[other as usize]) {
                    groups.join(next, other);
                }
            }
            open.push(next);
        }
    }
}

/// The island of a group that has none yet.
const NO_ISLAND: u32 = u32::MAX;

/// The axis on which the members lie farthest apart.
fn widest_axis<K>(members: &[Member<K>]) -> usize {
    let corners = members.iter().map(|member| member.bounds.low);
    let low = corners.clone().fold(Vec3::INFINITY, Vec3::min);
    let size = corners.fold(Vec3::NEG_INFINITY, Vec3::max) - low;
    (1..3).fold(0, |widest, axis| if size[axis] > size[widest] { axis } else { widest })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOTH: Kind = Kind::Body { has_self_contact: false };
    const LAYERED: Kind = Kind::Body { has_self_contact: true };

    /// The islands of members of these kinds, each from `x` to `x + 1`, older ones first.
    fn islands(members: &[(Kind, f32)]) -> Vec<Vec<usize>> {
        let mut grouping = Grouping::default();
        for (key, &(kind, x)) in members.iter().enumerate().rev() {
            let bounds = Bounds::new(Vec3::X * x, Vec3::new(x + 1.0, 1.0, 1.0));
            grouping.push(Member { order: key as u64, key, kind, bounds });
        }
        let mut islands = Vec::new();
        let count = grouping.form(|island, member| {
            islands.resize(islands.len().max(island + 1), Vec::new());
            islands[island].push(member.key);
        });
        assert_eq!(count, islands.len());
        islands
    }

    #[test]
    fn what_is_apart_is_in_islands_of_its_own_in_order_of_creation() {
        assert_eq!(islands(&[(CLOTH, 9.0), (Kind::Ball, 0.0), (CLOTH, 4.0)]), [[0], [1], [2]]);
        assert!(islands(&[]).is_empty());
    }

    #[test]
    fn chains_of_contacts_make_one_island() {
        let row =
            [(Kind::Ball, 2.7), (Kind::Ball, 0.0), (Kind::Ball, 1.8), (Kind::Ball, 0.9), (Kind::Ball, 9.0)];
        assert_eq!(islands(&row), [vec![0, 1, 2, 3], vec![4]]);
    }

    #[test]
    fn bodies_join_each_other_only_with_self_contact_and_always_through_a_ball() {
        assert_eq!(islands(&[(CLOTH, 0.0), (CLOTH, 0.5)]).len(), 2);
        assert_eq!(islands(&[(CLOTH, 0.0), (LAYERED, 0.5)]).len(), 2);
        assert_eq!(islands(&[(LAYERED, 0.0), (LAYERED, 0.5)]), [[0, 1]]);
        assert_eq!(islands(&[(CLOTH, 0.0), (CLOTH, 0.5), (Kind::Ball, 0.2)]), [[0, 1, 2]]);
    }

    #[test]
    fn obstacles_join_what_they_touch_and_are_in_no_island() {
        for obstacle in [0, 1, 2] {
            let mut members = vec![(CLOTH, 0.0), (CLOTH, 1.4)];
            members.insert(obstacle, (Kind::Obstacle, 0.7));
            let found = islands(&members);
            assert_eq!(found.len(), 1, "obstacle created as number {obstacle}");
            assert!(!found[0].contains(&obstacle) && found[0].len() == 2);
        }
        assert!(islands(&[(Kind::Obstacle, 0.0), (Kind::Obstacle, 0.0)]).is_empty());
    }

    #[test]
    fn neither_what_is_far_away_nor_what_is_nowhere_keeps_an_obstacle_from_joining_others() {
        let [near, far] = [0.7, 1e3].map(|x| (Kind::Obstacle, x));
        let nowhere = (CLOTH, f32::NAN);
        assert_eq!(islands(&[nowhere, (CLOTH, 0.0), (CLOTH, 1.4), far, near]), [vec![0], vec![1, 2]]);
        assert_eq!(islands(&[far, (CLOTH, 0.0), near, (CLOTH, 1.4), nowhere]), [vec![1, 3], vec![4]]);
    }
}
