//! Particles against obstacles.
//!
//! Each step lists the cells with particles that could reach an obstacle. Each projection moves the particles that lie
//! inside out along the normal, to the nearest point of the surface.
//!
//! ```text
//!      o  particle
//!   ---|----------- thickness
//!   ===|=========== surface     depth = thickness - distance; moved by depth along the normal
//!      x
//! ```
//!
//! `apply_friction` repeats `Friction::slip_taken` (`state/friction.rs`) in lanes.
//!
//! Design: `docs/design/contacts.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::broad_phase::obstacle_search::{Candidate, CandidateLists};
use crate::constants::LEAST_OVERLAP;
use crate::contact::depenetration::PushOutRate;
use crate::contact::obstacle_push::add_to;
use crate::contact::support::Supports;
use crate::geometry::pose::Pose;
use crate::geometry::surface_lanes::{LanePlanes, LanePose, Solid};
use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::columns::{Cell, LANES};
use crate::simd::lanes::{Lanes3, load};
use crate::state::friction::Friction;
use crate::state::layout::Layout;
use crate::state::obstacle::Obstacle;
use crate::state::substep::Substep;

/// The particles of one body that may touch obstacles in this step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObstacleContacts {
    pub layout: Layout,
    /// Obstacles near the body, by index.
    pub near: Vec<u32>,
    pub groups: Vec<ObstacleGroup>,
    pub candidates: Vec<Candidate>,
    /// Candidates that another thread finds.
    pub found_by_helper: Vec<Candidate>,
    /// One for each candidate.
    pub pushes: Vec<Pushes>,
    /// Displacement in metres that each candidate got from its obstacle in this substep. Empty if no obstacle asks for
    /// it.
    pub given: Vec<Cell>,
    pub planes: Vec<LanePlanes>,
    pub supports: Supports,
    /// Index of each strip's first candidate; one more at the end.
    pub first_of_strip: Vec<u32>,
}

/// An obstacle that has candidates.
#[derive(Clone, Debug)]
pub(crate) struct ObstacleGroup {
    pub obstacle: usize,
    pub friction: Friction,
    pub is_moving: bool,
    /// True if contacts move it: see `particle_dynamic.rs`.
    pub is_dynamic: bool,
    /// True if it asks for the reactions to its pushes.
    pub is_asking: bool,
    /// Its pose at the start of the step, in the body's coordinates.
    pub pose: Pose,
}

/// The pushes on the particles of a candidate in this substep.
#[derive(Clone, Debug)]
pub(crate) struct Pushes {
    /// Depth that motion made, summed over the projections of the substep, in metres.
    pub depth: [f32; LANES],
    /// Metres of an initial overlap that may be left at the end of the substep: see
    /// [`depenetration`](crate::contact::depenetration). Negative until the first projection.
    pub left: [f32; LANES],
    /// World normals of the last projection.
    pub normal: Cell,
}

impl Pushes {
    pub const NONE: Self = Self {
        depth: [0.0; LANES],
        left: [-1.0; LANES],
        normal: Cell { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] },
    };
}

impl ObstacleContacts {
    /// Forgets the last step's candidates; the body's particles now have this layout.
    pub fn clear(&mut self, layout: &Layout) {
        self.layout = layout.clone();
        self.groups.clear();
        self.candidates.clear();
        self.planes.clear();
        self.near.clear();
    }

