//! Particles against obstacles.
//!
//! Once a step the cells with particles that could reach an obstacle are listed; each projection moves those that lie
//! inside out along the normal, to the nearest point of the surface.
//!
//! ```text
//!      o  particle
//!   ---|----------- thickness
//!   ===|=========== surface     depth = thickness - distance; moved by depth along the normal
//!      x
//! ```

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::body::{Body, BodyContext};
use crate::columns::{Cell, LANES};
use crate::constants::LEAST_OVERLAP;
use crate::friction::combined;
use crate::isa::{Isa, Kernel};
use crate::lanes::{Lanes3, load};
use crate::layout::Layout;
use crate::obstacle::Obstacle;
use crate::overlap::Pace;
use crate::particles::Particles;
use crate::pose::Pose;
use crate::shape::{Shape, container_walls};
use crate::surface_lanes::{LanePlanes, LanePose, Solid};

/// The particles of one body that may touch obstacles in this step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ObstacleContacts {
    layout: Layout,
    groups: Vec<Group>,
    candidates: Vec<Candidate>,
    /// One for each candidate.
    pushes: Vec<Pushes>,
    planes: Vec<LanePlanes>,
    /// For each group the candidates before each row of cells.
    first_of_row: Vec<u32>,
}

/// Candidates of one obstacle, and its pose at the ends of the current substep.
#[derive(Clone, Debug)]
struct Group {
    obstacle: usize,
    /// Place of its first row in the list of rows.
    rows: usize,
    friction: f32,
    is_moving: bool,
    before: Pose,
    now: Pose,
}

/// The particles of one cell that may touch one obstacle.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    cell: u32,
    lanes: u16,
    /// Whether any of them has been pushed in this substep.
    is_touching: bool,
    /// The surface near each particle as a plane, by its place in the list, where asking the shape each time would be
    /// slow or wrong.
    planes: Option<u32>,
}

/// How far the particles of a candidate were pushed in this substep.
#[derive(Clone, Debug)]
struct Pushes {
    /// Depth that motion made, summed over the projections of the substep, in metres.
    depth: [f32; LANES],
    /// What may be left of an old overlap at the end of the substep, in metres: see [`crate::overlap`]. Negative until
    /// the first projection.
    left: [f32; LANES],
    /// World normals of the last projection.
    normal: Cell,
}

impl Pushes {
    const NONE: Self = Self {
        depth: [0.0; LANES],
        left: [-1.0; LANES],
        normal: Cell { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] },
    };
}

/// The columns that contacts read and write.
pub(crate) struct Moving<'a> {
    pub position: &'a mut [Cell],
    pub displacement: &'a mut [Cell],
    /// Positions after integration.
    pub integrated: &'a mut [Cell],
}

impl BodyContext {
    /// Particles that obstacles pushed out in the last substep: the particle's index, the unit normal of the
    /// surface in the world, and the depth in metres, summed over the projections of the substep.
    pub fn contacts(&self) -> impl Iterator<Item = (usize, Vec3, f32)> + '_ {
        let layout = self.contacts.layout;
        let candidates = self.contacts.candidates.iter().zip(&self.contacts.pushes);
        candidates.filter(|(candidate, _)| candidate.is_touching).flat_map(move |(candidate, pushes)| {
            let touching = (0..LANES).filter(|&lane| pushes.depth[lane] > 0.0);
            touching.filter_map(move |lane| {
                let index = layout.index(candidate.cell as usize * LANES + lane)?;
                Some((index, pushes.normal.get(lane), pushes.depth[lane]))
            })
        })
    }
}

