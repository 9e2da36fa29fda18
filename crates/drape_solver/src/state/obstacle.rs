//! Obstacles: the shapes that bodies and balls collide with.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;

use crate::constants::TELEPORT_SPEED;
use crate::error::{BuildError, in_range};
use crate::geometry::pose::{Placement, Pose};
use crate::geometry::shape::Shape;
use crate::state::combine_rule::CombineRule;
use crate::state::friction::Friction;
use crate::state::layers::Layers;
use crate::state::obstacle_flight::Flight;

/// A shape at a place, still or moving.
#[derive(Clone, Debug)]
pub struct Obstacle {
    shape: Shape,
    pub(super) placement: Placement,
    /// Placement one step ago; the difference is the velocity that contact and friction use.
    pub(super) before: Placement,
    /// Box of all places on the way between the two: the broad phase asks for it several times a step.
    swept_bounds: (Vec3, Vec3),
    /// A distance within which no point is farther from the origin of the shape.
    radius: f32,
    friction: Friction,
    friction_rule: CombineRule,
    restitution: f32,
    restitution_rule: CombineRule,
    layers: Layers,
    is_sensor: bool,
    reports_contacts: bool,
    reports_reaction: bool,
    /// Rigid motion of a dynamic obstacle; none for one that only the caller moves.
    pub(super) flight: Option<Flight>,
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
        let (low, high) = shape.local_bounds();
        let radius = low.abs().max(high.abs()).length();
        let obstacle = Self { shape, placement, before: placement, radius, friction, ..Self::ground() };
        Ok(Self { swept_bounds: obstacle.bounds_on_its_way(), ..obstacle })
    }

    /// The horizontal ground at height 0, with friction 0.5.
    pub fn ground() -> Self {
        Self {
            shape: Shape::HalfSpace { normal: Vec3::Y },
            placement: Placement::default(),
            before: Placement::default(),
            swept_bounds: EVERYWHERE,
            radius: f32::INFINITY,
            friction: Friction::new(0.5, 0.5),
            friction_rule: CombineRule::default(),
            restitution: 0.0,
            restitution_rule: CombineRule::default(),
            layers: Layers::ALL,
            is_sensor: false,
            reports_contacts: false,
            reports_reaction: false,
            flight: None,
        }
    }

    /// Returns the obstacle in these layers.
    #[must_use]
    pub fn with_layers(self, layers: Layers) -> Self {
        Self { layers, ..self }
    }

    /// Returns the obstacle as a sensor, which moves nothing and reports contacts at the end of each substep. It
    /// reports a contact only if the sensor, or the thing that touches it, [reports
    /// contacts](Self::reporting_contacts).
    #[must_use]
    pub fn as_sensor(self) -> Self {
        Self { is_sensor: true, ..self }
    }

    /// Returns the obstacle with its contacts reported in [`Island::contacts`](crate::Island::contacts).
    #[must_use]
    pub fn reporting_contacts(self) -> Self {
        Self { reports_contacts: true, ..self }
    }

    /// Returns the obstacle with its reactions reported in [`Island::reactions`](crate::Island::reactions): the exact
    /// opposite of all impulses that it gave to bodies and balls. Things near such an obstacle are stepped substep by
    /// substep.
    ///
    /// During a step the obstacle moves only by [`move_to`](Self::move_to); the caller applies the reaction after the
    /// step. This conserves momentum and angular momentum. The coupling is explicit: in the step of a hit the obstacle
    /// acts as if its mass were infinite. A hit without a bounce gains no energy if the obstacle's effective mass at
    /// the point of contact is at least the mass that it stops in one step; with a restitution of `e`, `(1 + e) / (1 -
    /// e)` times that mass. An obstacle that [has its body here](Self::with_rigid_body) has no such limit.
    #[must_use]
    pub fn reporting_reaction(self) -> Self {
        Self { reports_reaction: true, ..self }
    }

    /// True if [`Island::reactions`](crate::Island::reactions) reports the impulses on it.
    pub fn reports_reaction(&self) -> bool {
        self.reports_reaction
    }

    /// True if the impulses that it gives to bodies and balls are summed up, for a report or for its own motion.
    pub(crate) fn keeps_account(&self) -> bool {
        self.reports_reaction || self.flight.is_some()
    }

    /// The layers that the obstacle belongs to, and those that it touches.
    pub fn layers(&self) -> Layers {
        self.layers
    }

    /// True if the obstacle is a sensor, which moves nothing.
    pub fn is_sensor(&self) -> bool {
        self.is_sensor
    }

    /// True if [`Island::contacts`](crate::Island::contacts) reports its contacts.
    pub fn reports_contacts(&self) -> bool {
        self.reports_contacts
    }

    /// True if the obstacle collides with things in these layers.
    pub(crate) fn stops(&self, layers: Layers) -> bool {
        !self.is_sensor && self.layers.interact(layers)
    }

    /// True if the obstacle is a sensor for things in these layers.
    pub(crate) fn senses(&self, layers: Layers) -> bool {
        self.is_sensor && self.layers.interact(layers)
    }

    /// The shape.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// The placement at the end of the coming step.
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// The placement at the start of the step.
    pub fn previous_placement(&self) -> Placement {
        self.before
    }

    /// Sets the coefficient of static friction (0 or more), for surfaces that do not slide yet. A value below the
    /// kinetic coefficient counts as that.
    ///
    /// # Errors
    /// [`BuildError`] if it is out of range.
    pub fn with_static_friction(mut self, coefficient: f32) -> Result<Self, BuildError> {
        in_range("static_friction", coefficient, 0.0, 1e3)?;
        self.friction = Friction::new(self.friction.kinetic, coefficient);
        Ok(self)
    }

    /// Sets the coefficient of restitution against balls, from 0 (no bounce) to 1 (no loss).
    ///
    /// # Errors
    /// [`BuildError`] if it is out of range.
    pub fn with_restitution(mut self, coefficient: f32) -> Result<Self, BuildError> {
        in_range("restitution", coefficient, 0.0, 1.0)?;
        self.restitution = coefficient;
        Ok(self)
    }

    /// Returns the obstacle with the rules by which its coefficients of friction and of restitution and those of what
    /// touches it become one.
    #[must_use]
    pub fn with_combine_rules(self, friction: CombineRule, restitution: CombineRule) -> Self {
        Self { friction_rule: friction, restitution_rule: restitution, ..self }
    }

    /// The coefficient of kinetic friction.
    pub fn friction(&self) -> f32 {
        self.friction.kinetic
    }

    /// The coefficient of static friction, at least that of kinetic friction.
    pub fn static_friction(&self) -> f32 {
        self.friction.sticking
    }

    /// The rule by which its friction and that of what touches it become one.
    pub fn friction_rule(&self) -> CombineRule {
        self.friction_rule
    }

    /// The coefficient of restitution.
    pub fn restitution(&self) -> f32 {
        self.restitution
    }

    /// Friction between the obstacle and another surface.
    pub(crate) fn friction_against(&self, other: Friction) -> Friction {
        other.with_by(self.friction, self.friction_rule)
    }

    /// Restitution between the obstacle and something of this coefficient.
    pub(crate) fn restitution_against(&self, other: f32) -> f32 {
        self.restitution_rule.combine(other, self.restitution)
    }

    /// True if the obstacle moves in the coming step.
    pub fn is_moving(&self) -> bool {
        self.before != self.placement
    }

    /// The placement at the start of the coming step.
    pub(crate) fn start(&self) -> Placement {
        self.before
    }

    /// Moves the obstacle to `placement` in the coming step of `dt` seconds, evenly over the substeps; it carries along
    /// the things that touch it. A move faster than 1500 m/s is a [teleport](Self::teleport). An invalid placement is
    /// ignored.
    pub fn move_to(&mut self, placement: Placement, dt: f32) {
        if !placement.is_valid() {
            return;
        }
        self.set_way(self.start_towards(placement, dt), placement);
    }

    /// Moves the obstacle as [`move_to`](Self::move_to) does, but no search finds it until it is moved again.
    pub(super) fn move_out_of_reach(&mut self, placement: Placement, dt: f32) {
        (self.before, self.placement) = (self.start_towards(placement, dt), placement);
        self.swept_bounds = NOWHERE;
    }

    /// True if it was moved [out of reach](crate::Obstacles::move_out_of_reach).
    pub fn is_out_of_reach(&self) -> bool {
        self.swept_bounds == NOWHERE
    }

    /// A distance in metres within which no point of the obstacle is farther from the origin of its shape; infinite for
    /// some shapes.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// The placement at which a move to another one starts.
    fn start_towards(&self, placement: Placement, dt: f32) -> Placement {
        let moved = placement.translation.distance(self.placement.translation);
        if moved > TELEPORT_SPEED * dt { placement } else { self.placement }
    }

    /// Puts the obstacle at `placement` without any velocity. An invalid placement is ignored.
    pub fn teleport(&mut self, placement: Placement) {
        if placement.is_valid() {
            self.set_way(placement, placement);
        }
    }

    /// Takes its places to other coordinates, by a function of a place: it is where it was, and moves on as before.
    pub(super) fn change_coordinates(&mut self, changed: impl Fn(Vec3) -> Vec3) {
        let free = self.flight.as_mut().map(|flight| &mut flight.free.1);
        for place in [&mut self.before, &mut self.placement].into_iter().chain(free) {
            place.translation = changed(place.translation);
        }
        if !self.is_out_of_reach() {
            self.swept_bounds = self.bounds_on_its_way();
        }
    }

    pub(super) fn set_way(&mut self, from: Placement, to: Placement) {
        (self.before, self.placement) = (from, to);
        self.swept_bounds = self.bounds_on_its_way();
    }

    /// The pose at `fraction` of the step, relative to `origin`.
    pub(crate) fn pose_at(&self, fraction: f32, origin: Vec3) -> Pose {
        if self.is_moving() {
            Pose::between(&self.before, &self.placement, fraction, origin)
        } else {
            Pose::at(&self.placement, origin)
        }
    }

    /// Upper bound in metres on the path of any of its points in the step, for searches.
    pub(crate) fn travel(&self) -> f32 {
        if !self.is_moving() {
            return 0.0;
        }
        let moved = self.placement.translation.distance(self.before.translation);
        let arm = self.radius();
        let (p, q) = (self.before.rotation, self.placement.rotation);
        // The difference is `2 sin(angle / 4)` long: four times that is at least the arc.
        let turn = if p == q { 0.0 } else { 4.0 * (p - q).length().min((p + q).length()) };
        if arm.is_finite() { moved + arm * turn } else { moved + turn }
    }

    /// A box around the obstacle through the whole step, as (least, greatest) corner in the world.
    pub fn swept_bounds(&self) -> (Vec3, Vec3) {
        self.swept_bounds
    }

    fn bounds_on_its_way(&self) -> (Vec3, Vec3) {
        let (low, high) = self.shape.local_bounds();
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        if !half.is_finite() {
            return EVERYWHERE;
        }
        let end = Pose::at(&self.placement, Vec3::ZERO);
        let (low, high) = end.bounds_of(middle, half);
        if !self.is_moving() {
            return (low, high);
        }
        let is_turning = self.before.rotation != self.placement.rotation;
        let start = if is_turning {
            Pose::at(&self.before, Vec3::ZERO)
        } else {
            end.moved_to(self.before.translation)
        };
        let (low_before, high_before) = start.bounds_of(middle, half);
        // A turning box bulges out between the two ends by less than its travel.
        let slack = if is_turning { self.travel() } else { 0.0 };
        (low.min(low_before) - slack, high.max(high_before) + slack)
    }
}

