//! Bevy diagnostics: costs of a step and numbers of bodies.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy::diagnostic::LogDiagnosticsPlugin;
//! use bevy_drape::diagnostics::DrapeDiagnosticsPlugin;
//!
//! App::new()
//!     .add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
//!     .add_plugins((DrapeDiagnosticsPlugin, LogDiagnosticsPlugin::default()))
//!     .update();
//! ```

use core::time::Duration;

use bevy::diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy::prelude::*;

use crate::body::particles::Particles;
use crate::schedule::StepTimes;
use crate::sleep::activity_counts::ActivityCounts;
use crate::step::islands::Islands;

/// Measures the last step in every frame, for Bevy's log, an overlay, or your own eyes. Not among [`DrapePlugins`](crate::DrapePlugins).
#[derive(Clone, Copy, Debug, Default)]
pub struct DrapeDiagnosticsPlugin;

impl DrapeDiagnosticsPlugin {
    /// Wall time of the whole step in milliseconds.
    pub const STEP: DiagnosticPath = DiagnosticPath::const_new("drape/step");
    /// Time of the search for contacts in milliseconds, added up over islands.
    pub const DETECT: DiagnosticPath = DiagnosticPath::const_new("drape/detect");
    /// Time of all substeps, with relaxation and contacts, in milliseconds, added up over islands.
    pub const RELAX: DiagnosticPath = DiagnosticPath::const_new("drape/relax");
    /// Time to record particles after the last step, and to write meshes in this frame, in milliseconds.
    #[cfg(feature = "mesh")]
    pub const MESHES: DiagnosticPath = DiagnosticPath::const_new("drape/meshes");
    /// Simulated bodies and balls.
    pub const ACTIVE: DiagnosticPath = DiagnosticPath::const_new("drape/active");
    /// Resting bodies and balls.
    pub const RESTING: DiagnosticPath = DiagnosticPath::const_new("drape/resting");
    /// Culled bodies and balls.
    pub const CULLED: DiagnosticPath = DiagnosticPath::const_new("drape/culled");
    /// Bodies frozen at a distance.
    pub const FROZEN: DiagnosticPath = DiagnosticPath::const_new("drape/frozen");
    /// Particles of all bodies.
    pub const PARTICLES: DiagnosticPath = DiagnosticPath::const_new("drape/particles");
    /// Edges that passed through faces when the step began, of simulated bodies with self-contact.
    pub const CROSSINGS: DiagnosticPath = DiagnosticPath::const_new("drape/crossings");
}

impl Plugin for DrapeDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        for time in [Self::STEP, Self::DETECT, Self::RELAX] {
            app.register_diagnostic(Diagnostic::new(time).with_suffix(" ms"));
        }
        let bodies = [Self::ACTIVE, Self::RESTING, Self::CULLED, Self::FROZEN];
        for count in bodies.into_iter().chain([Self::PARTICLES, Self::CROSSINGS]) {
            app.register_diagnostic(Diagnostic::new(count).with_smoothing_factor(0.0));
        }
        app.add_systems(Last, measure);
        #[cfg(feature = "mesh")]
        app.register_diagnostic(Diagnostic::new(Self::MESHES).with_suffix(" ms"))
            .add_systems(Last, measure_meshes);
    }
}

#[cfg(feature = "mesh")]
fn measure_meshes(mut diagnostics: Diagnostics, times: Option<Res<crate::render::MeshTimes>>) {
    if let Some(times) = times {
        let all = times.record + times.write;
        diagnostics.add_measurement(&DrapeDiagnosticsPlugin::MESHES, || {
            all.div_duration_f64(Duration::from_millis(1))
        });
    }
}

fn measure(
    mut diagnostics: Diagnostics,
    times: Res<StepTimes>,
    counts: Res<ActivityCounts>,
    bodies: Query<&Particles>,
    islands: Res<Islands>,
) {
    type This = DrapeDiagnosticsPlugin;
    let StepTimes { step, detect_collisions, substeps } = *times;
    for (path, time) in [(This::STEP, step), (This::DETECT, detect_collisions), (This::RELAX, substeps)] {
        diagnostics.add_measurement(&path, || time.div_duration_f64(Duration::from_millis(1)));
    }
    let ActivityCounts { active, resting, culled, frozen } = *counts;
    for (path, count) in
        [(This::ACTIVE, active), (This::RESTING, resting), (This::CULLED, culled), (This::FROZEN, frozen)]
    {
        diagnostics.add_measurement(&path, || count as f64);
    }
    let particles = || bodies.iter().map(|particles| particles.len()).sum::<usize>() as f64;
    diagnostics.add_measurement(&This::PARTICLES, particles);
    diagnostics.add_measurement(&This::CROSSINGS, || f64::from(islands.crossings()));
}