/// Lists the particles that could touch each obstacle if nothing moves more than `reach` (metres) on top of
/// the obstacle's own travel.
pub(crate) fn detect(body: &mut Body, obstacles: &[Obstacle], reach: f32, isa: Isa) {
    let (low, high) = body.particles.bounds();
    let Body { particles, settings, context, .. } = body;
    let contacts = &mut context.contacts;
    contacts.layout = particles.layout;
    contacts.groups.clear();
    contacts.candidates.clear();
    contacts.planes.clear();
    contacts.first_of_row.clear();
    for (index, obstacle) in obstacles.iter().enumerate() {
        let reach = reach + settings.thickness;
        let (obstacle_low, obstacle_high) = obstacle.swept_bounds();
        if !(low - reach).cmple(obstacle_high).all() || !(high + reach).cmpge(obstacle_low).all() {
            continue;
        }
        let pose = obstacle.pose_at(0.0, particles.origin);
        let first = contacts.candidates.len();
        let reach = reach + obstacle.travel();
        match obstacle.shape() {
            Shape::Container { half_extents } => {
                for wall in container_walls(*half_extents) {
                    let mut normal = Cell::default();
                    (0..LANES).for_each(|lane| normal.set(lane, wall.normal));
                    contacts.planes.push(LanePlanes { normal, offset: [wall.offset; LANES] });
                    let plane = contacts.planes.len() - 1;
                    let planes = &contacts.planes[plane];
                    let candidates = &mut contacts.candidates;
                    let solid = Solid::Planes(planes);
                    isa.run(Search { particles, solid, pose, reach, planes: Some(plane as u32), candidates });
                }
                contacts.candidates[first..].sort_by_key(|candidate| candidate.cell);
            }
            shape @ Shape::Parry(_) => search_by_query(contacts, particles, shape, pose, reach),
            shape => {
                let candidates = &mut contacts.candidates;
                isa.run(Search {
                    particles,
                    solid: Solid::Formula(shape),
                    pose,
                    reach,
                    planes: None,
                    candidates,
                });
            }
        }
        if contacts.candidates.len() > first {
            let rows = contacts.first_of_row.len();
            contacts.note_rows(first);
            contacts.groups.push(Group {
                obstacle: index,
                rows,
                friction: combined(settings.friction, obstacle.friction()),
                is_moving: obstacle.is_moving(),
                before: pose,
                now: pose,
            });
        }
    }
    if !contacts.groups.is_empty() {
        // As much as one obstacle can ask for, at once: what comes near bit by bit does not allocate bit by bit.
        let (cells, (_, rows)) = (particles.layout.cells(), particles.layout.rows());
        contacts.candidates.reserve(cells.saturating_sub(contacts.candidates.len()));
        contacts.pushes.reserve(cells.saturating_sub(contacts.pushes.len()));
        contacts.first_of_row.reserve((2 * (rows + 1)).saturating_sub(contacts.first_of_row.len()));
    }
    contacts.pushes.resize(contacts.candidates.len(), Pushes::NONE);
}

fn candidate(cell: usize, lanes: u16, planes: Option<u32>) -> Candidate {
    Candidate { cell: cell as u32, lanes, is_touching: false, planes }
}

/// Asks a shape without a formula for the nearest point of every particle in its reach.
fn search_by_query(
    contacts: &mut ObstacleContacts,
    particles: &Particles,
    shape: &Shape,
    pose: Pose,
    reach: f32,
) {
    let (low, high) = shape.local_bounds();
    for (cell, positions) in particles.position.cells.iter().enumerate() {
        let mut lanes = 0;
        let mut planes = LanePlanes::default();
        for lane in (0..LANES).filter(|lane| particles.inverse_mass[cell * LANES + lane] > 0.0) {
            let local = pose.to_local(positions.get(lane));
            if !(local.cmpge(low - reach).all() && local.cmple(high + reach).all()) {
                continue;
            }
            let surface = shape.surface(local);
            if surface.distance < reach {
                lanes |= 1 << lane;
                planes.normal.set(lane, surface.normal);
                planes.offset[lane] = surface.normal.dot(local) - surface.distance;
            }
        }
        if lanes != 0 {
            contacts.candidates.push(candidate(cell, lanes, Some(contacts.planes.len() as u32)));
            contacts.planes.push(planes);
        }
    }
}

