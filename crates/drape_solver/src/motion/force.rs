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

/// Sums up the accelerations of a body's particles for the coming step.
pub(crate) fn accumulate(body: &mut Body, environment: &Environment, isa: Isa) {
    let Environment { dt, gravity, wind, ref wind_zones, ref obstacles, time } = *environment;
    let Body { particles, topology, settings, context, .. } = body;
    context.uniform_acceleration = gravity;
    context.acceleration.clear();
    let (low, high) = particles.bounds();
    let air = Air::new(&wind, wind_zones, obstacles, time, [low, high]);
    if air.is_none() && particles.force.is_empty() {
        return;
    }
    let forces = &mut context.acceleration.cells;
    if particles.force.is_empty() {
        forces.resize(particles.layout.cells(), Cell::default());
    } else {
        forces.extend_from_slice(&particles.force.cells);
    }
    if let Some(air) = &air {
        let thickness = settings.thickness;
        isa.run(Blow { particles, topology, thickness, air, wind: &wind, dt, forces });
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
    let Environment { dt, wind, ref wind_zones, ref obstacles, time, .. } = *environment;
    let mut particles = particles.clone();
    particles.arrange(&topology.layout);
    let (low, high) = particles.bounds();
    let Some(air) = &Air::new(&wind, wind_zones, obstacles, time, [low, high]) else {
        return Vec3::ZERO;
    };
    let mut forces = vec![Cell::default(); particles.layout.cells()];
    let (particles, thickness) = (&particles, settings.thickness);
    Isa::detected().run(Blow { particles, topology, thickness, air, wind: &wind, dt, forces: &mut forces });
    particles.layout.slots().map(|slot| forces[slot / LANES].get(slot % LANES)).sum()
}
