//! Solver settings: a component for one body, a resource for all others.

use bevy::prelude::*;
use drape_solver::BodySettings;
pub use drape_solver::{Quality, SelfContact, StickProjection, StructuralSolve};

use crate::body::surface::BodySurface;

/// The solver's effort for a body, and its methods. What the body is made of is in its [`Fabric`](crate::body::Fabric)
/// or [`BodySurface`].
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands) {
/// commands.spawn((Cloth::new(2.0, 1.5), SolverSettings::from(Quality::High)));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolverSettings {
    /// Substeps per step, 1 to 256. Small steps buy more stiffness than iterations for the same work.
    pub substeps: u32,
    /// Relaxation iterations per substep, 1 to 1024: Jakobsen's N. With [lines](StructuralSolve::Lines) only the last one
    /// relaxes sticks.
    pub iterations: u32,
    /// Strain `|length / rest length - 1|` below which relaxation stops early, from 0 (never) to 1. It pays from some 8
    /// iterations on ([`BodySettings::tolerance`]). A body with lines takes all iterations.
    pub tolerance: f32,
    /// The formula for sticks.
    pub projection: StickProjection,
    /// The solver of structural sticks. With more than one iteration, a body with
    /// [`Tearable`](crate::body::tearable::Tearable) is swept whatever it says here.
    pub structural: StructuralSolve,
    /// True if tethers hold particles within their rest distance from the pins.
    pub tethers: bool,
    /// Contact of the body with itself, and with others that have it on.
    pub self_contact: SelfContact,
}

impl Default for SolverSettings {
    /// [`Quality::Medium`], without self-contact.
    fn default() -> Self {
        Self::from(BodySettings::default())
    }
}

impl From<Quality> for SolverSettings {
    fn from(quality: Quality) -> Self {
        Self::default().with_quality(quality)
    }
}

impl From<BodySettings> for SolverSettings {
    fn from(settings: BodySettings) -> Self {
        let BodySettings {
            substeps,
            iterations,
            tolerance,
            projection,
            structural,
            tethers,
            self_contact,
            ..
        } = settings;
        Self { substeps, iterations, tolerance, projection, structural, tethers, self_contact }
    }
}

impl SolverSettings {
    /// Sets the accuracy; self-contact stays.
    #[must_use]
    pub fn with_quality(self, quality: Quality) -> Self {
        self.on(BodySurface::default()).with_quality(quality).into()
    }

    /// The solver's settings of a body with this surface.
    pub(crate) fn on(self, surface: BodySurface) -> BodySettings {
        let Self { substeps, iterations, tolerance, projection, structural, tethers, self_contact } = self;
        let BodySurface { friction, static_friction, thickness, drag } = surface;
        BodySettings {
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

/// The [`SolverSettings`] of all bodies that have none of their own.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DefaultSolverSettings(pub SolverSettings);
