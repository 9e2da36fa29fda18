//! What the examples of single features share: a command line, a run without a window with a verdict, a window, a picture.
//!
//! An example is a [`Feature`] and the function that sets its scene up. It says nothing of drawing but [`Paint`]: the same
//! code runs in a test that knows no renderer.

use core::time::Duration;
use std::path::PathBuf;
use std::process::ExitCode;

use bevy::gltf::GltfPlugin;
use bevy::input::InputPlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_drape::prelude::*;
use clap::Parser;
use thiserror::Error;

use crate::feature_files::{FileError, asset_plugin, wait_for_files};

/// An example of one feature.
#[derive(Clone, Copy, Debug)]
pub struct Feature {
    /// What it shows, for the window's title.
    pub title: &'static str,
    /// The keys, for the window; may be empty.
    pub controls: &'static str,
    /// Where the camera is, in metres.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Simulated time of the picture, in seconds.
    pub moment: f32,
    /// Adds the example to an app that has the plugins.
    pub build: fn(&mut App),
}

/// The colour of a body or obstacle, where something is drawn. Those without have the usual one.
#[derive(Component, Clone, Copy, Debug)]
pub struct Paint(pub Color);

impl Paint {
    /// Of these parts of red, green and blue, from 0 to 1.
    pub const fn rgb(red: f32, green: f32, blue: f32) -> Self {
        Self(Color::srgb(red, green, blue))
    }
}

/// What a run without a window came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureReport {
    /// Steps taken.
    pub steps: u64,
    /// Cloths, ropes and other bodies of particles at the end.
    pub bodies: usize,
    /// Their particles.
    pub particles: usize,
    /// Balls at the end.
    pub balls: usize,
    /// Greatest speed of a particle or ball at any step, in m/s.
    pub greatest_speed: f32,
}

/// Why a run without a window is no success.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FeatureError {
    /// Something was left out of the simulation.
    #[error("{0}")]
    Refused(String),
    /// Nothing there to see.
    #[error("the example has neither bodies nor balls")]
    Empty,
    /// A body is no longer anywhere.
    #[error("{0} has a particle that is nowhere, at step {1}")]
    NotFinite(Entity, u64),
    /// A file is missing.
    #[error(transparent)]
    NotLoaded(#[from] FileError),
}

#[derive(Parser, Debug)]
struct FeatureArguments {
    /// Run without a window, and tell what came of it.
    #[arg(long)]
    headless: bool,
    /// Simulated time of a run without a window; as long as until the picture, if not given.
    #[arg(long, value_name = "SECONDS")]
    seconds: Option<f32>,
    /// Draw a picture into this PNG file instead (needs `--features render`).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

impl Feature {
    /// The example's `main`: does what the command line asks for.
    pub fn run(&self) -> ExitCode {
        let arguments = FeatureArguments::parse();
        match self.obey(&arguments) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("error: {error}");
                ExitCode::FAILURE
            }
        }
    }

    fn obey(&self, arguments: &FeatureArguments) -> Result<(), Box<dyn core::error::Error>> {
        if let Some(file) = &arguments.picture {
            #[cfg(feature = "render")]
            return crate::feature_picture::draw(self, file).map_err(Into::into);
            #[cfg(not(feature = "render"))]
            return Err(format!("{} needs `--features render`", file.display()).into());
        }
        #[cfg(feature = "window")]
        if !arguments.headless {
            return crate::feature_window::open(self).map_err(Into::into);
        }
        if !arguments.headless {
            println!("No window without `--features window`: running without one.");
        }
        let report = self.run_headless(arguments.seconds.unwrap_or(self.moment))?;
        println!(
            "{}\n{} steps, {} bodies of {} particles, {} balls; greatest speed {:.1} m/s",
            self.title, report.steps, report.bodies, report.particles, report.balls, report.greatest_speed
        );
        Ok(())
    }

    /// Runs for this long (simulated seconds), as fast as it goes, without a renderer.
    ///
    /// # Errors
    /// [`FeatureError`] if a body or obstacle is refused, a file or everything is missing, or something has no finite place.
    pub fn run_headless(&self, seconds: f32) -> Result<FeatureReport, FeatureError> {
        let mut app = self.headless_app();
        let steps = steps_in(&app, seconds);
        let mut report = FeatureReport { steps, bodies: 0, particles: 0, balls: 0, greatest_speed: 0.0 };
        // The first update takes no step.
        for step in 0..=steps {
            app.update();
            if step == 0 {
                wait_for_files(&mut app)?;
            }
            look_at(app.world_mut(), step, &mut report)?;
        }
        if report.bodies + report.balls == 0 {
            return Err(FeatureError::Empty);
        }
        Ok(report)
    }

    /// What the example does, to be run in the world of an app that has the plugins already.
    pub fn schedules(&self) -> Schedules {
        let mut script = App::empty();
        script.init_resource::<Schedules>();
        (self.build)(&mut script);
        script.world_mut().remove_resource().unwrap_or_default()
    }

    /// An app without a renderer that has the example in it, and takes one step in each update but the first.
    pub fn headless_app(&self) -> App {
        let mut app = bare_app();
        (self.build)(&mut app);
        app.finish();
        app.cleanup();
        app
    }
}

/// An app without a renderer that has nothing in it yet, and takes one step in each update but the first.
pub fn bare_app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, asset_plugin(), InputPlugin, MeshPlugin))
        .add_plugins((
            ImagePlugin::default(),
            WorldSerializationPlugin,
            GltfPlugin::default(),
            AnimationPlugin,
        ))
        .add_plugins(DrapePlugins::default())
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app
}

/// How many steps `app` takes in this long (simulated seconds).
pub fn steps_in(app: &App, seconds: f32) -> u64 {
    let dt = app.world().resource::<Time<Fixed>>().timestep();
    Duration::from_secs_f32(seconds.max(0.0)).div_duration_f64(dt).round() as u64
}

/// Counts what is there after `step`, and checks that it is somewhere.
fn look_at(world: &mut World, step: u64, report: &mut FeatureReport) -> Result<(), FeatureError> {
    if let Some(message) = world.resource::<Refusals>().messages().next() {
        return Err(FeatureError::Refused(message.to_string()));
    }
    (report.bodies, report.particles, report.balls) = (0, 0, 0);
    let mut speed = report.greatest_speed;
    for (entity, particles) in world.query::<(Entity, &Particles)>().iter(world) {
        report.bodies += 1;
        report.particles += particles.len();
        for particle in 0..particles.len() {
            let velocity = particles.velocity(particle);
            if !(particles.position(particle) + velocity).is_finite() {
                return Err(FeatureError::NotFinite(entity, step));
            }
            speed = speed.max(velocity.length());
        }
    }
    for (entity, ball) in world.query::<(Entity, &ProjectileState)>().iter(world) {
        report.balls += 1;
        if !(ball.position() + ball.velocity()).is_finite() {
            return Err(FeatureError::NotFinite(entity, step));
        }
        speed = speed.max(ball.velocity().length());
    }
    report.greatest_speed = speed;
    Ok(())
}
