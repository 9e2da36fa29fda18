//! The settings and the surface of bodies that say nothing else.

use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::{BodySettings, StructuralSolve};

use crate::body::fabric::Fabric;
use crate::body::settings::{DefaultSolverSettings, SolverSettings};
use crate::body::surface::{BodySurface, DefaultBodySurface};
use crate::body::tearable::Tearable;

/// The components of a body that its solver's settings depend on.
#[derive(QueryData)]
pub(crate) struct Described {
    settings: Option<&'static SolverSettings>,
    fabric: Option<&'static Fabric>,
    surface: Option<&'static BodySurface>,
    is_tearable: Has<Tearable>,
}

/// The settings and the surface of bodies that have none of their own.
#[derive(SystemParam)]
pub(crate) struct Defaults<'w> {
    settings: Res<'w, DefaultSolverSettings>,
    surface: Res<'w, DefaultBodySurface>,
}

impl Defaults<'_> {
    /// True if either was changed since the system last ran.
    pub fn is_changed(&self) -> bool {
        self.settings.is_changed() || self.surface.is_changed()
    }

    /// The solver's settings of a body with these components. Its own surface counts before that of its fabric.
    ///
    /// What may tear is swept, unless its settings have one iteration: lines leave no strain to tear by.
    pub fn of_body(&self, body: DescribedItem) -> BodySettings {
        let DescribedItem { settings, fabric, surface, is_tearable } = body;
        let surface = surface.copied().or(fabric.map(Fabric::surface)).unwrap_or(**self.surface);
        let settings = settings.copied().unwrap_or(**self.settings).on(surface);
        let tethers = settings.tethers && fabric.is_none_or(|fabric| !fabric.extensible);
        let is_swept = is_tearable && settings.iterations > 1;
        let structural = if is_swept { StructuralSolve::Sweeps } else { settings.structural };
        BodySettings { tethers, structural, ..settings }
    }
}
