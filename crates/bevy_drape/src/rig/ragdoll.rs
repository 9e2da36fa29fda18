//! Ragdolls, as hand-built rigs.

use bevy::prelude::*;
use drape_solver::{BuildError, Placement, RagdollBuilder, RagdollStick};

use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::rig::components::{Particle, Stick, StickBound, StickKind};

/// A human figure of eleven limbs, spawned as a rig of [`Particle`] and [`Stick`] entities.
///
/// Its limbs are thick sticks; the thickness of the settings is their radius. Elbows and knees are hinges; shoulders,
/// waist and hips are ball joints. Sticks with a bound limit their angles.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::rig::Ragdoll;
///
/// fn spawn_ragdoll(mut commands: Commands) {
///     let start = Transform::from_xyz(0.0, 1.0, 0.0);
///     let limbs = Ragdoll::default().spawn(&mut commands, start).expect("its height and mass are positive");
///     commands.entity(limbs.particles[0]).insert(Name::new("Head"));
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ragdoll {
    /// Height in metres, above 0; 1.75 by default.
    pub height: f32,
    /// Mass in kilograms, above 0; 75 by default.
    pub mass: f32,
    /// Solver settings: 16 substeps of 4 iterations by default.
    pub settings: SolverSettings,
    /// Its surface: limbs of 5 cm radius by default.
    pub surface: BodySurface,
}

impl Default for Ragdoll {
    fn default() -> Self {
        let settings = SolverSettings { substeps: 16, iterations: 4, ..default() };
        let surface = BodySurface { thickness: 0.05, friction: 0.6, ..default() };
        Self { height: 1.75, mass: 75.0, settings, surface }
    }
}

/// The entities of a ragdoll.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RagdollEntities {
    /// Head, shoulders, sternum, waist, hips, sacrum; for each side the two ends of the elbow's axis; hands; for each
    /// side the two ends of the knee's axis; feet. Left before right.
    pub particles: Vec<Entity>,
    /// Sticks of the limbs, then those that limit joints.
    pub sticks: Vec<Entity>,
}

impl Ragdoll {
    /// Spawns it at rest, facing +Z, with the point between its feet at the transform's origin. Scale does not count.
    ///
    /// # Errors
    /// [`BuildError`] naming the invalid field; then nothing is spawned.
    pub fn spawn(&self, commands: &mut Commands, start: Transform) -> Result<RagdollEntities, BuildError> {
        self.spawn_moving(commands, start, start, 1.0)
    }

    /// Spawns it in motion, after two frames of an animation that are `dt` seconds apart: at `current`, with the
    /// velocity and angular velocity from `previous` to there (S32).
    ///
    /// # Errors
    /// [`BuildError`] naming the invalid field; then nothing is spawned.
    pub fn spawn_moving(
        &self,
        commands: &mut Commands,
        previous: Transform,
        current: Transform,
        dt: f32,
    ) -> Result<RagdollEntities, BuildError> {
        let figure = RagdollBuilder::new(self.height, self.mass);
        let at = |Transform { translation, rotation, .. }| {
            figure.placed(Placement { translation, rotation }).particles()
        };
        let mut entities = RagdollEntities::default();
        for ((before, _), (now, mass)) in at(previous)?.into_iter().zip(at(current)?) {
            let particle = (Particle::new(mass).moved(before, now, dt), Transform::from_translation(now));
            entities.particles.push(commands.spawn((particle, self.settings, self.surface)).id());
        }
        for RagdollStick { ends, length, bound } in figure.sticks() {
            let [a, b] = ends.map(|end| entities.particles[end as usize]);
            let (bound, kind) = match bound {
                StickBound::Exact => (StickBound::Exact, StickKind::Structural),
                StickBound::AtLeast => (StickBound::AtLeast, StickKind::Bend),
                StickBound::AtMost => (StickBound::AtMost, StickKind::Bend),
            };
            let stick = Stick { rest_length: Some(length), kind, bound, ..Stick::new(a, b) };
            entities.sticks.push(commands.spawn(stick).id());
        }
        Ok(entities)
    }
}
