//! Balls: rigid spheres with mass, spin and friction, moved by the same Verlet step as particles.
//!
//! Design: `docs/design/integration.md`.

use glam::{Quat, Vec3};

use crate::constants::{CONTACT_MARGIN, INITIAL_SUBSTEP};
use crate::error::{BuildError, finite_vector, in_range, positive};
use crate::geometry::pose::turned;
use crate::state::friction::Friction;
use crate::state::layers::Layers;

/// Size, mass and surface of a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BallMaterial {
    /// Radius in metres, above zero.
    pub radius: f32,
    /// Mass in kilograms, above zero.
    pub mass: f32,
    /// Drag of still air in 1/s, 0 or more.
    pub drag: f32,
    /// Coulomb friction coefficient, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, 0 or more, for surfaces that do not slide yet. A value below `friction` counts
    /// as `friction`. Two surfaces in contact use the mean of theirs.
    pub static_friction: f32,
    /// Coefficient of restitution against obstacles and other balls, from 0 (no bounce) to 1 (no loss). Two bodies in
    /// contact use the mean of theirs. Below 0.2 m/s nothing bounces. Cloth never bounces a ball.
    pub restitution: f32,
    /// Rolling resistance, 0 or more: the lever arm of the ground's reaction ahead of the centre, in parts of
    /// the radius. On level ground a rolling ball slows by `5/7 g` times this. A hard ball on a floor has
    /// 0.001 to 0.01, on grass 0.1.
    pub rolling_resistance: f32,
}

impl BallMaterial {
    /// Friction of the surface.
    pub(crate) fn surface_friction(&self) -> Friction {
        Friction::new(self.friction, self.static_friction)
    }
}

impl Default for BallMaterial {
    fn default() -> Self {
        Self {
            radius: 0.15,
            mass: 2.0,
            drag: 0.0,
            friction: 0.5,
            static_friction: 0.0,
            restitution: 0.0,
            rolling_resistance: 0.05,
        }
    }
}

/// A ball: position, displacement of the last substep, rotation and spin.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    pub(crate) position: Vec3,
    pub(crate) displacement: Vec3,
    pub(crate) substep: f32,
    pub(crate) rotation: Quat,
    /// Angular velocity in rad/s.
    pub(crate) spin: Vec3,
    pub(crate) material: BallMaterial,
    pub(crate) inverse_mass: f32,
    pub(crate) force: Vec3,
    pub(crate) layers: Layers,
    pub(crate) reports_contacts: bool,
    pub(crate) disturbed: bool,
    pub(crate) still_for: f32,
    /// The number of substeps per step that the ball needs because of a cloth near by; 0 without one.
    pub(crate) hit_substeps: f32,
    /// Metres that projections have moved the ball in this substep, as far as they count as velocity. Kept as a sum:
    /// the difference of two positions would lose too much momentum to rounding.
    pub(crate) projected: Vec3,
    pub(crate) drag: crate::state::drag::Drag,
}

impl Ball {
    /// A ball at `position` (metres) with `velocity` (m/s).
    ///
    /// # Errors
    /// [`BuildError`] if anything is not finite or out of range.
    pub fn new(material: BallMaterial, position: Vec3, velocity: Vec3) -> Result<Self, BuildError> {
        positive("radius", material.radius)?;
        positive("mass", material.mass)?;
        in_range("drag", material.drag, 0.0, 1e4)?;
        in_range("friction", material.friction, 0.0, 1e3)?;
        in_range("static_friction", material.static_friction, 0.0, 1e3)?;
        in_range("restitution", material.restitution, 0.0, 1.0)?;
        in_range("rolling_resistance", material.rolling_resistance, 0.0, 1e3)?;
        finite_vector("position", position)?;
        finite_vector("velocity", velocity)?;
        Ok(Self {
            position,
            displacement: velocity * INITIAL_SUBSTEP,
            substep: INITIAL_SUBSTEP,
            rotation: Quat::IDENTITY,
            spin: Vec3::ZERO,
            material,
            inverse_mass: 1.0 / material.mass,
            force: Vec3::ZERO,
            layers: Layers::ALL,
            reports_contacts: false,
            disturbed: true,
            still_for: 0.0,
            hit_substeps: 0.0,
            projected: Vec3::ZERO,
            drag: crate::state::drag::Drag::default(),
        })
    }

