//! Clothes are drawn where the limbs that touch them are drawn.
//!
//! Steps see the last frame's pose of a character, and meshes show a time between the last two steps. So an arm that swings is drawn ahead of
//! the cape that it pushes, by a tenth of a metre at a run, and would be seen through it. Hence the vertices near it are displaced:
//!
//! ```text
//!   weight
//!     1 |\
//!       |  \        a vertex at the obstacle is displaced as much as the obstacle, one farther off less
//!     0 |____\____
//!       0   reach   distance from the obstacle
//! ```
//!
//! As the reach is twice the displacement, no vertex comes to the other side of the obstacle. Only the mesh is displaced, and only that of a
//! skinned cloth: what lies on a moving platform is drawn as it was in the shown time.
//!
//! Imports obstacles as the solver knows them.

use bevy::ecs::system::SystemParam;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::{Layers, Obstacle, Placement, Shape};

use crate::environment::obstacle::TeleportObstacle;
use crate::environment::solver_environment::SolverEnvironment;
use crate::rigid_motion::{between, placement, rigid_way};

/// Displacements below this, in metres, are ignored.
const UNSEEN: f32 = 5e-4;

/// Displacements above this, in metres, are jumps, which displace nothing.
const JUMP: f32 = 0.3;

/// The least reach in metres; twice the displacement if that is more.
const LEAST_REACH: f32 = 0.05;

/// Smaller distances, in metres, count as contact.
const TOUCHING: f32 = 1e-3;

/// The obstacles, where steps see them and where they are drawn.
#[derive(SystemParam)]
pub(crate) struct Carriers<'w, 's> {
    solver: Res<'w, SolverEnvironment>,
    drawn: Query<'w, 's, &'static GlobalTransform, Without<TeleportObstacle>>,
}

/// A surface to be drawn.
pub(crate) struct DrawnSurface {
    /// Corners of a box around it, in the world as the steps saw it.
    pub corners: [Vec3; 2],
    pub layers: Layers,
    /// The shown time, from 0, before the last step, to 1, after it.
    pub fraction: f32,
    /// From the world as it is drawn to the world as the steps saw it.
    pub to_steps: Affine3A,
    /// The position that others are relative to.
    pub origin: Vec3,
}

/// The obstacles that displace a surface in a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carried {
    carriers: Vec<Carrier>,
    /// Upper bound on the displacement of any vertex, in metres.
    pub greatest: f32,
}

#[derive(Clone, Debug)]
struct Carrier {
    shape: Shape,
    to_shape: Affine3A,
    motion: Affine3A,
    reach: f32,
}

impl Carriers<'_, '_> {
    /// Finds the obstacles that displace a surface. `near` is a buffer.
    pub fn find(&self, surface: &DrawnSurface, near: &mut Vec<u32>, carried: &mut Carried) {
        carried.clear();
        near.clear();
        let obstacles = &self.solver.environment.obstacles;
        let [low, high] = surface.corners;
        obstacles.near(low - 2.0 * JUMP, high + 2.0 * JUMP, near);
        for &slot in &*near {
            let obstacle = &obstacles[slot as usize];
            let entity = self.solver.obstacles.entity(slot as usize);
            if !obstacle.is_sensor()
                && obstacle.layers().interact(surface.layers)
                && let Ok(drawn) = self.drawn.get(entity)
            {
                carried.add(obstacle, drawn, surface);
            }
        }
        if carried.greatest < UNSEEN {
            carried.clear();
        }
    }
}

impl Carried {
    /// Displaces nothing.
    pub fn clear(&mut self) {
        self.carriers.clear();
        self.greatest = 0.0;
    }

    /// True if nothing is displaced.
    pub fn is_empty(&self) -> bool {
        self.carriers.is_empty()
    }

    /// The displaced position of a vertex.
    pub fn place(&self, position: Vec3) -> Vec3 {
        if self.is_empty() {
            return position;
        }
        let (mut sum, mut weights, mut greatest) = (Vec3::ZERO, f32::MIN_POSITIVE, 0.0_f32);
        for carrier in &self.carriers {
            let distance = carrier.shape.distance(carrier.to_shape.transform_point3(position)).max(TOUCHING);
            let weight = (1.0 - distance / carrier.reach).max(0.0);
            greatest = greatest.max(weight);
            // Between two obstacles the nearer one counts more.
            let share = weight / (distance * distance);
            sum += share * (carrier.motion.transform_point3(position) - position);
            weights += share;
        }
        position + sum * (greatest / weights)
    }

    /// Adds an obstacle of a shape with a formula, also one that stands still: it holds what it touches.
    fn add(&mut self, obstacle: &Obstacle, drawn: &GlobalTransform, surface: &DrawnSurface) {
        let shape = obstacle.shape();
        if matches!(shape, Shape::Mesh(_) | Shape::Compound(_) | Shape::Parry(_) | Shape::Container { .. }) {
            return;
        }
        let [before, after] = [obstacle.previous_placement(), obstacle.placement()].map(transform);
        let Transform { translation, rotation, .. } = between(&before, &after, surface.fraction);
        let seen = Placement { translation, rotation };
        let Some(drawn) = placement(&(surface.to_steps * drawn.affine())) else { return };
        // Relative to a position near by, so that the motion is exact far from the origin of the world, too.
        let [seen, drawn] =
            [seen, drawn].map(|place| Placement { translation: place.translation - surface.origin, ..place });
        let motion = rigid_way(&seen, &drawn);
        let displaced = |point: Vec3| motion.transform_point3(point).distance(point);
        let moved = if obstacle.radius().is_finite() {
            let (p, q) = (seen.rotation, drawn.rotation);
            let turn = 2.0 * (p - q).length().min((p + q).length());
            displaced(seen.translation) + turn * (obstacle.radius() + LEAST_REACH)
        } else {
            let [low, high] = surface.corners.map(|corner| corner - surface.origin);
            displaced(low).max(displaced(high)).max(displaced(0.5 * (low + high)))
        };
        if moved < JUMP {
            self.greatest = self.greatest.max(moved);
            let reach = (2.0 * moved).max(LEAST_REACH);
            let to_shape =
                Affine3A::from_rotation_translation(seen.rotation.normalize(), seen.translation).inverse();
            self.carriers.push(Carrier { shape: shape.clone(), to_shape, motion, reach });
        }
    }
}

fn transform(place: Placement) -> Transform {
    Transform { translation: place.translation, rotation: place.rotation, scale: Vec3::ONE }
}
