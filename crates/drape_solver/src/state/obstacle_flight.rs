//! The flight of a dynamic obstacle through a step.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::Vec3;

use crate::geometry::pose::Placement;
use crate::state::obstacle::Obstacle;
use crate::state::obstacle_motion::MovedObstacle;
use crate::state::rigid_body::{Drive, RigidBody};

/// Motion of an obstacle with a rigid body through a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    start: RigidBody,
    end: RigidBody,
    /// Motion and placement at the end of the step if nothing touches it.
    pub free: (RigidBody, Placement),
    /// Accelerates it on the way there.
    drive: Drive,
}

impl Obstacle {
    /// Returns the obstacle as a dynamic one, which contacts move. `body` is its present motion about the shape's
    /// origin; [`fly`](Self::fly) begins each step. Contacts conserve momentum and gain no energy, whatever the masses.
    /// The obstacle does not collide with other obstacles.
    ///
    /// Everything that may touch it in one step should be in one island.
    ///
    /// ```
    /// use drape_solver::{Ball, BallMaterial, Environment, Island, Obstacle, Placement, RigidBody, Shape, step};
    /// use drape_solver::glam::Vec3;
    ///
    /// let shape = Shape::Cuboid { half_extents: Vec3::splat(0.2) };
    /// let body = RigidBody::new(2.0, Vec3::splat(0.05))?;
    /// let shape_of_2_kg = Obstacle::new(shape, Placement::default(), 0.5)?.with_rigid_body(body);
    /// let mut environment = Environment { obstacles: vec![shape_of_2_kg].into(), ..Environment::default() };
    /// let mut island = Island::of_ball(Ball::new(BallMaterial::default(), Vec3::X, Vec3::X * -9.0)?);
    /// for _ in 0..10 {
    ///     environment.obstacles[0].fly(environment.gravity, environment.dt);
    ///     step(&mut island, &environment)?;
    ///     for moved in &island.moved {
    ///         environment.obstacles[moved.obstacle].land(moved);
    ///     }
    /// }
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_rigid_body(mut self, body: RigidBody) -> Self {
        self.set_rigid_body(Some(body));
        self
    }

    /// The present motion of a dynamic obstacle. After [`fly`](Self::fly) it is the motion at the end of the step if
    /// nothing touches the obstacle.
    pub fn rigid_body(&self) -> Option<RigidBody> {
        self.flight.map(|flight| flight.end)
    }

    /// Sets the motion of a dynamic obstacle. With `None`, only [`move_to`](Self::move_to) moves the obstacle.
    pub fn set_rigid_body(&mut self, body: Option<RigidBody>) {
        self.flight = body.map(|body| Flight {
            start: body,
            end: body,
            free: (body, self.placement),
            drive: Drive::Gravity(Vec3::ZERO),
        });
    }

    /// The motion at the start of the coming step, and what accelerates the obstacle in it.
    pub(crate) fn starts_with(&self) -> Option<(RigidBody, Drive)> {
        self.flight.map(|flight| (flight.start, flight.drive))
    }

    /// Begins a step of `dt` seconds of an obstacle with a [rigid body](Self::with_rigid_body) under `acceleration`
    /// (m/s^2): moves it as if nothing touched it. Does nothing without a body.
    pub fn fly(&mut self, acceleration: Vec3, dt: f32) {
        let Some(Flight { end: start, .. }) = self.flight else { return };
        let (mut end, drive) = (start, Drive::Gravity(acceleration));
        let to = end.advance_under(drive, self.placement, dt);
        self.move_to(to, dt);
        self.flight = Some(Flight { start, end, free: (end, self.placement), drive });
    }

    /// Begins a step of `dt` seconds of an obstacle with a [rigid body](Self::with_rigid_body) that another physics engine
    /// has moved to `placement` already: flies it there once more, through whatever is in its way. If nothing touches
    /// it, it arrives with the velocities that its body has now. Does nothing without a body; ignores an invalid
    /// placement.
    pub fn fly_to(&mut self, placement: Placement, dt: f32) {
        let Some(Flight { end, .. }) = self.flight else { return };
        let from = self.placement;
        self.move_to(placement, dt);
        // A teleport, or a placement that was ignored, leaves no way to fly.
        let mut start = end;
        let drive = if self.placement == placement && self.before == from {
            start.lead(from, placement, dt)
        } else {
            start.lead(self.placement, self.placement, dt)
        };
        self.flight = Some(Flight { start, end, free: (end, self.placement), drive });
    }

    /// Ends a step in which something was near: sets the resulting motion and placement. If two islands touched the
    /// obstacle in one step, their effects are added. No momentum is lost, although each island was solved without the
    /// other.
    pub fn land(&mut self, moved: &MovedObstacle) {
        let Some(flight) = &mut self.flight else { return };
        let (free, place) = flight.free;
        let mut landed = moved.placement;
        if flight.end == free {
            flight.end = moved.body;
        } else {
            flight.end.velocity += moved.body.velocity - free.velocity;
            flight.end.angular_velocity += moved.body.angular_velocity - free.angular_velocity;
            landed = self.placement;
            landed.translation += moved.placement.translation - place.translation;
        }
        self.set_way(self.before, landed);
    }
}
