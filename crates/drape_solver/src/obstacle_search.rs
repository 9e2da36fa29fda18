//! The search for the particles that could touch obstacles, once a step.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, prelude::*};

use crate::body::Body;
use crate::columns::{Cell, LANES};
use crate::constants::LEAST_SHARED_CELLS;
use crate::contact_particle_obstacle::{Candidate, Group, ObstacleContacts};
use crate::crew::Crew;
use crate::isa::{Isa, Kernel};
use crate::lanes::{Lanes3, load};
use crate::obstacle::Obstacle;
use crate::particles::Particles;
use crate::pose::Pose;
use crate::shape::{Shape, container_walls};
use crate::surface_lanes::{LanePlanes, LanePose, Solid};

/// Lists the particles that could touch each obstacle if nothing moves more than `reach` (metres) on top of
/// the obstacle's own travel.
pub(crate) fn detect(body: &mut Body, obstacles: &[Obstacle], reach: f32, isa: Isa, crew: &Crew) {
    let (low, high) = body.particles.bounds();
    let Body { particles, settings, context, .. } = body;
    let contacts = &mut context.contacts;
    contacts.layout = particles.layout.clone();
    contacts.groups.clear();
    contacts.candidates.clear();
    contacts.planes.clear();
    for (index, obstacle) in obstacles.iter().enumerate() {
        let reach = reach + settings.thickness;
        let (obstacle_low, obstacle_high) = obstacle.swept_bounds();
        if !(low - reach).cmple(obstacle_high).all() || !(high + reach).cmpge(obstacle_low).all() {
            continue;
        }
        let pose = obstacle.pose_at(0.0, particles.origin);
        let first = contacts.candidates.len();
        let group = contacts.groups.len() as u16;
        let reach = reach + obstacle.travel();
        match obstacle.shape() {
            Shape::Container { half_extents } => {
                for wall in container_walls(*half_extents) {
                    let mut normal = Cell::default();
                    (0..LANES).for_each(|lane| normal.set(lane, wall.normal));
                    contacts.planes.push(LanePlanes { normal, offset: [wall.offset; LANES] });
                    let plane = contacts.planes.len() - 1;
                    let solid = Solid::Planes(&contacts.planes[plane]);
                    let planes = Some(plane as u32);
                    let search = Search { particles, solid, pose, reach, group, planes };
                    search.run(&mut contacts.candidates, &mut contacts.found_by_helper, isa, crew);
                }
            }
            shape @ Shape::Parry(_) => search_by_query(contacts, particles, shape, pose, reach, group),
            shape => {
                let solid = Solid::Formula(shape);
                let search = Search { particles, solid, pose, reach, group, planes: None };
                search.run(&mut contacts.candidates, &mut contacts.found_by_helper, isa, crew);
            }
        }
        if contacts.candidates.len() > first {
            contacts.groups.push(Group {
                obstacle: index,
                friction: settings.surface_friction().with(obstacle.surface_friction()),
                is_moving: obstacle.is_moving(),
                pose,
            });
        }
    }
    contacts.sort();
}

fn candidate(cell: usize, group: u16, lanes: u16, planes: Option<u32>) -> Candidate {
    Candidate { cell: cell as u32, group, lanes, is_touching: false, planes }
}

/// Asks a shape without a formula for the nearest point of every particle in its reach.
fn search_by_query(
    contacts: &mut ObstacleContacts,
    particles: &Particles,
    shape: &Shape,
    pose: Pose,
    reach: f32,
    group: u16,
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
            let plane = contacts.planes.len() as u32;
            contacts.candidates.push(candidate(cell, group, lanes, Some(plane)));
            contacts.planes.push(planes);
        }
    }
}

/// The search for cells within reach of a shape with a formula.
#[derive(Clone, Copy)]
struct Search<'a> {
    particles: &'a Particles,
    solid: Solid<'a>,
    pose: Pose,
    reach: f32,
    group: u16,
    planes: Option<u32>,
}

impl Search<'_> {
    /// Adds what it finds to `candidates`. Where there is help, the second half of the cells is searched by the helper.
    fn run(
        self,
        candidates: &mut Vec<Candidate>,
        found_by_helper: &mut Vec<Candidate>,
        isa: Isa,
        crew: &Crew,
    ) {
        let cells = self.particles.position.cells.len();
        if crew.count() < 2 || cells < 2 * LEAST_SHARED_CELLS {
            return isa.run(SearchCells { search: self, cells: 0..cells, candidates });
        }
        let middle = cells / 2;
        found_by_helper.clear();
        crew.join(&mut || isa.run(SearchCells { search: self, cells: 0..middle, candidates }), &mut || {
            isa.run(SearchCells { search: self, cells: middle..cells, candidates: found_by_helper });
        });
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