    /// The lists for a search to fill.
    pub fn lists(&mut self) -> CandidateLists<'_> {
        CandidateLists { candidates: &mut self.candidates, planes: &mut self.planes }
    }

    /// Particles that obstacles pushed out in the last substep: the particle's index, the unit normal of the
    /// surface in the world, and the depth in metres, summed over the projections of the substep.
    pub fn pushed_particles(&self) -> impl Iterator<Item = (usize, Vec3, f32)> + '_ {
        self.pushed().filter_map(|(_, slot, normal, depth)| Some((self.layout.index(slot)?, normal, depth)))
    }

    /// Obstacles that have candidates, by index.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        self.groups.iter().map(|group| group.obstacle)
    }

    /// Particles that were pushed in the last substep: the obstacle, the particle's slot, the unit normal of the
    /// surface in the world, and the depth in metres, summed over the projections of the substep.
    pub fn pushed(&self) -> impl Iterator<Item = (usize, usize, Vec3, f32)> + '_ {
        let candidates = self.candidates.iter().zip(&self.pushes);
        candidates.filter(|(candidate, _)| candidate.is_touching).flat_map(move |(candidate, pushes)| {
            let obstacle = self.groups[usize::from(candidate.group)].obstacle;
            let touching = (0..LANES).filter(|&lane| pushes.depth[lane] > 0.0);
            touching.map(move |lane| {
                (obstacle, candidate.slot(lane), pushes.normal.get(lane), pushes.depth[lane])
            })
        })
    }

    /// Marks the obstacles that ask for their reactions, and makes room for the sums. Returns true if there are any. It
    /// comes after the search.
    pub fn mark_asking(&mut self, asks: impl Fn(usize) -> bool) -> bool {
        for group in &mut self.groups {
            group.is_asking = asks(group.obstacle);
        }
        let is_any = self.groups.iter().any(|group| group.is_asking);
        if is_any {
            self.given.reserve(self.pushes.capacity().saturating_sub(self.given.len()));
        }
        self.given.resize(if is_any { self.candidates.len() } else { 0 }, Cell::default());
        is_any
    }

    /// The pushes of obstacles that ask on particles in the last substep: the obstacle, the particle's slot, and the
    /// change of its displacement in metres.
    pub fn given(&self) -> impl Iterator<Item = (usize, usize, Vec3)> + '_ {
        let asking = self.candidates.iter().zip(&self.given).filter_map(|(candidate, given)| {
            let group = &self.groups[usize::from(candidate.group)];
            (candidate.is_touching && group.is_asking).then_some((candidate, group.obstacle, given))
        });
        asking.flat_map(|(candidate, obstacle, given)| {
            let pushed =
                (0..LANES).map(|lane| (lane, given.get(lane))).filter(|(_, given)| *given != Vec3::ZERO);
            pushed.map(move |(lane, given)| (obstacle, candidate.slot(lane), given))
        })
    }

    /// Sorts the candidates into the order in which a sweep takes them, and records the first one of each strip.
    pub fn sort(&mut self) {
        let Self { layout, groups, candidates, first_of_strip, pushes, supports, .. } = self;
        first_of_strip.clear();
        let (cells_of_strip, strips) = layout.strips();
        if !candidates.is_empty() {
            // Reserves for all cells at once, so that cells that come near one by one do not allocate one by one.
            let cells = layout.cells();
            candidates.reserve(cells.saturating_sub(candidates.len()));
            pushes.reserve(cells.saturating_sub(pushes.len()));
            first_of_strip.reserve(strips + 1);
            // The search for a single obstacle finds them in order.
            if !candidates.is_sorted_by_key(|c| c.cell) {
                let strip_of = |c: &Candidate| c.cell as usize / cells_of_strip;
                candidates.sort_unstable_by_key(|c| (strip_of(c), c.group, c.cell, c.planes));
            }
            for strip in 0..=strips {
                let is_above = |c: &Candidate| (c.cell as usize) < strip * cells_of_strip;
                first_of_strip.push(candidates.partition_point(is_above) as u32);
            }
        }
        pushes.resize(candidates.len(), Pushes::NONE);
        supports.sort(groups, candidates, pushes.capacity());
    }

    /// The contacts of all strips.
    pub fn rows(&mut self) -> ObstacleRows<'_> {
        let Self { groups, candidates, pushes, given, planes, first_of_strip, .. } = self;
        ObstacleRows { groups, planes, first_of_strip, before: 0, candidates, pushes, given }
    }
}