    /// A ball shot from `position` with `velocity` under `acceleration` (m/s^2). `substep` is the expected length of
    /// its substeps in seconds; the first step corrects a wrong guess.
    ///
    /// Verlet displacements are mean velocities over a substep. Starting half a substep of acceleration early,
    /// the ball runs exactly on the parabola `p + v t + a t^2 / 2` at the end of every substep.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn launch(
        material: BallMaterial,
        position: Vec3,
        velocity: Vec3,
        acceleration: Vec3,
        substep: f32,
    ) -> Result<Self, BuildError> {
        positive("substep", substep)?;
        finite_vector("acceleration", acceleration)?;
        let mut ball = Self::new(material, position, velocity - acceleration * (0.5 * substep))?;
        ball.displacement = ball.velocity() * substep;
        ball.substep = substep;
        Ok(ball)
    }

    /// The ball's material.
    pub fn material(&self) -> &BallMaterial {
        &self.material
    }

    /// Centre in the world, in metres.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// Velocity in m/s.
    pub fn velocity(&self) -> Vec3 {
        self.displacement / self.substep
    }

    /// Angular velocity in rad/s.
    pub fn spin(&self) -> Vec3 {
        self.spin
    }

    /// Orientation.
    pub fn rotation(&self) -> Quat {
        self.rotation
    }

    /// Seconds for which the ball has been slower than the threshold of rest.
    pub fn still_for(&self) -> f32 {
        self.still_for
    }

    /// The layers that the ball belongs to, and those that it touches.
    pub fn layers(&self) -> Layers {
        self.layers
    }

    /// Sets the layers that it belongs to and those that it touches.
    pub fn set_layers(&mut self, layers: Layers) {
        self.layers = layers;
    }

    /// Turns the report of the ball's contacts in [`Island::contacts`](crate::Island::contacts) on or off.
    pub fn set_reports_contacts(&mut self, reports: bool) {
        self.reports_contacts = reports;
    }

    /// Puts the ball at `position` (metres), keeping its velocity.
    pub fn set_position(&mut self, position: Vec3) {
        self.position = position;
        self.disturbed = true;
    }

    /// Makes the place `origin` (metres) the origin of the world: the ball is where it was, and rests as before, in other
    /// coordinates.
    pub fn shift_origin(&mut self, origin: Vec3) {
        self.position -= origin;
    }

    /// Sets the velocity in m/s.
    pub fn set_velocity(&mut self, velocity: Vec3) {
        self.displacement = velocity * self.substep;
        self.disturbed = true;
    }

    /// Sets the angular velocity in rad/s.
    pub fn set_spin(&mut self, spin: Vec3) {
        self.spin = spin;
        self.disturbed = true;
    }

    /// Sets the orientation.
    pub fn set_rotation(&mut self, rotation: Quat) {
        self.rotation = rotation;
    }

    /// Changes the momentum by `impulse` (newton seconds).
    pub fn apply_impulse(&mut self, impulse: Vec3) {
        self.displacement += impulse * (self.inverse_mass * self.substep);
        self.disturbed = true;
    }

    /// Adds a force (newtons) on the centre that acts through the whole of the next step.
    pub fn add_force(&mut self, force: Vec3) {
        self.force += force;
        self.disturbed = true;
    }

    /// Clears the force for the next step.
    pub fn clear_force(&mut self) {
        self.force = Vec3::ZERO;
    }

    /// Wakes the ball: it counts as edited, and its time at rest restarts.
    pub fn rouse(&mut self) {
        self.disturbed = true;
    }

    /// True if a force, an impulse or an edit has touched the ball since its last step.
    pub fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// True if position, velocity, spin, orientation and force are finite.
    pub fn is_finite(&self) -> bool {
        let motion = self.position.is_finite() && self.displacement.is_finite();
        motion && self.spin.is_finite() && self.rotation.is_finite() && self.force.is_finite()
    }

    /// Kinetic energy of flight and spin, in joules.
    pub fn kinetic_energy(&self) -> f32 {
        let spin = self.moment_of_inertia() * self.spin.length_squared();
        0.5 * (self.material.mass * self.velocity().length_squared() + spin)
    }

    /// Moment of inertia of a solid sphere, in kg m^2.
    pub(crate) fn moment_of_inertia(&self) -> f32 {
        0.4 * self.material.mass * self.material.radius * self.material.radius
    }

    /// Rescales the displacement to a substep of `substep` seconds. A displacement is the mean velocity over a substep,
    /// so half a substep old. The correction by `acceleration` allows for that age and keeps the ball on its parabola.
    pub(crate) fn set_substep(&mut self, substep: f32, acceleration: Vec3) {
        if substep != self.substep {
            let correction = acceleration * (0.5 * (self.substep - substep));
            self.displacement = (self.displacement / self.substep + correction) * substep;
            self.substep = substep;
        }
    }

    /// Displacement of this substep so far: integration and projections.
    pub(crate) fn travel(&self) -> Vec3 {
        self.displacement + self.projected
    }

    /// Moves the ball by a projection: `contact` counts as velocity, `position_only` does not.
    pub(crate) fn project(&mut self, contact: Vec3, position_only: Vec3) {
        self.position += contact + position_only;
        self.projected += contact;
    }

    /// Greatest distance in metres that the ball's surface can get from its present centre in `dt` seconds, under
    /// gravity of size `gravity` (m/s^2).
    pub fn reach(&self, dt: f32, gravity: f32) -> f32 {
        let path =
            self.velocity().length() * dt + (gravity + self.force.length() * self.inverse_mass) * dt * dt;
        self.material.radius + path + CONTACT_MARGIN
    }

    /// Displacement, over the substep, of the surface point at `arm` from the centre.
    pub(crate) fn surface_travel(&self, arm: Vec3) -> Vec3 {
        self.displacement + self.spin.cross(arm) * self.substep
    }

    /// Moves the surface point at `arm` by the tangential `push` (kilogram metres) of friction, which changes flight
    /// and spin. The effective inverse mass against such a push is `1/m + r^2/I = 3.5/m`.
    pub(crate) fn push_surface(&mut self, arm: Vec3, push: Vec3) {
        let shift = push * self.inverse_mass;
        self.position += shift;
        self.displacement += shift;
        let radius = self.material.radius;
        self.spin += arm.cross(push) * (2.5 * self.inverse_mass / (radius * radius * self.substep));
    }

    /// Inverse mass of the point at `arm` from the centre against a push across that arm, in 1/kg: `1/m + arm^2/I`.
    pub(crate) fn surface_inverse_mass(&self, arm: Vec3) -> f32 {
        let radius = self.material.radius;
        self.inverse_mass * (1.0 + 2.5 * arm.length_squared() / (radius * radius))
    }

    /// Turns by the spin of one substep.
    pub(crate) fn turn(&mut self) {
        if self.spin != Vec3::ZERO {
            self.rotation = turned(self.rotation, self.spin * self.substep);
        }
    }
}

