//! This project's solver in Bevy, without a renderer. Its time is that of the plugin's own schedule.

use std::sync::Arc;
use std::time::Duration;

use bevy::prelude::{App, Entity, MinimalPlugins, Time, Transform};
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use bevy::time::{Fixed, TimeUpdateStrategy};
use bevy_drape::body::Sticks;
use bevy_drape::prelude::{BodySurface, DrapeGravity, DrapePlugins, Obstacle, Particles, SolverSettings};
use bevy_drape::schedule::StepTimes;
use bevy_drape::sleep::{ActivityCounts, SceneManager};
use drape_solver::Isa;
use drape_solver::glam::Vec3;

use crate::failure::Failure;
use crate::scenes::scene::{Scene, SceneKind};
use crate::scenes::world::{GRAVITY, SPHERE_CENTRE, SPHERE_RADIUS, STEP};
use crate::solvers::drape;
use crate::solvers::options::SolverOptions;
use crate::solvers::simulation::Simulation;

/// The greatest number of steps until bodies come to rest: a minute.
const PATIENCE: u32 = 3600;
/// Drag of sheets that have to come to rest, in 1/s.
const RESTING_DRAG: f32 = 3.0;

/// An app with the scene in it.
pub struct Plugin {
    app: App,
    bodies: Vec<Entity>,
}

impl Plugin {
    /// Loads `scene`. Sheets of the scene `asleep` are stepped until they are at rest.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses the bodies, Bevy has another number of threads already, or bodies that
    /// should come to rest do not.
    pub fn new(scene: &Scene, options: &SolverOptions) -> Result<Self, Failure> {
        let is_asleep = scene.kind == SceneKind::Asleep;
        let mut app = app(options.threads)?;
        app.world_mut().resource_mut::<SceneManager>().sleeping = is_asleep;
        if !is_asleep {
            let sphere = Obstacle { friction: 0.0, ..Obstacle::sphere(SPHERE_RADIUS) };
            app.world_mut().spawn((sphere, Transform::from_translation(SPHERE_CENTRE)));
        }
        let topology = Arc::new(drape::topology(&scene.model)?);
        let mut bodies = Vec::new();
        for i in 0..scene.bodies {
            let particles = Particles(drape::particles(&scene.model, scene.offset(i))?);
            let drag = if is_asleep { RESTING_DRAG } else { 0.0 };
            let settings = drape::settings(options);
            let surface = BodySurface { drag, ..settings.into() };
            let body = (particles, Sticks(Arc::clone(&topology)), SolverSettings::from(settings), surface);
            bodies.push(app.world_mut().spawn(body).id());
        }
        let mut plugin = Self { app, bodies };
        if is_asleep {
            plugin.settle()?;
        }
        Ok(plugin)
    }

    /// Steps until all bodies are at rest.
    fn settle(&mut self) -> Result<(), Failure> {
        for _ in 0..PATIENCE {
            self.app.update();
            if self.restless() == 0 {
                return Ok(());
            }
        }
        Err(Failure::Restless(self.restless()))
    }

    fn restless(&self) -> usize {
        self.bodies.len() - self.app.world().resource::<ActivityCounts>().resting
    }

    fn particles(&self) -> impl Iterator<Item = &Particles> {
        self.bodies.iter().filter_map(|&body| self.app.world().get(body))
    }
}

/// An app with the plugin, on `threads` threads, before its first step.
pub(crate) fn app(threads: u32) -> Result<App, Failure> {
    // Bevy's pool is made once for a process.
    let pool = ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(threads as usize).build());
    if pool.thread_num() != threads as usize {
        let reason = format!("Bevy runs on {} in this process; give --threads one number", pool.thread_num());
        return Err(Failure::Pool(reason));
    }
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, DrapePlugins::default()))
        .insert_resource(Time::<Fixed>::from_duration(Duration::from_secs_f32(STEP)))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
        .insert_resource(DrapeGravity(GRAVITY));
    // The first update has no time delta and takes no step.
    app.update();
    Ok(app)
}

impl Simulation for Plugin {
    fn step(&mut self) -> Result<Duration, Failure> {
        self.app.update();
        Ok(self.app.world().resource::<StepTimes>().step)
    }

    fn positions(&self) -> Vec<Vec3> {
        self.particles().flat_map(|particles| particles.positions()).collect()
    }

    fn energy(&self) -> Option<f64> {
        Some(self.particles().map(|particles| drape::energy(particles)).sum())
    }

    fn bytes_per_particle(&self) -> Option<f64> {
        // The columns are those of the bare solver, moved in and out of components.
        None
    }

    fn isa(&self) -> &'static str {
        Isa::detected().name()
    }
}