/// The contacts of some strips of a body with obstacles.
pub(crate) struct ObstacleRows<'a> {
    groups: &'a [ObstacleGroup],
    planes: &'a [LanePlanes],
    /// Indices of the whole body, as are the cells of candidates.
    first_of_strip: &'a [u32],
    /// The number of candidates in the strips above.
    before: usize,
    candidates: &'a mut [Candidate],
    pushes: &'a mut [Pushes],
    /// Empty if no obstacle asks.
    given: &'a mut [Cell],
}

/// The contacts of some strips with one obstacle.
struct GroupRows<'a> {
    candidates: &'a mut [Candidate],
    pushes: &'a mut [Pushes],
    given: &'a mut [Cell],
}

/// Splits the sums of pushes in two; an empty list gives two empty ones.
#[inline(always)]
fn split_given(given: &mut [Cell], middle: usize) -> (&mut [Cell], &mut [Cell]) {
    given.split_at_mut(middle.min(given.len()))
}

/// The data that all contacts of one projection share.
pub(crate) struct ObstacleProjection<'a> {
    obstacles: &'a [Obstacle],
    origin: Vec3,
    /// The substep, from 0, and the number of substeps.
    substep: u32,
    substeps: u32,
    thickness: f32,
    rate: PushOutRate,
    /// True if it is the first projection of the substep.
    is_first: bool,
}

impl<'a> ObstacleProjection<'a> {
    pub fn new(rest: &BodyColumns<'a>, substep: u32, is_first: bool) -> Self {
        let Substep { obstacles, count: substeps, .. } = rest.substep;
        let rate = PushOutRate::new(rest.substep.duration, substeps, substep);
        Self { obstacles, origin: rest.origin, substep, substeps, thickness: rest.thickness, rate, is_first }
    }

    /// The poses of a group's obstacle at the start and the end of the substep.
    #[inline(always)]
    fn poses<S: Simd>(&self, simd: S, group: &ObstacleGroup) -> [LanePose<S>; 2] {
        if !group.is_moving {
            return [LanePose::new(simd, &group.pose); 2];
        }
        let obstacle = &self.obstacles[group.obstacle];
        let pose = |substep| obstacle.pose_at(substep as f32 / self.substeps as f32, self.origin);
        [LanePose::new(simd, &pose(self.substep)), LanePose::new(simd, &pose(self.substep + 1))]
    }
}

