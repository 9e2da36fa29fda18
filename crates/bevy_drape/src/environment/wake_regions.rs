//! Regions in which obstacles wake resting bodies.

use bevy::prelude::*;
use drape_solver::Obstacle;
use drape_solver::world::waking::Proxy;

/// Boxes and layers of what appeared, vanished, changed or moves in this step: bodies at rest there wake up, if they could
/// touch it.
#[derive(Resource, Default)]
pub(crate) struct WakeRegions(pub Vec<Proxy>);

impl WakeRegions {
    pub fn push(&mut self, obstacle: &Obstacle) {
        self.0.push(Proxy::of_obstacle(obstacle));
    }
}
