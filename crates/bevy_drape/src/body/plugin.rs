//! Registers the components of bodies.

use bevy::prelude::*;

use crate::body::activity::Activity;
use crate::body::body_state::CreationOrder;
use crate::body::contact_events::ContactEvents;
use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks, forget_despawned_body};
use crate::body::pressure::{Pressure, wake_pressed, wake_slack};
use crate::body::settings::{DefaultSolverSettings, Quality, SolverSettings};
use crate::body::surface::{BodySurface, DefaultBodySurface};
use crate::clock::DrapeClock;
use crate::refusal::{Refusals, log_refusals};
use crate::schedule::{DrapeSchedule, FinishPhase, ScenePhase};

/// Particles, settings, layers and marks of bodies; the clock; and the list of what is refused.
pub(crate) struct BodyPlugin;

impl Plugin for BodyPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Activity, Particles, Sticks, ContactEvents, DrapeLayers)>()
            .register_type::<(Fabric, BodySurface, DefaultBodySurface)>()
            .register_type::<(SolverSettings, DefaultSolverSettings, Quality, DrapeClock, Refusals)>()
            .init_resource::<CreationOrder>()
            .init_resource::<DefaultSolverSettings>()
            .init_resource::<DefaultBodySurface>()
            .init_resource::<DrapeClock>()
            .init_resource::<Refusals>()
            .add_observer(forget_despawned_body)
            .add_systems(DrapeSchedule, log_refusals.in_set(FinishPhase::TriggerObservers))
            // Refusals between steps.
            .add_systems(Last, log_refusals);
    }
}

/// [`Pressure`] inside closed bodies.
pub(crate) struct PressurePlugin;

impl Plugin for PressurePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Pressure>()
            .add_observer(wake_slack)
            .add_systems(DrapeSchedule, wake_pressed.in_set(ScenePhase::WakePressed));
    }
}