/// The search for cells within reach of a shape with a formula.
struct Search<'a> {
    particles: &'a Particles,
    solid: Solid<'a>,
    pose: Pose,
    reach: f32,
    planes: Option<u32>,
    candidates: &'a mut Vec<Candidate>,
}

impl Kernel for Search<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let pose = LanePose::new(simd, &self.pose);
        let reach = f32x16::splat(simd, self.reach);
        let (masses, _) = self.particles.inverse_mass.as_chunks::<LANES>();
        for (cell, (position, mass)) in self.particles.position.cells.iter().zip(masses).enumerate() {
            let local = pose.to_local(Lanes3::load(simd, position));
            let (distance, _) = self.solid.surface(simd, local);
            let near = distance.simd_lt(reach) & load(simd, mass).simd_gt(f32x16::splat(simd, 0.0));
            if near.any_true() {
                self.candidates.push(candidate(cell, near.to_bitmask() as u16, self.planes));
            }
        }
    }
}

impl ObstacleContacts {
    /// Whether no particle can touch an obstacle in this step.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Notes where each row's candidates begin, of those from `first` on.
    fn note_rows(&mut self, first: usize) {
        let (cells_of_row, rows) = self.layout.rows();
        let mut next = first;
        for row in 0..rows {
            self.first_of_row.push(next as u32);
            let is_of_row = |candidate: &Candidate| (candidate.cell as usize) < (row + 1) * cells_of_row;
            next += self.candidates[next..].iter().take_while(|candidate| is_of_row(candidate)).count();
        }
        self.first_of_row.push(next as u32);
    }

    /// Brings the obstacles to the end of substep `index` of `count`.
    pub fn begin_substep(&mut self, obstacles: &[Obstacle], origin: Vec3, index: u32, count: u32) {
        for group in &mut self.groups {
            let pose_at = |k: u32| obstacles[group.obstacle].pose_at(k as f32 / count as f32, origin);
            group.before = pose_at(index);
            group.now = pose_at(index + 1);
        }
    }

    /// Moves every particle of these rows of cells that lies inside an obstacle out to its surface. `is_first` says that this
    /// is the first projection of the substep.
    #[inline(always)]
    pub fn project<S: Simd>(
        &mut self,
        simd: S,
        rows: Range<usize>,
        moving: &mut Moving,
        obstacles: &[Obstacle],
        thickness: f32,
        pace: Pace,
        is_first: bool,
    ) {
        let Self { groups, candidates, pushes, planes, first_of_row, .. } = self;
        for group in groups {
            let range = of_rows(first_of_row, group, &rows);
            if range.is_empty() {
                continue;
            }
            let (before, now) = (LanePose::new(simd, &group.before), LanePose::new(simd, &group.now));
            for (candidate, pushes) in candidates[range.clone()].iter_mut().zip(&mut pushes[range]) {
                let solid = match candidate.planes {
                    Some(place) => Solid::Planes(&planes[place as usize]),
                    None => Solid::Formula(obstacles[group.obstacle].shape()),
                };
                let contact =
                    Contact { solid, before, now, is_moving: group.is_moving, thickness, pace, is_first };
                contact.project(simd, candidate, pushes, moving);
            }
        }
    }

