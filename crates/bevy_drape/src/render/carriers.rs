//! Obstacles that are drawn elsewhere than the shown steps saw them, and carry the cloth near them along.
//!
//! Steps see the last frame's pose of a character, and meshes show a time between the last two steps. So an arm that swings is drawn ahead of
//! the cape that it pushes, by a tenth of a metre at a run, and would be seen through it. Hence the mesh is moved where it is near:
//!
//! ```text
//!   part
//!     1 |\
//!       |  \        what touches the obstacle goes its whole way, what is farther off goes a part of it
//!     0 |____\____
//!       0   reach   distance from the obstacle
//! ```
//!
//! As the reach is more than the way, nothing comes to the other side of the obstacle, and no two places change their order.
//!
//! Imports obstacles as the solver knows them.

use bevy::ecs::system::SystemParam;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::{Layers, Obstacle, Shape};

use crate::environment::solver_environment::SolverEnvironment;
use crate::rigid_motion::{between, placement, rigid_way};

/// A way in metres that is not seen.
const UNSEEN: f32 = 5e-4;

/// The least distance in metres of which account is taken.
const TOUCHING: f32 = 1e-3;

/// A way in metres that is a jump: nothing is carried that far.
const JUMP: f32 = 0.5;

/// The least reach in metres; twice the way if that is more.
const LEAST_REACH: f32 = 0.05;

/// The obstacles, where steps see them and where they are drawn.
#[derive(SystemParam)]
pub(crate) struct Carriers<'w, 's> {
    solver: Res<'w, SolverEnvironment>,
    drawn: Query<'w, 's, &'static GlobalTransform>,
}

/// The time and the coordinates in which a surface is shown.
pub(crate) struct ShownTime {
    /// From 0, before the last step, to 1, after it.
    pub fraction: f32,
    /// From where things are drawn to where the surface is shown.
    pub back: Affine3A,
    /// The place from which the places of the surface are counted.
    pub origin: Vec3,
}

/// The obstacles that carry a surface along in a frame.
#[derive(Default)]
pub(crate) struct Carried<'a> {
    carriers: Vec<Carrier<'a>>,
    /// The longest way in metres of any place.
    pub farthest: f32,
}

struct Carrier<'a> {
    shape: &'a Shape,
    to_shape: Affine3A,
    way: Affine3A,
    reach: f32,
}

impl Carriers<'_, '_> {
    /// Lists those that carry a surface between these corners. `found` is memory.
    pub fn of(
        &self,
        corners: [Vec3; 2],
        layers: Layers,
        time: &ShownTime,
        found: &mut Vec<u32>,
    ) -> Carried<'_> {
        let [low, high] = corners;
        let obstacles = &self.solver.environment.obstacles;
        found.clear();
        obstacles.near(low - JUMP, high + JUMP, found);
        let mut carried = Carried::default();
        for &slot in &*found {
            let obstacle = &obstacles[slot as usize];
            if obstacle.is_sensor() || !obstacle.layers().interact(layers) {
                continue;
            }
            let entity = self.solver.obstacles.entity(slot as usize);
            let Ok(drawn) = self.drawn.get(entity) else { continue };
            if let Some((carrier, farthest)) = Carrier::new(obstacle, drawn, time) {
                carried.carriers.push(carrier);
                carried.farthest = carried.farthest.max(farthest);
            }
        }
        if carried.farthest < UNSEEN {
            carried.carriers.clear();
        }
        carried
    }
}

impl Carried<'_> {
    /// Takes a place along.
    pub fn place(&self, place: Vec3) -> Vec3 {
        let (mut way, mut weights, mut greatest) = (Vec3::ZERO, f32::MIN_POSITIVE, 0.0_f32);
        for carrier in &self.carriers {
            let distance = carrier.shape.distance(carrier.to_shape.transform_point3(place)).max(TOUCHING);
            let part = (1.0 - distance / carrier.reach).max(0.0);
            // Between two it goes with the nearer one.
            let weight = part / (distance * distance);
            way += weight * (carrier.way.transform_point3(place) - place);
            weights += weight;
            greatest = greatest.max(part);
        }
        place + way * (greatest / weights)
    }
}

impl<'a> Carrier<'a> {
    /// The obstacle and its longest way, unless that is too short or too long.
    fn new(obstacle: &'a Obstacle, drawn: &GlobalTransform, time: &ShownTime) -> Option<(Self, f32)> {
        let transform = |place: drape_solver::Placement| Transform {
            translation: place.translation,
            rotation: place.rotation,
            scale: Vec3::ONE,
        };
        let [before, after] = [obstacle.previous_placement(), obstacle.placement()].map(transform);
        let seen = placement(&between(&before, &after, time.fraction).compute_affine())?;
        let drawn = placement(&(time.back * drawn.affine()))?;
        let (p, q) = (seen.rotation, drawn.rotation);
        let turn = 2.0 * (p - q).length().min((p + q).length());
        let turned = if turn < 1e-6 { 0.0 } else { turn * obstacle.radius() };
        let farthest = seen.translation.distance(drawn.translation) + turned;
        if farthest > JUMP {
            return None;
        }
        let to_world = Affine3A::from_translation(time.origin);
        let from_shape = Affine3A::from_rotation_translation(p.normalize(), seen.translation);
        let way = to_world.inverse() * rigid_way(&seen, &drawn) * to_world;
        let reach = (2.0 * farthest).max(LEAST_REACH);
        Some((
            Self { shape: obstacle.shape(), to_shape: from_shape.inverse() * to_world, way, reach },
            farthest,
        ))
    }
}
