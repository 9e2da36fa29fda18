//! The settings and the surface of bodies that say nothing else.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::BodySettings;

use crate::body::fabric::Fabric;
use crate::body::settings::{DefaultSolverSettings, SolverSettings};
use crate::body::surface::{BodySurface, DefaultBodySurface};

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
    pub fn of_body(
        &self,
        settings: Option<&SolverSettings>,
        fabric: Option<&Fabric>,
        surface: Option<&BodySurface>,
    ) -> BodySettings {
        let surface = surface.copied().or(fabric.map(Fabric::surface)).unwrap_or(**self.surface);
        let settings = settings.copied().unwrap_or(**self.settings).on(surface);
        let tethers = settings.tethers && fabric.is_none_or(|fabric| !fabric.extensible);
        BodySettings { tethers, ..settings }
    }
}
