//! This project's solver on the GPU, on a scene.

use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use drape_gpu::{Gpu, GpuBodyId, GpuError, GpuWorld};
use drape_solver::glam::Vec3;
use drape_solver::{Body, Environment};

use crate::failure::Failure;
use crate::scenes::scene::Scene;
use crate::solvers::drape;
use crate::solvers::options::SolverOptions;
use crate::solvers::simulation::Simulation;

/// The bodies of the scene in one world on the GPU.
pub struct DrapeGpu {
    gpu: Gpu,
    world: GpuWorld,
    bodies: Vec<GpuBodyId>,
    environment: Environment,
}

impl DrapeGpu {
    /// Loads `scene`. Equal bodies share their topology.
    ///
    /// # Errors
    /// [`Failure`] if there is no adapter, or the solver refuses the bodies.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Result<Self, Failure> {
        let gpu = adapter()?;
        let topology = Arc::new(drape::topology(&scene.model)?);
        let settings = drape::settings(options);
        let mut world = GpuWorld::new(&gpu);
        let bodies = (0..scene.bodies).map(|i| {
            let particles = drape::particles(&scene.model, scene.offset(i))?;
            Ok(world.add(&Body::new(particles, Arc::clone(&topology), settings))?)
        });
        let bodies = bodies.collect::<Result<_, Failure>>()?;
        Ok(Self { gpu, world, bodies, environment: drape::environment()? })
    }

    /// The world of the scene's bodies.
    pub fn world(&self) -> &GpuWorld {
        &self.world
    }

    /// Starts a step, and returns before it is done.
    ///
    /// # Errors
    /// As [`GpuWorld::step`].
    pub fn start_step(&mut self) -> Result<(), GpuError> {
        self.world.step(&self.environment)
    }
}

/// The adapter that all simulations of this process share.
///
/// # Errors
/// If there is none.
pub fn adapter() -> Result<Gpu, GpuError> {
    static GPU: OnceLock<Result<Gpu, GpuError>> = OnceLock::new();
    GPU.get_or_init(Gpu::open).clone()
}

impl Simulation for DrapeGpu {
    fn step(&mut self) -> Result<Duration, Failure> {
        let start = Instant::now();
        self.start_step()?;
        self.gpu.wait()?;
        Ok(start.elapsed())
    }

    fn positions(&self) -> Vec<Vec3> {
        // Readers take a lost device for a body without particles.
        self.bodies.iter().flat_map(|&id| self.world.read_positions(id).unwrap_or_default()).collect()
    }

    fn energy(&self) -> Option<f64> {
        None
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        None
    }

    fn isa(&self) -> &'static str {
        "GPU"
    }
}
