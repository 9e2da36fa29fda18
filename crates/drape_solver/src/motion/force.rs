//! Forces: sums gravity, wind and the caller's forces to accelerations once a step.
//!
//! `air_force.rs` has the force of the wind, `air.rs` the velocity of the air.
//!
//! Design: `docs/design/wind.md`.

use glam::Vec3;

use crate::motion::air::Air;
use crate::motion::air_force::Blow;
use crate::motion::environment::Environment;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::particles::Particles;

/// Sums up the accelerations of a body's particles for the coming step.
pub(crate) fn accumulate(body: &mut Body, environment: &Environment, isa: Isa) {
    let Body { particles, topology, settings, context, .. } = body;
    context.uniform_acceleration = environment.gravity;
    context.acceleration.clear();
    let air = air_around(particles, environment);
    if air.is_none() && particles.force.is_empty() {
        return;
    }
    if particles.force.is_empty() {
        context.acceleration.reset(particles.layout.cells());
    } else {
        context.acceleration.cells.clone_from(&particles.force.cells);
    }
    let forces = &mut context.acceleration.cells;
    if let Some(air) = &air {
        let (thickness, dt) = (settings.thickness, environment.dt);
        isa.run(Blow { particles, topology, thickness, air, dt, forces });
    }
    let (inverse_mass, _) = particles.inverse_mass.as_chunks::<LANES>();
    for (force, inverse_mass) in forces.iter_mut().zip(inverse_mass) {
        for axis in force.axes_mut() {
            axis.iter_mut().zip(inverse_mass).for_each(|(force, inverse_mass)| *force *= inverse_mass);
        }
    }
}

/// The force of the air on a body in its present state, in newtons, on pinned particles too.
pub fn wind_force(body: &Body, environment: &Environment) -> Vec3 {
    let Body { particles, topology, settings, .. } = body;
    let mut particles = particles.clone();
    particles.arrange(&topology.layout);
    let particles = &particles;
    let Some(air) = &air_around(particles, environment) else {
        return Vec3::ZERO;
    };
    let mut forces = vec![Cell::default(); particles.layout.cells()];
    let (thickness, dt) = (settings.thickness, environment.dt);
    Isa::detected().run(Blow { particles, topology, thickness, air, dt, forces: &mut forces });
    particles.layout.slots().map(|slot| forces[slot / LANES].get(slot % LANES)).sum()
}

/// The air around these particles; none if it does not move.
fn air_around<'a>(particles: &Particles, environment: &'a Environment) -> Option<Air<'a>> {
    let Environment { wind, wind_zones, obstacles, time, .. } = environment;
    let (low, high) = particles.bounds();
    Air::new(wind, wind_zones, obstacles, *time, [low, high])
}