impl ObstacleRows<'_> {
    /// True if no particle can touch an obstacle in this step.
    pub fn is_empty(&self) -> bool {
        self.candidates.is_empty()
    }

    /// The number of candidates of the body above `strip`.
    pub fn candidates_above(&self, strip: usize) -> usize {
        self.first_of_strip.get(strip).map_or(0, |&first| first as usize)
    }

    /// Splits the contacts in two above `strip`.
    pub fn split_at(&mut self, strip: usize) -> (ObstacleRows<'_>, ObstacleRows<'_>) {
        let &mut Self { groups, planes, first_of_strip, before, .. } = self;
        let middle = first_of_strip.get(strip).map_or(before, |&first| first as usize);
        let (candidates, others) = self.candidates.split_at_mut(middle - before);
        let (pushes, other_pushes) = self.pushes.split_at_mut(middle - before);
        let (given, other_given) = split_given(self.given, middle - before);
        (
            ObstacleRows { groups, planes, first_of_strip, before, candidates, pushes, given },
            ObstacleRows {
                groups,
                planes,
                first_of_strip,
                before: middle,
                candidates: others,
                pushes: other_pushes,
                given: other_given,
            },
        )
    }

    /// The candidates of some strips with their pushes, obstacle by obstacle within a strip.
    #[inline(always)]
    fn of_strips(&mut self, strips: Range<usize>) -> impl Iterator<Item = GroupRows<'_>> {
        let place = |strip: usize| self.first_of_strip[strip] as usize - self.before;
        let range = place(strips.start)..place(strips.end);
        let mut pushes = &mut self.pushes[range.clone()];
        let (_, mut given) = split_given(self.given, range.start);
        self.candidates[range].chunk_by_mut(|a, b| a.group == b.group).map(move |candidates| {
            let (own, others) = core::mem::take(&mut pushes).split_at_mut(candidates.len());
            pushes = others;
            let (own_given, others) = split_given(core::mem::take(&mut given), candidates.len());
            given = others;
            GroupRows { candidates, pushes: own, given: own_given }
        })
    }

    /// Moves every particle of these strips that lies inside an obstacle out to its surface. The columns that move begin
    /// with `first_cell`.
    #[inline(always)]
    pub fn project<S: Simd>(
        &mut self,
        simd: S,
        strips: Range<usize>,
        moving: &mut MovingColumns,
        first_cell: usize,
        context: &ObstacleProjection,
    ) {
        let (groups, planes) = (self.groups, self.planes);
        for GroupRows { candidates, pushes, given } in self.of_strips(strips) {
            let group = &groups[usize::from(candidates[0].group)];
            if group.is_dynamic {
                continue;
            }
            let [before, now] = context.poses(simd, group);
            let shape = context.obstacles[group.obstacle].shape();
            for (place, (candidate, pushes)) in candidates.iter_mut().zip(pushes).enumerate() {
                let solid = match candidate.planes {
                    Some(place) => Solid::Planes(&planes[place as usize]),
                    None => Solid::Formula(shape),
                };
                let contact = CellContact { solid, before, now, is_moving: group.is_moving, context };
                if !group.is_asking {
                    contact.project(simd, candidate, pushes, moving, first_cell);
                    continue;
                }
                let cell = candidate.cell as usize - first_cell;
                let before = moving.displacement[cell];
                if context.is_first {
                    given[place] = Cell::default();
                }
                contact.project(simd, candidate, pushes, moving, first_cell);
                add_to(&mut given[place], &before, &moving.displacement[cell]);
            }
        }
    }

    /// Friction: takes tangential displacement from every particle of these strips that was projected. It comes last in
    /// the substep, after displacements have followed positions.
    #[inline(always)]
    pub fn apply_friction<S: Simd>(
        &mut self,
        simd: S,
        strips: Range<usize>,
        moving: &mut MovingColumns,
        first_cell: usize,
        context: &ObstacleProjection,
    ) {
        let groups = self.groups;
        for GroupRows { candidates, pushes, given } in self.of_strips(strips) {
            let group = &groups[usize::from(candidates[0].group)];
            if group.is_dynamic || group.friction == Friction::default() {
                continue;
            }
            let [before, now] = context.poses(simd, group);
            let touching = candidates.iter().zip(pushes).enumerate();
            for (place, (candidate, pushes)) in touching.filter(|(_, (candidate, _))| candidate.is_touching) {
                let depth = load(simd, &pushes.depth);
                let is_touching = depth.simd_gt(f32x16::splat(simd, 0.0));
                let cell = candidate.cell as usize - first_cell;
                let position = Lanes3::load(simd, &moving.position[cell]);
                let displacement = Lanes3::load(simd, &moving.displacement[cell]);
                let mut slip = displacement;
                if group.is_moving {
                    // The way of the surface under the particle is that of the same local point.
                    slip = slip.minus(position.minus(before.point_to_world(now.to_local(position))));
                }
                let normal = Lanes3::load(simd, &pushes.normal);
                // Coulomb: at most the coefficient times the depth, and never more than the slip. See `friction.rs`.
                let tangential = slip.minus(normal.times(slip.dot(normal)));
                let length = tangential.dot(tangential).sqrt();
                let is_slipping = length.simd_gt(depth * group.friction.sticking);
                let most = depth * group.friction.kinetic;
                let one = f32x16::splat(simd, 1.0);
                let part = is_slipping.select(most / is_slipping.select(length, one), one);
                let taken = tangential.times(part);
                position.minus(taken).or(is_touching, position).store(&mut moving.position[cell]);
                let before = group.is_asking.then_some(moving.displacement[cell]);
                displacement.minus(taken).or(is_touching, displacement).store(&mut moving.displacement[cell]);
                if let Some(before) = before {
                    add_to(&mut given[place], &before, &moving.displacement[cell]);
                }
            }
        }
    }
}

