//! How bodies are stepped: a component for one body, a resource for all others.

use bevy::prelude::*;
use drape_solver::state::settings as solver;

/// Which formula moves the ends of a stick to its rest length.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StickProjection {
    /// The exact projection: one square root a stick.
    #[default]
    Exact,
    /// One Newton step and no square root: right to second order in the strain.
    SquareRootFree,
}

/// How structural sticks are brought to their rest lengths.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StructuralSolve {
    /// One stick after another, as all other sticks.
    #[default]
    Sweeps,
    /// Each row and each column of a cloth, and a rope, directly as a chain: in equal time a tenth of the stretch, from
    /// 8 substeps on. Soft sticks and small bodies are swept.
    Lines,
}

/// How a body touches itself, and others that have this on. What it costs and gives stands at the
/// [solver's](solver::SelfContact).
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SelfContact {
    /// Not at all.
    #[default]
    Off,
    /// Particle by particle: for cloth as thick as its particles are apart.
    Particles,
    /// By faces, links and edges: for thin cloth, ropes, and layers that move fast.
    Triangles,
}

/// How well a body is to be solved: `SolverSettings::from(Quality::High)`. What it costs and gives stands at the
/// [solver's](solver::Quality).
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum Quality {
    /// For what is far away or small.
    Low,
    /// What [`SolverSettings::default`] is.
    #[default]
    Medium,
    /// For what must not stretch: rows and columns of cloth are solved as chains.
    High,
}

/// How a body is stepped: accuracy, damping and surface. A body without this component uses
/// [`DefaultSolverSettings`]. Values out of range leave the body out of the simulation, with an error logged.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolverSettings {
    /// Substeps per step, 1 to 256. Small steps buy more stiffness than iterations for the same work.
    pub substeps: u32,
    /// Relaxation iterations per substep, 1 to 1024. Even numbers run as symmetric pairs.
    pub iterations: u32,
    /// Strain below which relaxation stops before its last iteration, from 0 (never) to 1. It pays from some 8
    /// iterations on.
    pub tolerance: f32,
    /// Drag of still air in 1/s, 0 or more: velocity decays as `exp(-drag t)`.
    pub drag: f32,
    /// Coulomb friction coefficient, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, which holds what does not slide yet, 0 or more; below `friction` it counts as
    /// `friction`. Two surfaces in contact use the mean of theirs.
    pub static_friction: f32,
    /// Distance that the middle of the cloth keeps from what it touches, in metres.
    pub thickness: f32,
    /// The formula for sticks.
    pub projection: StickProjection,
    /// How structural sticks are solved.
    pub structural: StructuralSolve,
    /// Whether tethers hold particles within their rest distance from the pins.
    pub tethers: bool,
    /// How the body touches itself, and others that have this on: layers keep the sum of the two thicknesses apart.
    pub self_contact: SelfContact,
}

impl Default for SolverSettings {
    fn default() -> Self {
        solver::SolverSettings::default().into()
    }
}

impl SolverSettings {
    /// These, solved as well as `quality` asks: drag, friction and thickness stay.
    pub fn with_quality(self, quality: Quality) -> Self {
        let quality = match quality {
            Quality::Low => solver::Quality::Low,
            Quality::Medium => solver::Quality::Medium,
            Quality::High => solver::Quality::High,
        };
        solver::SolverSettings::from(self).with_quality(quality).into()
    }
}

impl From<Quality> for SolverSettings {
    fn from(quality: Quality) -> Self {
        Self::default().with_quality(quality)
    }
}

impl From<solver::SolverSettings> for SolverSettings {
    fn from(settings: solver::SolverSettings) -> Self {
        let solver::SolverSettings {
            substeps,
            iterations,
            tolerance,
            drag,
            friction,
            static_friction,
            thickness,
            projection,
            structural,
            tethers,
            self_contact,
        } = settings;
        let projection = match projection {
            solver::StickProjection::Exact => StickProjection::Exact,
            solver::StickProjection::SquareRootFree => StickProjection::SquareRootFree,
        };
        let structural = match structural {
            solver::StructuralSolve::Sweeps => StructuralSolve::Sweeps,
            solver::StructuralSolve::Lines => StructuralSolve::Lines,
        };
        let self_contact = match self_contact {
            solver::SelfContact::Off => SelfContact::Off,
            solver::SelfContact::Particles => SelfContact::Particles,
            solver::SelfContact::Triangles => SelfContact::Triangles,
        };
        Self {
            substeps,
            iterations,
            tolerance,
            drag,
            friction,
            static_friction,
            thickness,
            projection,
            structural,
            tethers,
            self_contact,
        }
    }
}

impl From<SolverSettings> for solver::SolverSettings {
    fn from(settings: SolverSettings) -> Self {
        let SolverSettings {
            substeps,
            iterations,
            tolerance,
            drag,
            friction,
            static_friction,
            thickness,
            projection,
            structural,
            tethers,
            self_contact,
        } = settings;
        let projection = match projection {
            StickProjection::Exact => solver::StickProjection::Exact,
            StickProjection::SquareRootFree => solver::StickProjection::SquareRootFree,
        };
        let structural = match structural {
            StructuralSolve::Sweeps => solver::StructuralSolve::Sweeps,
            StructuralSolve::Lines => solver::StructuralSolve::Lines,
        };
        let self_contact = match self_contact {
            SelfContact::Off => solver::SelfContact::Off,
            SelfContact::Particles => solver::SelfContact::Particles,
            SelfContact::Triangles => solver::SelfContact::Triangles,
        };
        Self {
            substeps,
            iterations,
            tolerance,
            drag,
            friction,
            static_friction,
            thickness,
            projection,
            structural,
            tethers,
            self_contact,
        }
    }
}

/// Whether two settings are the same to the bit: unlike `==`, also where they are not a number.
pub(crate) fn same_settings(a: &solver::SolverSettings, b: &solver::SolverSettings) -> bool {
    let bits = |s: &solver::SolverSettings| {
        [s.tolerance, s.drag, s.friction, s.static_friction, s.thickness].map(f32::to_bits)
    };
    let choices = |s: &solver::SolverSettings| {
        (s.substeps, s.iterations, s.projection, s.structural, s.tethers, s.self_contact)
    };
    choices(a) == choices(b) && bits(a) == bits(b)
}

/// The [`SolverSettings`] of all bodies that have none of their own.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DefaultSolverSettings(pub SolverSettings);
