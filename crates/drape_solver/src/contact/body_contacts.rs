//! The contacts of one body with obstacles: by particles, by faces, by the points of a collision mesh, and by joints.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;

use crate::broad_phase::obstacle_search::{FreePath, Query, RelativePath, Search, SearchStep};
use crate::constants::FACE_MARGIN;
use crate::contact::embedded_obstacle::EmbeddedContacts;
use crate::contact::face_obstacle::FaceContacts;
use crate::contact::face_search::{SearchedObstacle, may_touch_faces};
use crate::contact::joint::{self, MovingJoint};
use crate::contact::particle_obstacle::{ObstacleContacts, ObstacleGroup};
use crate::contact::tether_pull::PressedPoint;
use crate::geometry::pose::Pose;
use crate::geometry::shape::{Shape, container_walls};
use crate::geometry::surface_lanes::{LanePlanes, Solid};
use crate::parallel::workers::Workers;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::friction::Friction;
use crate::state::obstacle::Obstacle;
use crate::state::obstacles::Obstacles;

/// The contacts of one body with obstacles.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyContacts {
    pub obstacles: ObstacleContacts,
    pub faces: FaceContacts,
    pub embedded: EmbeddedContacts,
    pub joints: Vec<MovingJoint>,
    /// Points that movers press, while tethers are projected.
    pub pressed: Vec<PressedPoint>,
}

impl BodyContacts {
    /// Obstacles that the body may touch or is joined to, by index; some more than once.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        let joints = self.joints.iter().map(|joint| joint.obstacle);
        let faces = self.faces.obstacles().chain(self.embedded.obstacles());
        self.obstacles.obstacles().chain(faces).chain(joints)
    }
}

/// Lists the particles, faces and embedded points that could touch each obstacle in the step.
pub(crate) fn detect(
    all: &mut BodyContacts,
    body: &Body,
    obstacles: &Obstacles,
    search_step: SearchStep,
    isa: Isa,
    workers: &Workers,
) {
    let search = BodySearch::new(body, search_step, isa, workers);
    let BodyContacts { obstacles: contacts, faces, embedded, joints, .. } = all;
    joint::detect(joints, body, obstacles);
    faces.clear();
    embedded.clear();
    contacts.clear(&body.particles.layout);
    let (low, high) = search.bounds();
    obstacles.near(low, high, &mut contacts.near);
    for place in 0..contacts.near.len() {
        let index = contacts.near[place] as usize;
        let obstacle = &obstacles[index];
        let passes = joint::is_held_inside(joints, index, obstacle.shape(), body.settings.thickness);
        if passes || !obstacle.stops(body.layers) {
            continue;
        }
        let near = NearObstacle::new(&search, index, obstacle);
        let first = contacts.candidates.len();
        search.particles(&near, contacts);
        search.faces(&near, faces);
        search.embedded_points(&near, embedded);
        if contacts.candidates.len() > first {
            contacts.groups.push(near.group());
        }
    }
    contacts.sort();
}

/// The search for the contacts of one body.
struct BodySearch<'a> {
    body: &'a Body,
    isa: Isa,
    workers: &'a Workers,
    flight: FreePath,
    /// Metres that the fastest particle flies in the step.
    fastest: f32,
    /// Metres from an obstacle at rest within which a particle is a candidate.
    reach: f32,
}

impl<'a> BodySearch<'a> {
    fn new(body: &'a Body, search_step: SearchStep, isa: Isa, workers: &'a Workers) -> Self {
        let Body { particles, settings, context, .. } = body;
        let carried = particles.frame.map_or(Vec3::ZERO, |motion| motion.translation);
        let fall = context.uniform_acceleration * (search_step.dt * search_step.dt) + carried;
        let flight = FreePath { substeps: search_step.substeps as f32, fall };
        let fastest = particles.greatest_speed() * search_step.dt + flight.fall.length();
        Self { body, isa, workers, flight, fastest, reach: search_step.reach + settings.thickness }
    }

    /// The box that holds every obstacle which the body may touch.
    fn bounds(&self) -> (Vec3, Vec3) {
        let (low, high) = self.body.particles.bounds();
        let embedding = self.body.topology.embedding_reach;
        let around = self.reach + embedding.overhang + (embedding.spread - 1.0) * self.fastest;
        (low - around, high + around)
    }

