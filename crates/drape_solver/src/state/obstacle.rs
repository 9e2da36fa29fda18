//! Obstacles: what bodies and balls collide with, and what nothing pushes back.

use glam::Vec3;

use crate::constants::TELEPORT_SPEED;
use crate::error::{BuildError, in_range};
use crate::geometry::pose::{Placement, Pose};
use crate::geometry::shape::Shape;
use crate::state::friction::Friction;
use crate::state::layers::Layers;
use crate::state::obstacle_motion::MovedObstacle;
use crate::state::rigid_body::RigidBody;

/// A shape at a place, still or moving.
#[derive(Clone, Debug)]
pub struct Obstacle {
    shape: Shape,
    placement: Placement,
    /// Where it was one step ago: the difference is the velocity that enters contact and friction.
    before: Placement,
    friction: Friction,
    restitution: f32,
    layers: Layers,
    is_sensor: bool,
    reports_contacts: bool,
    reports_reaction: bool,
    /// What moves it, if it is moved by what hits it.
    flight: Option<Flight>,
}

/// How an obstacle with a rigid body moves through a step.
#[derive(Clone, Copy, Debug)]
struct Flight {
    start: RigidBody,
    end: RigidBody,
    /// At the end, if nothing touches it.
    free: (RigidBody, Placement),
}

impl Flight {
    fn at_rest_in(placement: Placement, body: RigidBody) -> Self {
        Self { start: body, end: body, free: (body, placement) }
    }
}

impl Obstacle {
    /// An obstacle at rest, with a Coulomb friction coefficient (0 or more).
    ///
    /// # Errors
    /// [`BuildError`] if the shape, the placement or the coefficient cannot be used.
    pub fn new(shape: Shape, placement: Placement, friction: f32) -> Result<Self, BuildError> {
        shape.validate()?;
        in_range("friction", friction, 0.0, 1e3)?;
        if !placement.is_valid() {
            return Err(BuildError::BadShape { reason: "its placement is not finite" });
        }
        let friction = Friction::new(friction, friction);
        Ok(Self { shape, placement, before: placement, friction, ..Self::ground() })
    }

    /// The horizontal ground at height 0, with friction 0.5.
    pub fn ground() -> Self {
        Self {
            shape: Shape::HalfSpace { normal: Vec3::Y },
            placement: Placement::default(),
            before: Placement::default(),
            friction: Friction::new(0.5, 0.5),
            restitution: 0.0,
            layers: Layers::ALL,
            is_sensor: false,
            reports_contacts: false,
            reports_reaction: false,
            flight: None,
        }
    }

    /// The same in these layers.
    #[must_use]
    pub fn with_layers(self, layers: Layers) -> Self {
        Self { layers, ..self }
    }

    /// The same as a sensor: it moves nothing, and tells what touches it, at the end of each substep. A sensor tells
    /// something only if it, or what touches it, [reports contacts](Self::reporting_contacts).
    #[must_use]
    pub fn as_sensor(self) -> Self {
        Self { is_sensor: true, ..self }
    }

    /// The same, with [`Island::contacts`](crate::Island::contacts) telling what touches it.
    #[must_use]
    pub fn reporting_contacts(self) -> Self {
        Self { reports_contacts: true, ..self }
    }

    /// The same, with [`Island::reactions`](crate::Island::reactions) telling the exact opposite of all impulses that it
    /// gave to bodies and balls. What is near such an obstacle is stepped substep by substep.
    ///
    /// Through a step the obstacle itself moves as [told](Self::move_to); whoever moves it gives it the reaction after the
    /// step. Momentum is then kept, and so is angular momentum. The coupling is explicit: in the step of a hit the obstacle
    /// holds like one without end of mass. What hits it without a bounce gains no energy where the obstacle weighs, as felt
    /// at the point of contact, at least as much as what it stops in one step; with a restitution of `e`, `(1 + e) / (1 - e)`
    /// times as much. One that has its [body here](Self::with_rigid_body) knows no such limit.
    #[must_use]
    pub fn reporting_reaction(self) -> Self {
        Self { reports_reaction: true, ..self }
    }

    /// The same, moved by what hits it: `body` says how it moves now, about the shape's origin. It [flies](Self::fly)
    /// through the steps; momentum is kept, and no contact gains energy, whatever the masses. It touches no
    /// other obstacle.
    ///
    /// What may touch it in one step should be in one island.
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
    pub fn with_rigid_body(self, body: RigidBody) -> Self {
        let flight = Some(Flight::at_rest_in(self.placement, body));
        Self { flight, ..self }
    }

    /// How it moves now, if it is moved by what hits it; once it [flies](Self::fly), at the end of that step if nothing
    /// touches it.
    pub fn rigid_body(&self) -> Option<RigidBody> {
        self.flight.map(|flight| flight.end)
    }

