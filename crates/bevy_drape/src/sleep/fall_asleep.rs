//! Puts resting islands to sleep, by the rule of `falls_asleep` (solver, `world/activity_rules.rs`).

use bevy::prelude::*;

use crate::body::activity::Activity;
use crate::sleep::scene_manager::SceneManager;
use crate::step::islands::Islands;

/// Puts the bodies and balls of an island to sleep once all of them have been slow for the sleep time.
pub(crate) fn fall_asleep(
    islands: Res<Islands>,
    manager: Res<SceneManager>,
    mut activities: Query<&mut Activity>,
) {
    let rules = manager.rules();
    for island in islands.live().iter().filter(|island| rules.falls_asleep(island.staged.still_for)) {
        for &entity in island.bodies.iter().chain(&island.balls) {
            if let Ok(mut activity) = activities.get_mut(entity) {
                *activity = Activity::Resting;
            }
        }
    }
}
