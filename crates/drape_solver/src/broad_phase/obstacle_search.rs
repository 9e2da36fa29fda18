//! The search for the particles that could touch obstacles, once a step.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::constants::{FACE_MARGIN, LEAST_SHARED_CELLS};
use crate::contact::face_obstacle::Met;
use crate::contact::particle_obstacle::{Candidate, Group, ObstacleContacts};
use crate::geometry::pose::Pose;
use crate::geometry::shape::{Plane, Shape, container_walls};
use crate::geometry::surface_lanes::{LanePlanes, LanePose, Solid};
use crate::parallel::workers::Crew;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load};
use crate::state::body::{Body, BodyContext};
use crate::state::obstacle::Obstacle;
use crate::state::obstacles::Obstacles;
use crate::state::particles::Particles;

/// The step that is searched.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    /// Seconds.
    pub dt: f32,
    pub substeps: u32,
    /// How far anything may move, in metres, on top of the obstacles' own travel.
    pub reach: f32,
}

/// Lists the particles that could touch each obstacle in the step.
pub(crate) fn detect(body: &mut Body, obstacles: &Obstacles, span: Span, isa: Isa, crew: &Crew) {
    let reach = span.reach;
    let (low, high) = body.particles.bounds();
    let Body { particles, topology, settings, layers, context, .. } = body;
    let BodyContext { contacts, faces, embedded, uniform_acceleration, .. } = context;
    let carried = particles.frame.map_or(Vec3::ZERO, |motion| motion.translation);
    let fall = *uniform_acceleration * (span.dt * span.dt) + carried;
    let flight = Flight { substeps: span.substeps as f32, fall };
    let fastest = particles.greatest_speed() * span.dt + flight.fall.length();
    let embedding = topology.embedding_reach;
    faces.clear();
    embedded.clear();
    contacts.layout = particles.layout.clone();
    contacts.groups.clear();
    contacts.candidates.clear();
    contacts.planes.clear();
    contacts.near.clear();
    let reach = reach + settings.thickness;
    let around = reach + embedding.overhang + (embedding.spread - 1.0) * fastest;
    obstacles.near(low - around, high + around, &mut contacts.near);
    for place in 0..contacts.near.len() {
        let index = contacts.near[place] as usize;
        let obstacle = &obstacles[index];
        if !obstacle.stops(*layers) {
            continue;
        }
        let pose = obstacle.pose_at(0.0, particles.origin);
        let friction = settings.surface_friction().with(obstacle.surface_friction());
        let first = contacts.candidates.len();
        let group = contacts.groups.len() as u16;
        let reach = reach + obstacle.travel();
        let sight = flight.towards(obstacle, particles);
        // Whether one may be through the other and out again within a substep.
        let thinnest = obstacle.shape().least_half_extent() + settings.thickness;
        let is_swift = (fastest + obstacle.travel()) / flight.substeps > thinnest;
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
            shape if !shape.has_formula() => {
                let search = Query { particles, shape, pose, reach, group, sight };
                search.run(contacts, settings.thickness);
            }
            shape => {
                if is_swift {
                    let search = Query { particles, shape, pose, reach, group, sight };
                    search.run_ahead(contacts);
                }
                let solid = Solid::Formula(shape);
                let search = Search { particles, solid, pose, reach, group, planes: None };
                search.run(&mut contacts.candidates, &mut contacts.found_by_helper, isa, crew);
            }
        }
        faces.search(
            particles,
            topology,
            settings,
            Met {
                shape: obstacle.shape(),
                obstacle: index,
                friction,
                pose,
                reach: settings.thickness + fastest + obstacle.travel() + FACE_MARGIN,
                // Particles look ahead for themselves; faces do where an obstacle is small enough to slip between them.
                is_swift: is_swift && obstacle.shape().middle_half_extent() < topology.longest_edge,
            },
        );
        if !topology.embedded.is_empty() {
            let met = Met {
                shape: obstacle.shape(),
                obstacle: index,
                friction,
                pose,
                reach: obstacle.travel() + FACE_MARGIN,
                is_swift: (embedding.spread * fastest + obstacle.travel()) / flight.substeps > thinnest,
            };
            let way = |place, moved, local| sight.way_of(place, moved, local);
            embedded.search(particles, topology, settings.thickness, met, way);
        }
        if contacts.candidates.len() > first {
            contacts.groups.push(Group {
                obstacle: index,
                friction,
                is_moving: obstacle.is_moving(),
                is_dynamic: obstacle.rigid_body().is_some(),
                is_asking: false,
                pose,
            });
        }
    }
    contacts.sort();
}

