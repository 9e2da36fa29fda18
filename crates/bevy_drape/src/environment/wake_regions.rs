//! Regions in which obstacles wake resting bodies.

use bevy::prelude::*;
use drape_solver::Layers;

use crate::bounds::Bounds;

/// Boxes and layers of obstacles that appeared, vanished, changed or move in this step. Resting bodies that could touch
/// them wake.
#[derive(Resource, Default)]
pub(crate) struct WakeRegions(pub Vec<(Bounds, Layers)>);

impl WakeRegions {
    pub fn push(&mut self, obstacle: &drape_solver::Obstacle) {
        self.0.push((obstacle.swept_bounds(), obstacle.layers()));
    }
}
