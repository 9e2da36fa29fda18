//! Forces: sums gravity, wind and the caller's forces to accelerations once a step.
//!
//! `push_on` has the force of the wind on a face or link, `wind.rs` the velocity of the air.
//!
//! Design: `docs/design/wind.md`.

use glam::Vec3;

use crate::motion::environment::Environment;
use crate::motion::wind::{Air, Wind};
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::topology::Topology;

/// Sums up the accelerations of a body's particles for the coming step.
pub(crate) fn accumulate(body: &mut Body, environment: &Environment) {
    let Environment { dt, gravity, wind, ref wind_zones, ref obstacles, time } = *environment;
    let Body { particles, topology, settings, context, .. } = body;
    context.uniform_acceleration = gravity;
    context.acceleration.clear();
    let (low, high) = particles.bounds();
    let air = Air::new(&wind, wind_zones, obstacles, time, [low, high]);
    if air.is_none() && particles.force.is_empty() {
        return;
    }
    context.acceleration.reset(particles.layout.cells());
    if !particles.force.is_empty() {
        for i in particles.layout.slots() {
            let acceleration = particles.force.get(i) * particles.inverse_mass[i];
            context.acceleration.set(i, acceleration);
        }
    }
    let Some(air) = air else { return };
    let accelerations = &mut context.acceleration;
    blow(
        particles,
        topology,
        settings.thickness,
        &air,
        &wind,
        dt,
        |corners, AirForce { normal, size, lift }| {
            let share = 1.0 / corners.len() as f32;
            for &i in corners {
                accelerations.add(i, normal * (size * share * particles.inverse_mass[i]));
            }
            if lift != Vec3::ZERO {
                corners
                    .iter()
                    .for_each(|&i| accelerations.add(i, lift * (share * particles.inverse_mass[i])));
            }
        },
    );
}

/// The force of the air on a body in its present state, in newtons, on pinned particles too.
pub fn wind_force(body: &Body, environment: &Environment) -> Vec3 {
    let Body { particles, topology, settings, .. } = body;
    let Environment { dt, wind, ref wind_zones, ref obstacles, time, .. } = *environment;
    let mut sum = Vec3::ZERO;
    let mut particles = particles.clone();
    particles.arrange(&topology.layout);
    let (low, high) = particles.bounds();
    if let Some(air) = Air::new(&wind, wind_zones, obstacles, time, [low, high]) {
        blow(&particles, topology, settings.thickness, &air, &wind, dt, |_, push| {
            sum += push.normal * push.size + push.lift;
        });
    }
    sum
}

/// Force of the air on a face or link: `size` along `normal`, and lift, in newtons.
struct AirForce {
    normal: Vec3,
    size: f32,
    lift: Vec3,
}

/// Calls `push` for each face and link, with the slots of its corners and the force of the air.
fn blow(
    particles: &Particles,
    topology: &Topology,
    thickness: f32,
    air: &Air,
    wind: &Wind,
    dt: f32,
    mut push: impl FnMut(&[usize], AirForce),
) {
    for &face in topology.faces() {
        let corners = face.map(|i| particles.layout.slot(i as usize));
        let [p, q, r] = corners.map(|i| particles.position.get(i));
        let double_area = (q - p).cross(r - p);
        let area = 0.5 * double_area.length();
        if area > 0.0 {
            let normal = double_area / (2.0 * area);
            let velocity = air.velocity_at(particles.origin + (p + q + r) / 3.0);
            push(&corners, push_on(particles, &corners, velocity, normal, area, wind, dt));
        }
    }
    for &segment in topology.segments() {
        let ends = segment.map(|i| particles.layout.slot(i as usize));
        let [p, q] = ends.map(|i| particles.position.get(i));
        let along = q - p;
        // The profile of a link is twice the thickness wide, and the wind always meets it squarely.
        let area = 2.0 * thickness * along.length();
        let velocity = air.velocity_at(particles.origin + p.midpoint(q));
        let across = velocity - along * project_factor(velocity, along);
        if let Some(normal) = across.try_normalize() {
            push(&ends, push_on(particles, &ends, velocity, normal, area, wind, dt));
        }
    }
}

fn project_factor(v: Vec3, along: Vec3) -> f32 {
    let length_squared = along.length_squared();
    if length_squared > 0.0 { v.dot(along) / length_squared } else { 0.0 }
}

/// Force of a wind of this `velocity` (m/s) on an element with these `corners`, this unit `normal` and `area` (m^2).
fn push_on(
    particles: &Particles,
    corners: &[usize],
    velocity: Vec3,
    normal: Vec3,
    area: f32,
    wind: &Wind,
    dt: f32,
) -> AirForce {
    let share = 1.0 / corners.len() as f32;
    let own: Vec3 = corners.iter().map(|&slot| particles.displacement.get(slot)).sum::<Vec3>()
        * (share / particles.substep);
    let inverse_mass: f32 = corners.iter().map(|&i| particles.inverse_mass[i]).sum::<f32>() * share;
    let relative = velocity - own;
    let speed = relative.dot(normal);
    let strength = 0.5 * wind.air_density * wind.drag_coefficient * area;
    let force = strength * speed * speed.abs();
    // A gust may bring a particle to the speed of the air within the step, but never past it: the explicit force
    // cannot make light cloth explode. Six faces of a grid, or two links, meet at a particle and share that limit.
    let meeting = if corners.len() == 3 { 6.0 } else { 2.0 };
    let by_force = dt * inverse_mass.max(f32::MIN_POSITIVE) * share * meeting;
    let most = speed.abs() / by_force;
    // Not `clamp`, which panics on a NaN limit; the step itself rejects bodies that are not finite.
    let size = if force.abs() > most { most.copysign(force) } else { force };
    let lift = if wind.lift_coefficient != 0.0 && corners.len() == 3 {
        let strength = 0.5 * wind.air_density * wind.lift_coefficient * area;
        lift(relative, normal, strength).clamp_length_max(relative.length() / by_force)
    } else {
        Vec3::ZERO
    };
    AirForce { normal, size, lift }
}

/// The lift on a face in newtons: at right angles to the wind, so that it does no work in the air's own frame.
fn lift(relative: Vec3, normal: Vec3, strength: f32) -> Vec3 {
    let size = relative.length();
    if size == 0.0 {
        return Vec3::ZERO;
    }
    let across = relative.dot(normal);
    (normal * (size * size) - relative * across) * (strength * across / size)
}
