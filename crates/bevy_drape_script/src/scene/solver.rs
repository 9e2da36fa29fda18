//! Solver settings.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Fraction, Whole};

/// Solver settings. Fields that a body leaves out come from the scene's settings, and those that these leave out from
/// the plugin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Quality preset: `Low`, `Medium` (the plugin's default) or `High`. The fields below override it.
    pub quality: Option<Quality>,
    /// Substeps per step, 1 to 256.
    pub substeps: Option<Whole<1, 256>>,
    /// Relaxation iterations per substep, 1 to 1024. With lines only the last one relaxes sticks.
    pub iterations: Option<Whole<1, 1024>>,
    /// Strain below which relaxation stops early, 0 (never) to 1.
    pub tolerance: Option<Fraction>,
    /// The formula for sticks.
    pub projection: Option<StickProjection>,
    /// The method for structural sticks.
    pub structural: Option<StructuralSolve>,
    /// True to let tethers hold particles within their rest distance from the pins.
    pub tethers: Option<bool>,
    /// Contact with itself, and with other bodies that have this on, too; off by default.
    pub self_contact: Option<SelfContact>,
}

/// Quality presets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Quality {
    /// For bodies that are far away or small.
    Low,
    /// The plugin's default.
    Medium,
    /// For bodies that must not stretch.
    High,
}

/// The formula that moves the ends of a stick to its rest length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StickProjection {
    /// One square root a stick.
    Exact,
    /// One Newton step and no square root.
    SquareRootFree,
}

/// The method that brings structural sticks to their rest lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StructuralSolve {
    /// One stick after another.
    Sweeps,
    /// Rows and columns of a cloth, and ropes, directly as chains. The plugin's default; what is tearable is swept if there is
    /// more than one iteration.
    Lines,
}

/// Contact of a body with itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum SelfContact {
    /// No contact.
    Off,
    /// Contact between corners, faces, edges and links.
    On,
}

impl Solver {
    /// The plugin's settings: these, with `base` for fields that are left out.
    pub fn over(&self, base: drape::body::SolverSettings) -> drape::body::SolverSettings {
        let quality = self.quality.map(|quality| match quality {
            Quality::Low => drape::body::Quality::Low,
            Quality::Medium => drape::body::Quality::Medium,
            Quality::High => drape::body::Quality::High,
        });
        let base = quality.map_or(base, |quality| base.with_quality(quality));
        drape::body::SolverSettings {
            substeps: self.substeps.map_or(base.substeps, Whole::get),
            iterations: self.iterations.map_or(base.iterations, Whole::get),
            tolerance: self.tolerance.map_or(base.tolerance, Fraction::get),
            projection: self.projection.map_or(base.projection, |projection| match projection {
                StickProjection::Exact => drape::body::StickProjection::Exact,
                StickProjection::SquareRootFree => drape::body::StickProjection::SquareRootFree,
            }),
            structural: self.structural.map_or(base.structural, |structural| match structural {
                StructuralSolve::Sweeps => drape::body::StructuralSolve::Sweeps,
                StructuralSolve::Lines => drape::body::StructuralSolve::Lines,
            }),
            tethers: self.tethers.unwrap_or(base.tethers),
            self_contact: self.self_contact.map_or(base.self_contact, |contact| match contact {
                SelfContact::Off => drape::body::SelfContact::Off,
                SelfContact::On => drape::body::SelfContact::On,
            }),
        }
    }
}
