//! This project's solver on a scene.

use std::sync::Arc;
use std::time::{Duration, Instant};

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, BuildError, Environment, Island, Obstacle, Particles, Placement, Shape, StateHasher,
    StickMaterial, StickProjection, StructuralSolve, Topology, TopologyBuilder, step, step_on,
};
use rayon::prelude::*;

use crate::failure::Failure;
use crate::scenes::model::Model;
use crate::scenes::scene::Scene;
use crate::scenes::world::{GRAVITY, LOWEST, SPHERE_CENTRE, SPHERE_RADIUS, STEP};
use crate::solvers::options::{Projection, SolverOptions};
use crate::solvers::simulation::Simulation;
use crate::solvers::threads::RayonPool;

/// Each body of the scene as an island.
pub struct Drape {
    islands: Vec<Island>,
    environment: Environment,
    threads: u32,
}

impl Drape {
    /// Loads `scene`. Equal bodies share their topology. Several threads need a call within
    /// [`on_threads`](super::threads::on_threads).
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses the bodies.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Result<Self, Failure> {
        let topology = Arc::new(topology(&scene.model)?);
        let settings = settings(options);
        let islands = (0..scene.bodies).map(|i| {
            let particles = particles(&scene.model, scene.offset(i))?;
            let body = Body::new(particles, Arc::clone(&topology), settings);
            Ok(Island { isa: options.isa, ..Island::of_body(body) })
        });
        let islands: Vec<Island> = islands.collect::<Result<_, BuildError>>()?;
        Ok(Self { islands, environment: environment()?, threads: options.threads })
    }
}

/// Takes one step of all islands, which is the timed part. Threads share several islands, or the body of a single one.
fn step_islands(islands: &mut [Island], environment: &Environment, threads: u32) -> Result<(), Failure> {
    match islands {
        [island] if threads > 1 => step_on(island, environment, &RayonPool)?,
        islands if threads > 1 => {
            let share = islands.len().div_ceil(4 * rayon::current_num_threads());
            let chunks = islands.par_chunks_mut(share);
            chunks.try_for_each(|chunk| chunk.iter_mut().try_for_each(|island| step(island, environment)))?;
        }
        islands => islands.iter_mut().try_for_each(|island| step(island, environment))?,
    }
    Ok(())
}

/// The model's sticks, rigid, and its tethers.
///
/// # Errors
/// [`BuildError`] if the solver refuses them.
pub fn topology(model: &Model) -> Result<Topology, BuildError> {
    let mut builder = match model.grid {
        Some([columns, rows]) => TopologyBuilder::grid(&model.positions, columns, rows)?,
        None => TopologyBuilder::new(&model.positions),
    };
    for family in &model.families {
        let material = StickMaterial::rigid(family.kind);
        match model.grid {
            Some(_) => builder.grid_family(material, family.offset)?,
            None => builder.family(material, family.sticks.iter().copied())?,
        };
    }
    builder.straight_tethers(&model.pinned)?;
    builder.build()
}

/// The model's particles, moved by `offset` in metres.
///
/// # Errors
/// [`BuildError`] if the solver refuses them.
pub fn particles(model: &Model, offset: Vec3) -> Result<Particles, BuildError> {
    let positions: Vec<Vec3> = model.positions.iter().map(|&position| position + offset).collect();
    Particles::new(offset, &positions, &model.inverse_masses())
}

/// Settings without drag, friction or thickness, as the peers have none.
pub fn settings(options: &SolverOptions) -> BodySettings {
    BodySettings {
        substeps: options.substeps,
        iterations: options.sweeps,
        drag: 0.0,
        friction: 0.0,
        thickness: 0.0,
        projection: match options.projection {
            Projection::Exact => StickProjection::Exact,
            Projection::SquareRootFree => StickProjection::SquareRootFree,
        },
        structural: if options.lines { StructuralSolve::Lines } else { StructuralSolve::Sweeps },
        ..BodySettings::default()
    }
}

/// Gravity and the sphere of all scenes.
///
/// # Errors
/// [`BuildError`] if the solver refuses them.
pub fn environment() -> Result<Environment, BuildError> {
    let shape = Shape::Sphere { radius: SPHERE_RADIUS };
    let sphere = Obstacle::new(shape, Placement::at(SPHERE_CENTRE), 0.0)?;
    Ok(Environment { dt: STEP, gravity: GRAVITY, obstacles: vec![sphere].into(), ..Environment::default() })
}

/// Energy of the free particles in joules.
pub fn energy(particles: &Particles) -> f64 {
    let lowest = measure::mass(particles) * f64::from(GRAVITY.y * LOWEST);
    measure::kinetic_energy(particles) + measure::potential_energy(particles, GRAVITY) + lowest
}

/// Memory per particle of an island's first body in bytes. So many equal bodies share its topology.
fn bytes_per_particle(island: &Island, bodies: usize) -> f64 {
    let body = &island.bodies[0];
    let shared = body.topology.bytes();
    ((island.body_bytes(0) - shared) as f64 + shared as f64 / bodies as f64) / body.particles.len() as f64
}

/// Hash of `positions`, computed in the same way for all solvers; 0 if one is not finite.
pub fn state_hash(positions: &[Vec3]) -> u64 {
    match Particles::new(Vec3::ZERO, positions, &vec![0.0; positions.len()]) {
        Ok(particles) => StateHasher::new().particles(&particles).finish(),
        Err(_) => 0,
    }
}

impl Simulation for Drape {
    fn step(&mut self) -> Result<Duration, Failure> {
        let start = Instant::now();
        step_islands(&mut self.islands, &self.environment, self.threads)?;
        Ok(start.elapsed())
    }

    fn positions(&self) -> Vec<Vec3> {
        let bodies = self.islands.iter().flat_map(|island| &island.bodies);
        bodies.flat_map(|body| body.particles.positions()).collect()
    }

    fn energy(&self) -> Option<f64> {
        let bodies = self.islands.iter().flat_map(|island| &island.bodies);
        Some(bodies.map(|body| energy(&body.particles)).sum())
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        self.islands.first().map(|island| bytes_per_particle(island, self.islands.len()))
    }

    fn isa(&self) -> &'static str {
        self.islands.first().map_or("none", |island| island.isa.name())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::scenes::model::Pins;
    use crate::scenes::scene::SceneKind;

    #[test]
    fn the_solver_has_the_models_sticks_at_the_models_lengths() {
        for (kind, n) in [(SceneKind::Sheet, 9), (SceneKind::Mesh, 300), (SceneKind::Ropes, 2)] {
            let model = Scene::new(kind, n, Pins::Corners).expect("a scene").model;
            let topology = topology(&model).expect("valid");
            let mut lengths: HashMap<[u32; 2], f32> =
                model.natural_order.iter().map(|&stick| (sorted(stick), model.rest_length(stick))).collect();
            for i in 0..topology.stick_count() {
                let length = lengths.remove(&sorted(topology.stick(i))).expect("one of the model's");
                assert!((topology.rest_length(i) - length).abs() < 1e-6);
            }
            assert!(lengths.is_empty());
        }
    }

    fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
        [a.min(b), a.max(b)]
    }
}