    /// Sets how it moves now, or with `None` that nothing moves it but [`move_to`](Self::move_to).
    pub fn set_rigid_body(&mut self, body: Option<RigidBody>) {
        self.flight = body.map(|body| Flight::at_rest_in(self.placement, body));
    }

    /// How it moves at the start of the coming step.
    pub(crate) fn starts_with(&self) -> Option<RigidBody> {
        self.flight.map(|flight| flight.start)
    }

    /// Begins a step of `dt` seconds of an obstacle with a [rigid body](Self::with_rigid_body), in which an acceleration
    /// (m/s^2) acts on it: moves it to where it gets if nothing touches it. Without a body it stays where it is.
    pub fn fly(&mut self, acceleration: Vec3, dt: f32) {
        let Some(Flight { end: mut start, .. }) = self.flight else { return };
        start.accelerate(acceleration, dt);
        let mut end = start;
        let to = end.advance(self.placement, dt);
        self.move_to(to, dt);
        self.flight = Some(Flight { start, end, free: (end, self.placement) });
    }

    /// Ends a step in which something was near: puts it where it has got. Should two islands have met it in one step,
    /// what they did to it adds up: no momentum is lost, though each has met it as if the other were not there.
    pub fn land(&mut self, moved: &MovedObstacle) {
        let Some(flight) = &mut self.flight else { return };
        let (free, place) = flight.free;
        if flight.end == free {
            flight.end = moved.body;
            self.placement = moved.placement;
        } else {
            flight.end.velocity += moved.body.velocity - free.velocity;
            flight.end.angular_velocity += moved.body.angular_velocity - free.angular_velocity;
            self.placement.translation += moved.placement.translation - place.translation;
        }
    }

    /// Whether [`Island::reactions`](crate::Island::reactions) tells what is done to it.
    pub fn reports_reaction(&self) -> bool {
        self.reports_reaction
    }

    /// Whether what it gives to bodies and balls has to be known: to be told, or to be felt.
    pub(crate) fn keeps_account(&self) -> bool {
        self.reports_reaction || self.flight.is_some()
    }

    /// Which layers it belongs to, and which it touches.
    pub fn layers(&self) -> Layers {
        self.layers
    }

    /// Whether it moves nothing.
    pub fn is_sensor(&self) -> bool {
        self.is_sensor
    }

    /// Whether [`Island::contacts`](crate::Island::contacts) tells what touches it.
    pub fn reports_contacts(&self) -> bool {
        self.reports_contacts
    }

    /// Whether it stops what is in these layers.
    pub(crate) fn stops(&self, layers: Layers) -> bool {
        !self.is_sensor && self.layers.interact(layers)
    }

    /// Whether it is a sensor for what is in these layers.
    pub(crate) fn senses(&self, layers: Layers) -> bool {
        self.is_sensor && self.layers.interact(layers)
    }

    /// The shape.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Where it is at the end of the coming step.
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// Where it was at the start of the step.
    pub fn previous_placement(&self) -> Placement {
        self.before
    }

    /// Sets the coefficient of static friction (0 or more), which holds what does not slide yet; below that of
    /// friction it counts as that.
    ///
    /// # Errors
    /// [`BuildError`] if it is out of range.
    pub fn with_static_friction(mut self, coefficient: f32) -> Result<Self, BuildError> {
        in_range("static_friction", coefficient, 0.0, 1e3)?;
        self.friction = Friction::new(self.friction.kinetic, coefficient);
        Ok(self)
    }

    /// Sets the coefficient of restitution against balls: 0 (they do not bounce) to 1 (they lose nothing). The mean of
    /// the obstacle's and the ball's counts.
    ///
    /// # Errors
    /// [`BuildError`] if it is out of range.
    pub fn with_restitution(mut self, coefficient: f32) -> Result<Self, BuildError> {
        in_range("restitution", coefficient, 0.0, 1.0)?;
        self.restitution = coefficient;
        Ok(self)
    }

    /// The coefficient of kinetic friction.
    pub fn friction(&self) -> f32 {
        self.friction.kinetic
    }

    /// The coefficient of restitution.
    pub fn restitution(&self) -> f32 {
        self.restitution
    }

    /// How rough the surface is.
    pub(crate) fn surface_friction(&self) -> Friction {
        self.friction
    }

    /// Whether it moves in the coming step.
    pub fn is_moving(&self) -> bool {
        self.before != self.placement
    }

    /// Where it is at the start of the coming step.
    pub(crate) fn start(&self) -> Placement {
        self.before
    }

