//! Forces: gravity, wind and what the caller adds, turned into accelerations once a step.

use glam::Vec3;

use crate::body::Body;
use crate::columns::Columns;
use crate::error::{StepError, finite_vector};
use crate::particles::Particles;

/// A wind that pushes on faces, and on the links of ropes.
///
/// Each face feels `F = 1/2 rho c A (u . n)|u . n| n` with `u` the wind relative to the face: the pressure of a
/// flow on a plate square to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Velocity of the air in m/s. Zero is no wind at all: still air brakes by the bodies' own drag.
    pub velocity: Vec3,
    /// Density of the air in kg/m^3.
    pub air_density: f32,
    /// Drag coefficient of a plate square to the wind; 1.2 for a flat one.
    pub drag_coefficient: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self { velocity: Vec3::ZERO, air_density: 1.2, drag_coefficient: 1.2 }
    }
}

impl Wind {
    /// A wind of `velocity` (m/s) in ordinary air.
    pub fn new(velocity: Vec3) -> Self {
        Self { velocity, ..Self::default() }
    }

    /// Checks that everything is finite.
    ///
    /// # Errors
    /// [`StepError::BadEnvironment`].
    pub fn validate(&self) -> Result<(), StepError> {
        let scalars = Vec3::new(self.air_density, self.drag_coefficient, 0.0);
        let finite = finite_vector("wind", self.velocity).and_then(|_| finite_vector("wind", scalars));
        finite.map(|_| ()).map_err(|_| StepError::BadEnvironment("wind"))
    }
}

/// Sums up the accelerations of a body's particles for the coming step of `dt` seconds.
pub(crate) fn accumulate(body: &mut Body, gravity: Vec3, wind: &Wind, dt: f32) {
    let Body { particles, topology, settings, context, .. } = body;
    context.uniform_acceleration = gravity;
    context.acceleration.clear();
    let blows = wind.velocity != Vec3::ZERO;
    if !blows && particles.force.is_empty() {
        return;
    }
    context.acceleration.reset(particles.layout.cells());
    if !particles.force.is_empty() {
        for i in particles.layout.slots() {
            let acceleration = particles.force.get(i) * particles.inverse_mass[i];
            context.acceleration.set(i, acceleration);
        }
    }
    if blows {
        let pressure = 0.5 * wind.air_density * wind.drag_coefficient;
        for &face in topology.faces() {
            let corners = face.map(|i| particles.layout.slot(i as usize));
            let [p, q, r] = corners.map(|i| particles.position.get(i));
            let double_area = (q - p).cross(r - p);
            let area = 0.5 * double_area.length();
            if area > 0.0 {
                let normal = double_area / (2.0 * area);
                blow(particles, &mut context.acceleration, &corners, wind, normal, pressure * area, dt);
            }
        }
        for &segment in topology.segments() {
            let ends = segment.map(|i| particles.layout.slot(i as usize));
            let along = particles.position.get(ends[1]) - particles.position.get(ends[0]);
            // A link shows the wind its profile, twice the thickness wide, and turns its side square to it.
            let area = 2.0 * settings.thickness * along.length();
            let across = wind.velocity - along * project_factor(wind.velocity, along);
            if let Some(normal) = across.try_normalize() {
                blow(particles, &mut context.acceleration, &ends, wind, normal, pressure * area, dt);
            }
        }
    }
}

fn project_factor(v: Vec3, along: Vec3) -> f32 {
    let length_squared = along.length_squared();
    if length_squared > 0.0 { v.dot(along) / length_squared } else { 0.0 }
}

/// Adds the wind on an element with these `corners`, this unit `normal` and `strength = rho c A / 2` to the
/// accelerations of its corners.
fn blow(
    particles: &Particles,
    accelerations: &mut Columns,
    corners: &[usize],
    wind: &Wind,
    normal: Vec3,
    strength: f32,
    dt: f32,
) {
    let share = 1.0 / corners.len() as f32;
    let velocity: Vec3 = corners.iter().map(|&slot| particles.displacement.get(slot)).sum::<Vec3>()
        * (share / particles.substep);
    let inverse_mass: f32 = corners.iter().map(|&i| particles.inverse_mass[i]).sum::<f32>() * share;
    let speed = (wind.velocity - velocity).dot(normal);
    let force = strength * speed * speed.abs();
    // A gust may bring a particle to the speed of the air within the step, but never past it: the explicit force
    // cannot make light cloth explode. Six faces of a grid, or two links, meet at a particle and share that limit.
    let meeting = if corners.len() == 3 { 6.0 } else { 2.0 };
    let most = speed.abs() / (dt * inverse_mass.max(f32::MIN_POSITIVE) * share * meeting);
    let force = force.clamp(-most, most);
    for &i in corners {
        let acceleration = normal * (force * share * particles.inverse_mass[i]);
        accelerations.add(i, acceleration);
    }
}
