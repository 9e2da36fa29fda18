//! Regions in which obstacles wake resting bodies.

use bevy::prelude::*;
use drape_solver::Obstacle;
use drape_solver::world::waking::Proxy;

/// Boxes and layers of obstacles that appeared, vanished, changed or move in this step. Resting bodies that could touch
/// them wake.
#[derive(Resource, Default)]
pub(crate) struct WakeRegions(pub Vec<Proxy>);

impl WakeRegions {
    pub fn push(&mut self, obstacle: &Obstacle) {
        self.0.push(Proxy::of_obstacle(obstacle));
    }
}