/// The bounds of a shape without bounds.
const EVERYWHERE: (Vec3, Vec3) = (Vec3::NEG_INFINITY, Vec3::INFINITY);

/// The bounds of an obstacle that no search finds.
const NOWHERE: (Vec3, Vec3) = (Vec3::INFINITY, Vec3::NEG_INFINITY);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::obstacle_motion::MovedObstacle;
    use crate::state::rigid_body::RigidBody;
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
    fn swept_bounds_follow_every_change_of_place() {
        let at = |x: f32| Placement::at(Vec3::X * x);
        let body = RigidBody::new(1.0, Vec3::ONE).expect("valid");
        let ball = Obstacle::new(Shape::Sphere { radius: 0.5 }, at(0.0), 0.5).expect("valid");
        let mut ball = ball.with_rigid_body(body);
        let bounds = |ball: &Obstacle| [ball.swept_bounds().0.x, ball.swept_bounds().1.x];
        ball.teleport(at(5.0));
        assert_eq!(bounds(&ball), [4.5, 5.5]);
        ball.fly_to(at(6.0), 0.1);
        assert_eq!(bounds(&ball), [4.5, 6.5]);
        ball.land(&MovedObstacle { obstacle: 0, placement: at(8.0), body });
        assert_eq!(bounds(&ball), [4.5, 8.5]);
        ball.move_to(at(8.0), 0.1);
        assert_eq!(bounds(&ball), [7.5, 8.5]);
        ball.move_out_of_reach(at(9.0), 0.1);
        assert_eq!((bounds(&ball), ball.is_moving()), ([f32::INFINITY, f32::NEG_INFINITY], true));
        ball.move_to(at(9.5), 0.1);
        assert_eq!(bounds(&ball), [8.5, 10.0]);
    }

    #[test]
    fn no_point_is_farther_than_the_radius() {
        let half_extents = Vec3::new(2.0, 3.0, 6.0);
        let cuboid = Obstacle::new(Shape::Cuboid { half_extents }, Placement::at(Vec3::X), 0.5);
        assert_eq!(cuboid.expect("valid").radius(), 7.0);
        let plane = Obstacle::new(Shape::HalfSpace { normal: Vec3::Y }, Placement::default(), 0.5);
        assert_eq!([plane.expect("valid"), Obstacle::ground()].map(|o| o.radius()), [f32::INFINITY; 2]);
    }

    #[test]
    fn invalid_obstacles_are_refused() {
        let shape = || Shape::Sphere { radius: 1.0 };
        assert!(Obstacle::new(shape(), Placement::at(Vec3::NAN), 0.5).is_err());
        assert!(Obstacle::new(shape(), Placement::default(), -1.0).is_err());
        assert!(Obstacle::new(Shape::Sphere { radius: 0.0 }, Placement::default(), 0.5).is_err());
    }
}
