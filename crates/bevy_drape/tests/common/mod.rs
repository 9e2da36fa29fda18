//! Frames of an app whose clock the test moves.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;

/// Bevy's default fixed step, 1/64 s: exact in nanoseconds and in binary.
pub const TIMESTEP: Duration = Duration::from_micros(15_625);

/// Makes the app ready; its first update is one of no time.
pub fn start(app: &mut App) {
    app.finish();
    app.cleanup();
    app.update();
}

/// One frame, as long as `steps` fixed steps.
pub fn frame(app: &mut App, steps: f64) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TIMESTEP.mul_f64(steps)));
    app.update();
}

/// A sheet of 1 m x 1 m in 9 x 9 particles that falls and swings from its top left corner.
pub fn swinging() -> Cloth {
    Cloth::new(1.0, 1.0).with_particles(9, 9).with_pins(ClothPins::Indices(vec![0]))
}
