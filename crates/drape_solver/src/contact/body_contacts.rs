//! The contacts of one body with obstacles: by particles, by faces, and by the points of a collision mesh.

use glam::Vec3;

use crate::broad_phase::obstacle_search::{FreePath, Query, Search, SearchStep};
use crate::constants::FACE_MARGIN;
use crate::contact::embedded_obstacle::EmbeddedContacts;
use crate::contact::face_obstacle::{FaceContacts, SearchedObstacle};
use crate::contact::particle_obstacle::{ObstacleContacts, ObstacleGroup};
use crate::geometry::shape::{Shape, container_walls};
use crate::geometry::surface_lanes::{LanePlanes, Solid};
use crate::parallel::workers::Workers;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::obstacles::Obstacles;

/// The contacts of one body with obstacles.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyContacts {
    pub obstacles: ObstacleContacts,
    pub faces: FaceContacts,
    pub embedded: EmbeddedContacts,
}

impl BodyContacts {
    /// Obstacles that the body may touch, by index; some more than once.
    pub fn obstacles(&self) -> impl Iterator<Item = usize> + '_ {
        self.obstacles.obstacles().chain(self.faces.obstacles()).chain(self.embedded.obstacles())
    }
}

/// Lists the particles that could touch each obstacle in the step.
pub(crate) fn detect(
    all: &mut BodyContacts,
    body: &Body,
    obstacles: &Obstacles,
    search_step: SearchStep,
    isa: Isa,
    workers: &Workers,
) {
    let reach = search_step.reach;
    let (low, high) = body.particles.bounds();
    let Body { particles, topology, settings, layers, context, .. } = body;
    let BodyContacts { obstacles: contacts, faces, embedded } = all;
    let carried = particles.frame.map_or(Vec3::ZERO, |motion| motion.translation);
    let fall = context.uniform_acceleration * (search_step.dt * search_step.dt) + carried;
    let flight = FreePath { substeps: search_step.substeps as f32, fall };
    let fastest = particles.greatest_speed() * search_step.dt + flight.fall.length();
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
        let path = flight.towards(obstacle, particles);
        // Whether one may be through the other and out again within a substep.
        let thinnest = obstacle.shape().least_half_extent() + settings.thickness;
        let is_fast = (fastest + obstacle.travel()) / flight.substeps > thinnest;
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
                    search.run(&mut contacts.candidates, &mut contacts.found_by_helper, isa, workers);
                }
            }
            shape if !shape.has_formula() => {
                let search = Query { particles, shape, pose, reach, group, path };
                search.run(&mut contacts.lists(), settings.thickness);
            }
            shape => {
                if is_fast {
                    let search = Query { particles, shape, pose, reach, group, path };
                    search.run_ahead(&mut contacts.lists());
                }
                let solid = Solid::Formula(shape);
                let search = Search { particles, solid, pose, reach, group, planes: None };
                search.run(&mut contacts.candidates, &mut contacts.found_by_helper, isa, workers);
            }
        }
        faces.search(
            particles,
            topology,
            settings,
            SearchedObstacle {
                shape: obstacle.shape(),
                obstacle: index,
                friction,
                pose,
                reach: settings.thickness + fastest + obstacle.travel() + FACE_MARGIN,
                // Particles look ahead for themselves; faces do where an obstacle is small enough to slip between them.
                is_fast: is_fast && obstacle.shape().middle_half_extent() < topology.longest_edge,
            },
        );
        if !topology.embedded.is_empty() {
            let searched = SearchedObstacle {
                shape: obstacle.shape(),
                obstacle: index,
                friction,
                pose,
                reach: obstacle.travel() + FACE_MARGIN,
                is_fast: (embedding.spread * fastest + obstacle.travel()) / flight.substeps > thinnest,
            };
            let way = |place, moved, local| path.way_of(place, moved, local);
            embedded.search(particles, topology, settings.thickness, searched, way);
        }
        if contacts.candidates.len() > first {
            contacts.groups.push(ObstacleGroup {
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