fn candidate(cell: usize, group: u16, lanes: u16, planes: Option<u32>) -> Candidate {
    Candidate { cell: cell as u32, group, lanes, is_touching: false, planes }
}

/// How particles fly through the step if nothing stops them.
#[derive(Clone, Copy)]
struct Flight {
    substeps: f32,
    /// What acceleration and the frame add to the way of all, in metres.
    fall: Vec3,
}

/// The same as an obstacle sees it, which may move itself.
#[derive(Clone, Copy)]
struct Sight {
    flight: Flight,
    end: Pose,
}

impl Flight {
    fn towards(self, obstacle: &Obstacle, particles: &Particles) -> Sight {
        Sight { flight: self, end: obstacle.pose_at(1.0, particles.origin) }
    }
}

impl Sight {
    /// The way of the particle in `slot`, which starts at `local`, through the obstacle's coordinates.
    fn way(self, particles: &Particles, slot: usize, local: Vec3) -> Vec3 {
        self.way_of(particles.position.get(slot), particles.displacement.get(slot), local)
    }

    /// The same of a point in `place` that has moved by `moved` in the last substep.
    fn way_of(self, place: Vec3, moved: Vec3, local: Vec3) -> Vec3 {
        let Flight { substeps, fall } = self.flight;
        self.end.to_local(place + (moved * substeps + fall)) - local
    }
}

/// The search that asks a shape about every particle in its reach, one by one.
#[derive(Clone, Copy)]
struct Query<'a> {
    particles: &'a Particles,
    shape: &'a Shape,
    pose: Pose,
    reach: f32,
    group: u16,
    sight: Sight,
}

impl Query<'_> {
    /// Looks for the nearest point of a shape without a formula; where the particle is on its way to another, for that.
    fn run(self, contacts: &mut ObstacleContacts, thickness: f32) {
        self.list(contacts, |local, way| {
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

    /// Looks for what a particle will run into, on top of what its formula tells in each substep: for those that may be
    /// through and out on the other side by then.
    fn run_ahead(self, contacts: &mut ObstacleContacts) {
        self.list(contacts, |local, way| {
            let is_outside = self.shape.surface(local).distance > 0.0;
            if is_outside { self.ahead(local, way) } else { None }
        });
    }

    /// The plane that the way from `local` runs into.
    fn ahead(self, local: Vec3, way: Vec3) -> Option<Plane> {
        let (fraction, normal) = self.shape.cast(local, way)?;
        Some(Plane { normal, offset: normal.dot(local + way * fraction) })
    }

    fn list(self, contacts: &mut ObstacleContacts, look: impl Fn(Vec3, Vec3) -> Option<Plane>) {
        let Self { particles, shape, pose, reach, group, sight } = self;
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
                if let Some(plane) = look(local, sight.way(particles, slot, local)) {
                    lanes |= 1 << lane;
                    planes.normal.set(lane, plane.normal);
                    planes.offset[lane] = plane.offset;
                }
            }
            if lanes != 0 {
                let place = contacts.planes.len() as u32;
                contacts.candidates.push(candidate(cell, group, lanes, Some(place)));
                contacts.planes.push(planes);
            }
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