/// Inverse mass of a ball's surface against a tangential push, in units of its inverse mass: `1 + m r^2 / I`
/// with the `I = 2/5 m r^2` of a solid sphere.
pub(crate) const SURFACE_INVERSE_MASS: f32 = 3.5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_balls_are_refused() {
        let good = BallMaterial::default();
        let bad = [
            BallMaterial { radius: 0.0, ..good },
            BallMaterial { radius: f32::NAN, ..good },
            BallMaterial { mass: -1.0, ..good },
            BallMaterial { mass: f32::INFINITY, ..good },
            BallMaterial { drag: -1.0, ..good },
            BallMaterial { friction: f32::NAN, ..good },
            BallMaterial { static_friction: -1.0, ..good },
            BallMaterial { restitution: 1.1, ..good },
        ];
        for material in bad {
            assert!(Ball::new(material, Vec3::ZERO, Vec3::ZERO).is_err());
        }
        assert!(Ball::new(good, Vec3::NAN, Vec3::ZERO).is_err());
        assert!(Ball::new(good, Vec3::ZERO, Vec3::INFINITY).is_err());
    }

    #[test]
    fn pushing_the_surface_keeps_angular_momentum_about_the_point_pushed() {
        let mut ball = Ball::new(BallMaterial::default(), Vec3::ZERO, Vec3::ZERO).expect("valid");
        let arm = Vec3::NEG_Y * ball.material.radius;
        ball.push_surface(arm, Vec3::X * 0.01);
        let m = ball.material;
        let orbital = (-arm).cross(ball.velocity()) * m.mass;
        let spin = ball.spin * (0.4 * m.mass * m.radius * m.radius);
        assert!((orbital + spin).length() < 1e-6 * orbital.length());
    }
}