    /// Moves it to `placement` in the coming step of `dt` seconds. It travels there through the substeps and
    /// takes with it what it touches, unless that would be faster than 1500 m/s: then it is a
    /// [teleport](Self::teleport). An invalid placement is ignored.
    pub fn move_to(&mut self, placement: Placement, dt: f32) {
        if !placement.is_valid() {
            return;
        }
        self.before = self.placement;
        self.placement = placement;
        let moved = self.placement.translation.distance(self.before.translation);
        if moved > TELEPORT_SPEED * dt {
            self.before = placement;
        }
    }

    /// Puts it at `placement` without any velocity. An invalid placement is ignored.
    pub fn teleport(&mut self, placement: Placement) {
        if placement.is_valid() {
            self.placement = placement;
            self.before = placement;
        }
    }

    /// The pose at `fraction` of the step, relative to `origin`.
    pub(crate) fn pose_at(&self, fraction: f32, origin: Vec3) -> Pose {
        if self.is_moving() {
            Pose::between(&self.before, &self.placement, fraction, origin)
        } else {
            Pose::between(&self.placement, &self.placement, 1.0, origin)
        }
    }

    /// How far any point of it moves in the step, at most, in metres; a bound for the search.
    pub(crate) fn travel(&self) -> f32 {
        if !self.is_moving() {
            return 0.0;
        }
        let moved = self.placement.translation.distance(self.before.translation);
        let (low, high) = self.shape.local_bounds();
        let arm = low.abs().max(high.abs()).length();
        let (p, q) = (self.before.rotation, self.placement.rotation);
        // The chord of the half angle, twice: at least the arc for turns below half a circle.
        let turn = if p == q { 0.0 } else { 4.0 * (p - q).length().min((p + q).length()) };
        if arm.is_finite() { moved + arm * turn } else { moved + turn }
    }

    /// A box around the obstacle through the whole step, as (least, greatest) corner in the world.
    pub fn swept_bounds(&self) -> (Vec3, Vec3) {
        let (low, high) = self.shape.local_bounds();
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        if !half.is_finite() {
            return (Vec3::splat(f32::NEG_INFINITY), Vec3::splat(f32::INFINITY));
        }
        let mut bounds = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        for fraction in [0.0, 1.0] {
            let pose = self.pose_at(fraction, Vec3::ZERO);
            let centre = pose.point_to_world(middle);
            let axis = |unit: Vec3, half: f32| (pose.direction_to_world(unit) * half).abs();
            let reach = axis(Vec3::X, half.x) + axis(Vec3::Y, half.y) + axis(Vec3::Z, half.z);
            bounds.0 = bounds.0.min(centre - reach);
            bounds.1 = bounds.1.max(centre + reach);
        }
        // A turning box bulges out between the two ends by less than its travel.
        let slack = if self.before.rotation == self.placement.rotation { 0.0 } else { self.travel() };
        (bounds.0 - slack, bounds.1 + slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_jump_faster_than_anything_real_carries_no_velocity() {
        let mut obstacle = Obstacle::ground();
        obstacle.move_to(Placement::at(Vec3::X * 20.0), 1.0 / 60.0);
        assert!(obstacle.is_moving());
        obstacle.move_to(Placement::at(Vec3::X * 1000.0), 1.0 / 60.0);
        assert!(!obstacle.is_moving());
        obstacle.move_to(Placement::at(Vec3::NAN), 1.0 / 60.0);
        assert_eq!(obstacle.placement().translation, Vec3::X * 1000.0);
    }

    #[test]
    fn swept_bounds_hold_every_corner_on_the_way() {
        let half_extents = Vec3::new(2.0, 0.1, 0.1);
        let shape = Shape::Cuboid { half_extents };
        let mut obstacle = Obstacle::new(shape, Placement::default(), 0.5).expect("valid");
        let turned = Placement { translation: Vec3::X * 0.5, rotation: Quat::from_rotation_z(1.5) };
        obstacle.move_to(turned, 1.0 / 60.0);
        let (low, high) = obstacle.swept_bounds();
        for step in 0..=20 {
            let pose = obstacle.pose_at(step as f32 / 20.0, Vec3::ZERO);
            for corner in [half_extents, -half_extents] {
                let p = pose.point_to_world(corner);
                assert!(p.cmpge(low - 1e-5).all() && p.cmple(high + 1e-5).all());
            }
        }
    }

    #[test]
    fn invalid_obstacles_are_refused() {
        let shape = || Shape::Sphere { radius: 1.0 };
        assert!(Obstacle::new(shape(), Placement::at(Vec3::NAN), 0.5).is_err());
        assert!(Obstacle::new(shape(), Placement::default(), -1.0).is_err());
        assert!(Obstacle::new(Shape::Sphere { radius: 0.0 }, Placement::default(), 0.5).is_err());
    }
}