    /// Lists the particles that may touch the obstacle.
    fn particles(&self, near: &NearObstacle, contacts: &mut ObstacleContacts) {
        let Body { particles, settings, .. } = self.body;
        let group = contacts.groups.len() as u16;
        let &NearObstacle { obstacle, pose, path, .. } = near;
        let reach = self.reach + obstacle.travel();
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
                    let ObstacleContacts { candidates, found_by_helper, .. } = contacts;
                    search.run(candidates, found_by_helper, self.isa, self.workers);
                }
            }
            shape if !shape.has_formula() => {
                let search = Query { particles, shape, pose, reach, group, path };
                search.run(&mut contacts.lists(), settings.thickness);
            }
            shape => {
                if near.is_fast {
                    let search = Query { particles, shape, pose, reach, group, path };
                    search.run_ahead(&mut contacts.lists());
                }
                let solid = Solid::Formula(shape);
                let search = Search { particles, solid, pose, reach, group, planes: None };
                let ObstacleContacts { candidates, found_by_helper, .. } = contacts;
                search.run(candidates, found_by_helper, self.isa, self.workers);
            }
        }
    }

    /// Lists the faces and segments that may touch the obstacle.
    fn faces(&self, near: &NearObstacle, faces: &mut FaceContacts) {
        let Body { particles, topology, settings, .. } = self.body;
        let obstacle = near.obstacle;
        if !may_touch_faces(obstacle.shape(), topology, settings) {
            return;
        }
        let reach = settings.thickness + self.approach(obstacle) + FACE_MARGIN;
        // Particles are swept by themselves; faces are swept where an obstacle is small enough to slip between
        // particles.
        let is_fast = near.is_fast && obstacle.shape().middle_half_extent() < topology.longest_edge;
        faces.search(particles, topology, settings, near.searched(reach, is_fast), self.isa);
    }

    /// Upper bound in metres on the way that a particle and a point of the obstacle make against each other in the step: what travels
    /// with an obstacle does not come near it.
    fn approach(&self, obstacle: &Obstacle) -> f32 {
        if !obstacle.is_moving() {
            return self.fastest;
        }
        let Body { particles, .. } = self.body;
        let carried = obstacle.placement().translation - obstacle.previous_placement().translation;
        let FreePath { substeps, fall } = self.flight;
        let way = |slot| particles.displacement.get(slot) * substeps + fall - carried;
        let farthest = particles.layout.slots().map(|slot| way(slot).length_squared()).fold(0.0, f32::max);
        let turn = obstacle.travel() - carried.length();
        (farthest.sqrt() + turn).min(self.fastest + obstacle.travel())
    }

    /// Lists the points of a collision mesh that may touch the obstacle.
    fn embedded_points(&self, near: &NearObstacle, embedded: &mut EmbeddedContacts) {
        let Body { particles, topology, settings, .. } = self.body;
        if topology.embedded.is_empty() {
            return;
        }
        let travel = near.obstacle.travel();
        let spread = topology.embedding_reach.spread;
        let is_fast = (spread * self.fastest + travel) / self.flight.substeps > near.thinnest;
        let searched = near.searched(travel + FACE_MARGIN, is_fast);
        let way = |place, moved, local| near.path.way_of(place, moved, local);
        embedded.search(particles, topology, settings.thickness, searched, way);
    }
}

/// An obstacle near a body.
struct NearObstacle<'a> {
    index: usize,
    obstacle: &'a Obstacle,
    /// At the start of the step, in the body's coordinates.
    pose: Pose,
    friction: Friction,
    path: RelativePath,
    /// Half the obstacle's least extent with the body's thickness, in metres.
    thinnest: f32,
    /// True if a particle may be through the obstacle and out again within a substep.
    is_fast: bool,
}

impl<'a> NearObstacle<'a> {
    fn new(search: &BodySearch, index: usize, obstacle: &'a Obstacle) -> Self {
        let Body { particles, settings, .. } = search.body;
        let thinnest = obstacle.shape().least_half_extent() + settings.thickness;
        Self {
            index,
            obstacle,
            pose: obstacle.pose_at(0.0, particles.origin),
            friction: obstacle.friction_against(settings.surface_friction()),
            path: search.flight.towards(obstacle, particles),
            thinnest,
            is_fast: (search.fastest + obstacle.travel()) / search.flight.substeps > thinnest,
        }
    }

    /// True if contacts move the obstacle.
    fn is_dynamic(&self) -> bool {
        self.obstacle.rigid_body().is_some()
    }

    fn searched(&self, reach: f32, is_fast: bool) -> SearchedObstacle<'a> {
        let &Self { index, obstacle, pose, friction, .. } = self;
        let is_dynamic = self.is_dynamic();
        SearchedObstacle {
            shape: obstacle.shape(),
            obstacle: index,
            friction,
            pose,
            reach,
            is_fast,
            is_dynamic,
        }
    }

    fn group(&self) -> ObstacleGroup {
        ObstacleGroup {
            obstacle: self.index,
            friction: self.friction,
            is_moving: self.obstacle.is_moving(),
            is_dynamic: self.is_dynamic(),
            is_asking: false,
            pose: self.pose,
        }
    }
}
