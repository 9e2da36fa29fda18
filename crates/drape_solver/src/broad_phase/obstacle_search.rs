//! The search for the particles that could touch obstacles, once a step.
//!
//! Design: `docs/design/broad_phase.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::constants::LEAST_SHARED_CELLS;
use crate::geometry::pose::Pose;
use crate::geometry::shape::{Plane, Shape};
use crate::geometry::surface_lanes::{LanePlanes, LanePose, Solid};
use crate::parallel::workers::Workers;
use crate::simd::columns::LANES;
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load};
use crate::state::obstacle::Obstacle;
use crate::state::particles::Particles;

/// The lists that a search fills: candidates, and the planes of those that have some.
pub(crate) struct CandidateLists<'a> {
    pub candidates: &'a mut Vec<Candidate>,
    pub planes: &'a mut Vec<LanePlanes>,
}

/// The step that is searched.
#[derive(Clone, Copy)]
pub(crate) struct SearchStep {
    /// Length of the step in seconds.
    pub dt: f32,
    pub substeps: u32,
    /// Metres that anything may move in the step, on top of the obstacles' own travel.
    pub reach: f32,
}

/// The particles of one cell that may touch one obstacle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub cell: u32,
    pub group: u16,
    pub lanes: u16,
    /// True if any of them has been pushed in this substep.
    pub is_touching: bool,
    /// Index of the planes next to these particles. None if each substep queries the shape itself.
    pub planes: Option<u32>,
}

impl Candidate {
    /// The lanes of the particles that may touch.
    pub fn each_lane(self) -> impl Iterator<Item = usize> {
        (0..LANES).filter(move |lane| self.lanes >> lane & 1 != 0)
    }

    /// The slot of the particle in a lane.
    pub fn slot(self, lane: usize) -> usize {
        self.cell as usize * LANES + lane
    }
}

fn candidate(cell: usize, group: u16, lanes: u16, planes: Option<u32>) -> Candidate {
    Candidate { cell: cell as u32, group, lanes, is_touching: false, planes }
}

/// The free flight of particles through the step.
#[derive(Clone, Copy)]
pub(crate) struct FreePath {
    pub substeps: f32,
    /// The way in metres that acceleration and the moving frame add for all particles.
    pub fall: Vec3,
}

/// The same in the coordinates of an obstacle, which may move itself.
#[derive(Clone, Copy)]
pub(crate) struct RelativePath {
    flight: FreePath,
    end: Pose,
}

impl FreePath {
    pub fn towards(self, obstacle: &Obstacle, particles: &Particles) -> RelativePath {
        RelativePath { flight: self, end: obstacle.pose_at(1.0, particles.origin) }
    }
}

impl RelativePath {
    /// The way of the particle in `slot`, which starts at `local`, through the obstacle's coordinates.
    fn way(self, particles: &Particles, slot: usize, local: Vec3) -> Vec3 {
        self.way_of(particles.position.get(slot), particles.displacement.get(slot), local)
    }

    /// The same for a point in `place` that has moved by `moved` in the last substep.
    pub fn way_of(self, place: Vec3, moved: Vec3, local: Vec3) -> Vec3 {
        let FreePath { substeps, fall } = self.flight;
        self.end.to_local(place + (moved * substeps + fall)) - local
    }
}

/// The search that queries a shape for every particle in its reach, one by one.
#[derive(Clone, Copy)]
pub(crate) struct Query<'a> {
    pub particles: &'a Particles,
    pub shape: &'a Shape,
    pub pose: Pose,
    pub reach: f32,
    pub group: u16,
    pub path: RelativePath,
}

