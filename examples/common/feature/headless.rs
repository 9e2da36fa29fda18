//! An example without a window: runs as fast as it goes, and returns what came of it.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;
use thiserror::Error;

use crate::feature::example::{Feature, steps_in};
#[cfg(feature = "gltf")]
use crate::view::gltf_files::{FileError, wait_for_files};

/// The result of a run without a window.
#[derive(Clone, Debug, PartialEq)]
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
    /// The finding of the example's [`Verdict`].
    pub finding: Option<String>,
}

/// Judges the scene at the end of a run without a window: what happened, or what went wrong.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Verdict(pub fn(&mut World) -> Result<String, String>);

/// The errors of a run without a window.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FeatureError {
    /// Something was left out of the simulation.
    #[error("{0}")]
    Refused(String),
    /// The example has neither bodies nor balls.
    #[error("the example has neither bodies nor balls")]
    Empty,
    /// A position or velocity is not finite.
    #[error("{0} has a particle that is nowhere, at step {1}")]
    NotFinite(Entity, u64),
    /// The example's [`Verdict`].
    #[error("{0}")]
    Verdict(String),
    /// A file is missing.
    #[cfg(feature = "gltf")]
    #[error(transparent)]
    NotLoaded(#[from] FileError),
}

impl Feature {
    /// Runs for this long (simulated seconds), as fast as it goes, without a renderer.
    ///
    /// # Errors
    /// [`FeatureError`] if a body or obstacle is refused, a file is missing, nothing is simulated, a position is not finite, or the
    /// example's [`Verdict`] says so.
    pub fn run_headless(&self, seconds: f32) -> Result<FeatureReport, FeatureError> {
        let mut app = self.headless_app();
        let steps = steps_in(&app, seconds);
        let mut report =
            FeatureReport { steps, bodies: 0, particles: 0, balls: 0, greatest_speed: 0.0, finding: None };
        // The first update takes no step.
        for step in 0..=steps {
            app.update();
            #[cfg(feature = "gltf")]
            if step == 0 {
                wait_for_files(&mut app)?;
            }
            look_at(app.world_mut(), step, &mut report)?;
        }
        if report.bodies + report.balls == 0 {
            return Err(FeatureError::Empty);
        }
        if let Some(&Verdict(judge)) = app.world().get_resource() {
            report.finding = Some(judge(app.world_mut()).map_err(FeatureError::Verdict)?);
        }
        Ok(report)
    }
}

/// Counts bodies and balls after `step`, and checks that all positions and velocities are finite.
fn look_at(world: &mut World, step: u64, report: &mut FeatureReport) -> Result<(), FeatureError> {
    if let Some(message) = world.resource::<Refusals>().iter().next() {
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