    /// Takes tangential displacement from every particle of these rows of cells that was projected. Comes last in the substep,
    /// after displacements were brought up to date.
    #[inline(always)]
    pub fn apply_friction<S: Simd>(&mut self, simd: S, rows: Range<usize>, moving: &mut Moving) {
        let Self { groups, candidates, pushes, first_of_row, .. } = self;
        for group in groups.iter().filter(|group| group.friction > 0.0) {
            let range = of_rows(first_of_row, group, &rows);
            if range.is_empty() {
                continue;
            }
            let (before, now) = (LanePose::new(simd, &group.before), LanePose::new(simd, &group.now));
            let touching = candidates[range.clone()].iter().zip(&pushes[range]);
            for (candidate, pushes) in touching.filter(|(candidate, _)| candidate.is_touching) {
                let depth = load(simd, &pushes.depth);
                let is_touching = depth.simd_gt(f32x16::splat(simd, 0.0));
                let cell = candidate.cell as usize;
                let position = Lanes3::load(simd, &moving.position[cell]);
                let displacement = Lanes3::load(simd, &moving.displacement[cell]);
                let mut slip = displacement;
                if group.is_moving {
                    // The surface point under the particle came from where the same local point was before.
                    slip = slip.minus(position.minus(before.point_to_world(now.to_local(position))));
                }
                let normal = Lanes3::load(simd, &pushes.normal);
                // Coulomb: at most the coefficient times the depth, and never more than there is. See `friction.rs`.
                let tangential = slip.minus(normal.times(slip.dot(normal)));
                let length = tangential.dot(tangential).sqrt();
                let most = depth * group.friction;
                let is_slipping = length.simd_gt(most);
                let one = f32x16::splat(simd, 1.0);
                let part = is_slipping.select(most / is_slipping.select(length, one), one);
                let taken = tangential.times(part);
                position.minus(taken).or(is_touching, position).store(&mut moving.position[cell]);
                displacement.minus(taken).or(is_touching, displacement).store(&mut moving.displacement[cell]);
            }
        }
    }
}

/// The places of a group's candidates in these rows of cells.
#[inline(always)]
fn of_rows(first_of_row: &[u32], group: &Group, rows: &Range<usize>) -> Range<usize> {
    first_of_row[group.rows + rows.start] as usize..first_of_row[group.rows + rows.end] as usize
}

/// One obstacle, as the particles of a cell meet it in one projection.
struct Contact<'a, S: Simd> {
    solid: Solid<'a>,
    before: LanePose<S>,
    now: LanePose<S>,
    is_moving: bool,
    thickness: f32,
    pace: Pace,
    is_first: bool,
}

impl<S: Simd> Contact<'_, S> {
    #[inline(always)]
    fn project(&self, simd: S, candidate: &mut Candidate, pushes: &mut Pushes, moving: &mut Moving) {
        let zero = f32x16::splat(simd, 0.0);
        let cell = candidate.cell as usize;
        if self.is_first {
            candidate.is_touching = false;
        }
        let position = Lanes3::load(simd, &moving.position[cell]);
        if self.solid.is_beyond(simd, position, self.now, self.thickness) {
            return;
        }
        let (distance, normal) = self.solid.surface_at(simd, position, self.now);
        let depth = f32x16::splat(simd, self.thickness) - distance;
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
        // The tangent plane rules out an overlap at the start of the substep, or the shape is asked for it.
        let may_be_old = (depth + outward.dot(normal)).simd_gt(LEAST_OVERLAP) & is_inside;
        let (mut fresh, mut out) = (depth, depth);
        if may_be_old.any_true() {
            let (distance, _) = self.solid.surface_at(simd, position.minus(travel), self.before);
            let overlap = f32x16::splat(simd, self.thickness) - distance;
            let overlap = overlap.simd_gt(zero).select(overlap, zero);
            let old = may_be_old.select(overlap.simd_lt(depth).select(overlap, depth), zero);
            let known = load(simd, &pushes.left);
            let left = known.simd_lt(zero).select(self.pace.left_in_lanes(simd, old), known);
            let taken = old - left;
            fresh = depth - old;
            out = fresh + taken.simd_gt(zero).select(taken, zero);
            pushes.left = may_be_old.select(left, known).to_array();
        }
        let out = normal.times(out);
        let with_velocity = displacement.plus(normal.times(fresh));
        with_velocity.or(is_inside, displacement).store(&mut moving.displacement[cell]);
        position.plus(out).or(is_inside, position).store(&mut moving.position[cell]);
        integrated.plus(out).or(is_inside, integrated).store(&mut moving.integrated[cell]);
        let summed = load(simd, &pushes.depth);
        pushes.depth = is_inside.select(summed + fresh, summed).to_array();
        normal.or(is_inside, Lanes3::load(simd, &pushes.normal)).store(&mut pushes.normal);
    }
}