/// One obstacle against the particles of a cell in one projection.
struct CellContact<'a, S: Simd> {
    solid: Solid<'a>,
    before: LanePose<S>,
    now: LanePose<S>,
    is_moving: bool,
    context: &'a ObstacleProjection<'a>,
}

impl<S: Simd> CellContact<'_, S> {
    #[inline(always)]
    fn project(
        &self,
        simd: S,
        candidate: &mut Candidate,
        pushes: &mut Pushes,
        moving: &mut MovingColumns,
        first_cell: usize,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        let &ObstacleProjection { thickness, rate, is_first, .. } = self.context;
        let cell = candidate.cell as usize - first_cell;
        if is_first {
            candidate.is_touching = false;
        }
        let position = Lanes3::load(simd, &moving.position[cell]);
        if self.solid.is_beyond(simd, position, self.now, thickness) {
            return;
        }
        let (distance, normal) = self.solid.surface_at(simd, position, self.now);
        let depth = f32x16::splat(simd, thickness) - distance;
        let lanes = mask32x16::from_bitmask(simd, u64::from(candidate.lanes));
        let is_inside = depth.simd_gt(zero) & lanes;
        if is_inside.all_false() {
            return;
        }
        if !candidate.is_touching {
            *pushes = Pushes::NONE;
            candidate.is_touching = true;
        }
        let displacement = Lanes3::load(simd, &moving.displacement[cell]);
        let integrated = Lanes3::load(simd, &moving.integrated[cell]);
        let travel = displacement.plus(position.minus(integrated));
        let mut outward = travel;
        if self.is_moving {
            let local = self.now.to_local(position);
            outward = outward.minus(position.minus(self.before.point_to_world(local)));
        }
        // Unless the tangent plane rules out an overlap at the start of the substep, the shape is queried there.
        let may_overlap = (depth + outward.dot(normal)).simd_gt(LEAST_OVERLAP) & is_inside;
        let (mut with_velocity, mut out) = (depth, depth);
        if may_overlap.any_true() {
            let (distance, _) = self.solid.surface_at(simd, position.minus(travel), self.before);
            let overlap = f32x16::splat(simd, thickness) - distance;
            let overlap = overlap.simd_gt(zero).select(overlap, zero);
            let initial = may_overlap.select(overlap.simd_lt(depth).select(overlap, depth), zero);
            let known = load(simd, &pushes.left);
            let left = known.simd_lt(zero).select(rate.left_in_lanes(simd, initial), known);
            let taken = initial - left;
            with_velocity = depth - initial;
            out = with_velocity + taken.simd_gt(zero).select(taken, zero);
            pushes.left = may_overlap.select(left, known).to_array();
        }
        let out = normal.times(out);
        let moved = displacement.plus(normal.times(with_velocity));
        moved.or(is_inside, displacement).store(&mut moving.displacement[cell]);
        position.plus(out).or(is_inside, position).store(&mut moving.position[cell]);
        integrated.plus(out).or(is_inside, integrated).store(&mut moving.integrated[cell]);
        let summed = load(simd, &pushes.depth);
        pushes.depth = is_inside.select(summed + with_velocity, summed).to_array();
        normal.or(is_inside, Lanes3::load(simd, &pushes.normal)).store(&mut pushes.normal);
    }
}
