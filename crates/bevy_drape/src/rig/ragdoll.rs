//! Ragdolls, as hand-built rigs.

use bevy::prelude::*;
use drape_solver::{BuildError, Placement, RagdollBuilder, RagdollStick};

use crate::body::settings::SolverSettings;
use crate::rig::components::{Particle, Stick, StickBound, StickKind};

/// A human figure of eleven limbs to be spawned as a rig: [`Particle`] and [`Stick`] entities that anything can be attached to.
///
/// Its limbs are thick sticks: the thickness of its settings is their radius. Elbows and knees are hinges, shoulders, waist and
/// hips pins, and sticks with a bound limit their angles.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn spawn_ragdoll(mut commands: Commands) {
///     let start = Transform::from_xyz(0.0, 1.0, 0.0);
///     let limbs = Ragdoll::default().spawn(&mut commands, start).expect("its height and mass are positive");
///     commands.entity(limbs.particles[0]).insert(Name::new("Head"));
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ragdoll {
    /// Metres, above 0; 1.75 by default.
    pub height: f32,
    /// Kilograms, above 0; 75 by default.
    pub mass: f32,
    /// How it is solved: 16 substeps of 4 iterations by default, and limbs of 5 cm radius.
    pub settings: SolverSettings,
}

impl Default for Ragdoll {
    fn default() -> Self {
        let settings =
            SolverSettings { substeps: 16, iterations: 4, thickness: 0.05, friction: 0.6, ..default() };
        Self { height: 1.75, mass: 75.0, settings }
    }
}

/// The entities of a ragdoll.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RagdollEntities {
    /// Head, shoulders, sternum, waist, hips, sacrum; of each side the two ends of the elbow's axis; hands; of each side the
    /// two ends of the knee's axis; feet. Left before right.
    pub particles: Vec<Entity>,
    /// Those that make limbs, then those that limit joints.
    pub sticks: Vec<Entity>,
}

impl Ragdoll {
    /// Spawns it at rest, with the ground between its feet at the transform's origin. It looks along +Z; scale does not count.
    ///
    /// # Errors
    /// [`BuildError`] naming what cannot be used; nothing is spawned then.
    pub fn spawn(&self, commands: &mut Commands, start: Transform) -> Result<RagdollEntities, BuildError> {
        self.spawn_moving(commands, start, start, 1.0)
    }

    /// Spawns it with the motion of two frames of an animation that lie `dt` seconds apart: it goes on from `current` with the
    /// velocity and the spin that took it there from `previous` (S32).
    ///
    /// # Errors
    /// [`BuildError`] naming what cannot be used; nothing is spawned then.
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
            let bundle =
                (Particle::new(mass).moved(before, now, dt), Transform::from_translation(now), self.settings);
            entities.particles.push(commands.spawn(bundle).id());
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
