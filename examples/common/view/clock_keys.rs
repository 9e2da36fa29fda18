//! The keys that stop and slow down the clock, the same in every window.

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;

/// The speed of slow motion, as a fraction of real time.
const SLOW_MOTION: f32 = 0.2;

/// P pauses, O takes one step, T turns slow motion on and off.
pub fn control_clock(keys: Res<ButtonInput<KeyCode>>, mut clock: ResMut<DrapeClock>) {
    if keys.just_pressed(KeyCode::KeyP) {
        clock.paused = !clock.paused;
    }
    if keys.just_pressed(KeyCode::KeyO) {
        clock.paused = true;
        clock.step_once();
    }
    if keys.just_pressed(KeyCode::KeyT) {
        clock.time_scale = if clock.time_scale < 1.0 { 1.0 } else { SLOW_MOTION };
    }
}
