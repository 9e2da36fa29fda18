//! Ball joints between particles and dynamic obstacles.
//!
//! Design: `docs/design/joints.md`.

use glam::Vec3;

use crate::state::particles::Particles;

/// A pinned particle that is held at a point of a dynamic obstacle in the coming step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Joint {
    pub slot: u32,
    /// The obstacle, by its index in the environment.
    pub obstacle: u32,
    /// The point in the obstacle's frame, in metres.
    pub anchor: Vec3,
}

impl Particles {
    /// Joins the pinned particle `i` to a point of an obstacle through the coming step: `anchor` is the point in the
    /// obstacle's frame, in metres. If the obstacle has a [rigid body](crate::Obstacle::with_rigid_body), the body pulls
    /// the particle along, and all that pulls at the particle pulls at the body: a wrecking ball on a chain. The
    /// particle has no mass of its own meanwhile, touches nothing, and holds no tether.
    ///
    /// Without a rigid body the particle is an ordinary pin. Does nothing for a particle that is not pinned, or for an
    /// anchor that is not finite.
    ///
    /// ```
    /// use drape_solver::glam::Vec3;
    /// use drape_solver::{BodySettings, Environment, Island, Obstacle, Placement, RigidBody, RopeBuilder, Shape, step};
    ///
    /// // A ball of 20 kg on a rope, let go at the height of its hook.
    /// let mut rope = RopeBuilder::new(Vec3::ZERO, Vec3::X, 17).pin(0).build(BodySettings::default())?;
    /// rope.particles.set_inverse_mass(16, 0.0);
    /// let ball = Obstacle::new(Shape::Sphere { radius: 0.2 }, Placement::at(Vec3::X * 1.2), 0.5)?;
    /// let ball = ball.with_rigid_body(RigidBody::new(20.0, Vec3::splat(0.32))?);
    /// let mut environment = Environment { obstacles: vec![ball].into(), ..Environment::default() };
    /// let mut island = Island::of_body(rope);
    /// for _ in 0..60 {
    ///     environment.obstacles[0].fly(environment.gravity, environment.dt);
    ///     island.bodies[0].particles.join(16, 0, Vec3::X * -0.2);
    ///     step(&mut island, &environment)?;
    ///     for moved in &island.moved {
    ///         environment.obstacles[moved.obstacle].land(moved);
    ///     }
    /// }
    /// let distance = environment.obstacles[0].placement().translation.length();
    /// assert!((distance - 1.2).abs() < 0.02, "{distance}");
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    pub fn join(&mut self, i: usize, obstacle: usize, anchor: Vec3) {
        if !(self.is_pinned(i) && anchor.is_finite()) {
            return;
        }
        let joint = Joint { slot: self.slot(i) as u32, obstacle: obstacle as u32, anchor };
        match self.joints.binary_search_by_key(&joint.slot, |joint| joint.slot) {
            Ok(known) => self.joints[known] = joint,
            Err(place) => self.joints.insert(place, joint),
        }
    }

    /// Forgets all joints for the coming step. A step does so, too.
    pub fn clear_joints(&mut self) {
        self.joints.clear();
    }

    /// True if tethers to the particle in `slot` act: it is pinned, and not by an obstacle which would not feel the pull.
    pub(crate) fn is_anchor(&self, slot: usize) -> bool {
        self.inverse_mass[slot] == 0.0 && !self.is_joined(slot)
    }

    /// True if the particle in `slot` is held by an obstacle in the coming step.
    pub(crate) fn is_joined(&self, slot: usize) -> bool {
        self.joints.binary_search_by_key(&slot, |joint| joint.slot as usize).is_ok()
    }
}