impl Query<'_> {
    /// Keeps the plane at the nearest point of a shape without a formula, or the plane that the particle will run into.
    pub fn run(self, found: &mut CandidateLists, thickness: f32) {
        self.list(found, |local, way| {
            let surface = self.shape.surface(local);
            if surface.distance >= self.reach {
                return None;
            }
            let path = way.length();
            let is_ahead = path > thickness && surface.distance > 0.0 && surface.distance < path + thickness;
            let ahead = if is_ahead { self.ahead(local, way) } else { None };
            ahead.or(Some(surface.plane_at(local)))
        });
    }

    /// Keeps the planes that particles will run into, in addition to the shape's formula: for particles that may pass
    /// through the shape within a substep.
    pub fn run_ahead(self, found: &mut CandidateLists) {
        self.list(found, |local, way| {
            let is_outside = self.shape.surface(local).distance > 0.0;
            if is_outside { self.ahead(local, way) } else { None }
        });
    }

    /// The plane that the way from `local` runs into.
    fn ahead(self, local: Vec3, way: Vec3) -> Option<Plane> {
        let (fraction, normal) = self.shape.cast(local, way)?;
        Some(Plane { normal, offset: normal.dot(local + way * fraction) })
    }

    fn list(self, found: &mut CandidateLists, plane_of: impl Fn(Vec3, Vec3) -> Option<Plane>) {
        let Self { particles, shape, pose, reach, group, path } = self;
        let (low, high) = shape.local_bounds();
        for (cell, positions) in particles.position.cells.iter().enumerate() {
            let mut lanes = 0;
            let mut planes = LanePlanes::default();
            for lane in 0..LANES {
                let slot = cell * LANES + lane;
                let local = pose.to_local(positions.get(lane));
                let is_near = local.cmpge(low - reach).all() && local.cmple(high + reach).all();
                if !is_near || particles.inverse_mass[slot] == 0.0 {
                    continue;
                }
                if let Some(plane) = plane_of(local, path.way(particles, slot, local)) {
                    lanes |= 1 << lane;
                    planes.normal.set(lane, plane.normal);
                    planes.offset[lane] = plane.offset;
                }
            }
            if lanes != 0 {
                let place = found.planes.len() as u32;
                found.candidates.push(candidate(cell, group, lanes, Some(place)));
                found.planes.push(planes);
            }
        }
    }
}

/// The search for cells within reach of a shape with a formula.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    pub particles: &'a Particles,
    pub solid: Solid<'a>,
    pub pose: Pose,
    pub reach: f32,
    pub group: u16,
    pub planes: Option<u32>,
}

impl Search<'_> {
    /// Adds the candidates that it finds. If another thread is free, it searches the second half of the cells.
    pub fn run(
        self,
        candidates: &mut Vec<Candidate>,
        found_by_helper: &mut Vec<Candidate>,
        isa: Isa,
        workers: &Workers,
    ) {
        let cells = self.particles.position.cells.len();
        if workers.count() < 2 || cells < 2 * LEAST_SHARED_CELLS {
            return isa.run(SearchCells { search: self, cells: 0..cells, candidates });
        }
        let middle = cells / 2;
        found_by_helper.clear();
        workers.join(
            &mut || isa.run(SearchCells { search: self, cells: 0..middle, candidates }),
            &mut || {
                isa.run(SearchCells { search: self, cells: middle..cells, candidates: found_by_helper });
            },
        );
        candidates.extend_from_slice(found_by_helper);
    }
}

struct SearchCells<'a, 'b> {
    search: Search<'a>,
    cells: Range<usize>,
    candidates: &'b mut Vec<Candidate>,
}

impl Kernel for SearchCells<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { search: Search { particles, solid, pose, reach, group, planes }, cells, candidates } =
            self;
        let pose = LanePose::new(simd, &pose);
        let reach = f32x16::splat(simd, reach);
        let (masses, _) = particles.inverse_mass.as_chunks::<LANES>();
        for cell in cells {
            let position = Lanes3::load(simd, &particles.position.cells[cell]);
            let (distance, _) = solid.surface(simd, pose.to_local(position));
            let near = distance.simd_lt(reach) & load(simd, &masses[cell]).simd_gt(f32x16::splat(simd, 0.0));
            if near.any_true() {
                candidates.push(candidate(cell, group, near.to_bitmask() as u16, planes));
            }
        }
    }
}
