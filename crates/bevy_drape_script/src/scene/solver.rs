//! How bodies are solved.

use bevy_drape::prelude as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Fraction, NonNegative, Whole};

/// How bodies are solved. What a body leaves out is as the scene's settings have it, and what these leave out is as the
/// plugin has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// How well it is solved: `Low`, `Medium` (the plugin's default) or `High`. The fields below go before it.
    pub quality: Option<Quality>,
    /// Substeps per step, 1 to 256.
    pub substeps: Option<Whole<1, 256>>,
    /// Relaxation iterations per substep, 1 to 1024.
    pub iterations: Option<Whole<1, 1024>>,
    /// Strain below which relaxation stops early, 0 (never) to 1.
    pub tolerance: Option<Fraction>,
    /// Drag of still air in 1/s: velocity decays as exp(-drag t).
    pub drag: Option<NonNegative>,
    /// Coulomb friction coefficient. Two surfaces in contact use the mean of theirs.
    pub friction: Option<NonNegative>,
    /// Coefficient of static friction; below `friction` it counts as `friction`.
    pub static_friction: Option<NonNegative>,
    /// Distance in metres that the middle of the cloth keeps from what it touches.
    pub thickness: Option<NonNegative>,
    /// The formula for sticks.
    pub projection: Option<StickProjection>,
    /// How structural sticks are solved.
    pub structural: Option<StructuralSolve>,
    /// Whether tethers hold particles within their rest distance from the pins.
    pub tethers: Option<bool>,
    /// How the body touches itself, and other cloths and ropes that have this on too: not at all, unless it is said.
    pub self_contact: Option<SelfContact>,
}

/// How well bodies are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Quality {
    /// For what is far away or small.
    Low,
    /// The plugin's default.
    Medium,
    /// For what must not stretch.
    High,
}

/// Which formula moves the ends of a stick to its rest length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StickProjection {
    /// One square root a stick.
    Exact,
    /// One Newton step and no square root.
    SquareRootFree,
}

/// How structural sticks are brought to their rest lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StructuralSolve {
    /// One stick after another.
    Sweeps,
    /// Rows and columns of a cloth, and ropes, directly as chains.
    Lines,
}

/// How a body touches itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum SelfContact {
    /// Not at all.
    Off,
    /// Particle by particle.
    Particles,
    /// By faces, links and edges.
    Triangles,
}

impl Solver {
    /// The plugin's settings for these, with `base` for what they leave out.
    pub fn over(&self, base: drape::SolverSettings) -> drape::SolverSettings {
        let quality = self.quality.map(|quality| match quality {
            Quality::Low => drape::Quality::Low,
            Quality::Medium => drape::Quality::Medium,
            Quality::High => drape::Quality::High,
        });
        let base = quality.map_or(base, |quality| base.with_quality(quality));
        drape::SolverSettings {
            substeps: self.substeps.map_or(base.substeps, Whole::get),
            iterations: self.iterations.map_or(base.iterations, Whole::get),
            tolerance: self.tolerance.map_or(base.tolerance, Fraction::get),
            drag: self.drag.map_or(base.drag, NonNegative::get),
            friction: self.friction.map_or(base.friction, NonNegative::get),
            static_friction: self.static_friction.map_or(base.static_friction, NonNegative::get),
            thickness: self.thickness.map_or(base.thickness, NonNegative::get),
            projection: self.projection.map_or(base.projection, |projection| match projection {
                StickProjection::Exact => drape::StickProjection::Exact,
                StickProjection::SquareRootFree => drape::StickProjection::SquareRootFree,
            }),
            structural: self.structural.map_or(base.structural, |structural| match structural {
                StructuralSolve::Sweeps => drape::StructuralSolve::Sweeps,
                StructuralSolve::Lines => drape::StructuralSolve::Lines,
            }),
            tethers: self.tethers.unwrap_or(base.tethers),
            self_contact: self.self_contact.map_or(base.self_contact, |contact| match contact {
                SelfContact::Off => drape::SelfContact::Off,
                SelfContact::Particles => drape::SelfContact::Particles,
                SelfContact::Triangles => drape::SelfContact::Triangles,
            }),
        }
    }
}
