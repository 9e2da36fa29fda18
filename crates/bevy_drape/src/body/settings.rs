//! Solver settings: a component for one body, a resource for all others.

use bevy::prelude::*;
use drape_solver::state::settings as solver;

/// Formula that moves the ends of a stick to its rest length.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StickProjection {
    /// The exact projection: one square root per stick.
    #[default]
    Exact,
    /// One Newton step without a square root: exact to second order in the strain.
    SquareRootFree,
}

/// Method that brings structural sticks to their rest lengths.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StructuralSolve {
    /// One stick after another, like all other sticks.
    #[default]
    Sweeps,
    /// Solves each row and each column of a cloth, and each rope, directly as a chain: a tenth of the stretch in equal
    /// time, from 8 substeps on. Soft sticks and small bodies are swept.
    Lines,
}

/// Contact of a body with itself, and with other bodies that have this on. The [solver's](solver::SelfContact) docs
/// give costs and benefits.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SelfContact {
    /// None.
    #[default]
    Off,
    /// Particle against particle: for cloth as thick as its particles are apart.
    Particles,
    /// Faces, links and edges: for thin cloth, ropes, and layers that move fast.
    Triangles,
}

/// Quality of the solution: `SolverSettings::from(Quality::High)`. The [solver's](solver::Quality) docs give costs and
/// benefits.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum Quality {
    /// For distant or small bodies.
    Low,
    /// Equal to [`SolverSettings::default`].
    #[default]
    Medium,
    /// For bodies that must not stretch: solves rows and columns of cloth as chains.
    High,
}

/// Settings of one body: accuracy, damping and surface. A body without this component uses [`DefaultSolverSettings`].
/// With values out of range the body is left out of the simulation and an error is logged.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolverSettings {
    /// Substeps per step, 1 to 256. Small steps buy more stiffness than iterations for the same work.
    pub substeps: u32,
    /// Relaxation iterations per substep, 1 to 1024. Even numbers run as symmetric pairs.
    pub iterations: u32,
    /// Strain below which relaxation stops before its last iteration, from 0 (never) to 1. It pays from about 8
    /// iterations on.
    pub tolerance: f32,
    /// Drag of still air in 1/s, 0 or more: velocity decays as `exp(-drag t)`.
    pub drag: f32,
    /// Coulomb friction coefficient, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, 0 or more, which holds until sliding begins; at least `friction` counts. Two
    /// surfaces in contact use the mean of theirs.
    pub static_friction: f32,
    /// Distance in metres that the middle of the cloth keeps from everything that it touches.
    pub thickness: f32,
    /// The formula for sticks.
    pub projection: StickProjection,
    /// Method for structural sticks.
    pub structural: StructuralSolve,
    /// True if tethers hold particles within their rest distance from the pins.
    pub tethers: bool,
    /// Contact of the body with itself, and with others that have this on. Layers keep apart by the sum of the two
    /// thicknesses.
    pub self_contact: SelfContact,
}

impl Default for SolverSettings {
    fn default() -> Self {
        solver::SolverSettings::default().into()
    }
}

impl SolverSettings {
    /// Sets the quality of the solution. Drag, friction and thickness stay.
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

/// True if two settings are the same to the bit. Unlike with `==`, NaN equals itself.
pub(crate) fn same_settings(a: &solver::SolverSettings, b: &solver::SolverSettings) -> bool {
    let bits = |s: &solver::SolverSettings| {
        [s.tolerance, s.drag, s.friction, s.static_friction, s.thickness].map(f32::to_bits)
    };
    let choices = |s: &solver::SolverSettings| {
        (s.substeps, s.iterations, s.projection, s.structural, s.tethers, s.self_contact)
    };
    choices(a) == choices(b) && bits(a) == bits(b)
}

/// The [`SolverSettings`] of all bodies without settings of their own.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DefaultSolverSettings(pub SolverSettings);
