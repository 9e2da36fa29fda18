//! This project's solver on the workload.

use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::{
    Body, Environment, Island, Obstacle, Particles, Placement, Shape, SolverSettings, StateHasher, StickKind,
    StickMaterial, Tethers, TopologyBuilder, measure, step,
};

use crate::contender::Contender;
use crate::workload::{GRAVITY, LOWEST, SPHERE_CENTRE, SPHERE_RADIUS, STEP, Sheet};

/// The sheet as a body of the solver.
pub struct Drape {
    island: Island,
    environment: Environment,
}

impl Drape {
    /// Loads the sheet: rigid sticks, tethers, no drag, no friction, no thickness.
    ///
    /// # Panics
    /// If the solver refuses the workload, which would be a bug in one of the two.
    pub fn new(sheet: &Sheet, substeps: u32, sweeps: u32) -> Self {
        let positions = sheet.positions();
        let kinds = [
            StickKind::Structural,
            StickKind::Structural,
            StickKind::Shear,
            StickKind::Shear,
            StickKind::Bend,
            StickKind::Bend,
        ];
        let mut builder = TopologyBuilder::new(&positions);
        for (family, kind) in sheet.families().into_iter().zip(kinds) {
            builder.family(StickMaterial::rigid(kind), family).expect("a valid family");
        }
        builder.tethers(Tethers::straight(&positions, &sheet.pinned())).expect("valid tethers");
        let topology = builder.build().expect("a valid topology");
        let particles =
            Particles::new(Vec3::ZERO, &positions, &sheet.inverse_masses()).expect("valid particles");
        let settings = SolverSettings {
            substeps,
            iterations: sweeps,
            drag: 0.0,
            friction: 0.0,
            thickness: 0.0,
            ..SolverSettings::default()
        };
        let shape = Shape::Sphere { radius: SPHERE_RADIUS };
        let sphere = Obstacle::new(shape, Placement::at(SPHERE_CENTRE), 0.0).expect("a valid sphere");
        Self {
            island: Island::of_body(Body::new(particles, Arc::new(topology), settings)),
            environment: Environment {
                dt: STEP,
                gravity: GRAVITY,
                obstacles: vec![sphere],
                ..Environment::default()
            },
        }
    }
}

impl Contender for Drape {
    fn step(&mut self) {
        step(&mut self.island, &self.environment).expect("a finite state");
    }

    fn positions(&self) -> Vec<Vec3> {
        self.island.bodies[0].particles.positions().collect()
    }

    fn energy(&self) -> f64 {
        let body = &self.island.bodies[0];
        let lowest = measure::mass(&body.particles) * f64::from(GRAVITY.y * LOWEST);
        measure::mechanical_energy(body, GRAVITY) + lowest
    }

    fn bytes_per_particle(&self) -> f64 {
        let topology = &self.island.bodies[0].topology;
        // Position, displacement, start of the substep: nine floats, and the inverse mass; two ends and a length
        // per stick; particle, pin and length per tether.
        let bytes = 12 * (topology.stick_count() + topology.tethers().len());
        40.0 + bytes as f64 / topology.particle_count() as f64
    }
}

/// Hash of `positions`, the same way for all solvers; 0 if one is not finite.
pub fn state_hash(positions: &[Vec3]) -> u64 {
    match Particles::new(Vec3::ZERO, positions, &vec![0.0; positions.len()]) {
        Ok(particles) => StateHasher::new().particles(&particles).finish(),
        Err(_) => 0,
    }
}
