//! A street of flags: red ones are simulated in full, yellow and blue ones are coarser, grey ones are frozen.
//!
//! `cargo run --release --example detail --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`. The one who looks runs down the street and back, wherever the camera is.

use bevy::prelude::*;
use bevy_drape::detail::{CurrentDetail, LevelOfDetail};
use bevy_drape::environment::Gusts;
use bevy_drape::prelude::*;
use bevy_drape::viewer::Viewer;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A street of flags, less work for those far away",
    controls: "",
    eye: Vec3::new(-5.5, 3.2, 3.5),
    target: Vec3::new(0.3, 2.7, -8.0),
    picture_time: 3.0,
    build: |app| {
        app.add_systems(Startup, setup)
            .add_systems(FixedUpdate, run_down_the_street)
            .add_systems(Update, paint_by_level);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Flags on one side of the street, and the distance between two of them in metres.
const FLAGS: u8 = 16;
const SPACING: f32 = 4.0;

/// Colours of the levels.
const PAINTS: [Paint; 4] = [
    Paint::rgb(0.75, 0.15, 0.15),
    Paint::rgb(0.93, 0.78, 0.25),
    Paint::rgb(0.15, 0.30, 0.60),
    Paint::rgb(0.45, 0.45, 0.45),
];

fn setup(mut commands: Commands, mut wind: ResMut<Wind>) {
    *wind = Wind {
        lift_coefficient: 1.0,
        gusts: Gusts { speed: 2.0, ..default() },
        ..Wind::new(Vec3::new(6.0, 0.0, 1.0))
    };
    commands.spawn(Obstacle::ground());
    commands.spawn((Viewer, Transform::from_xyz(0.0, 2.0, 8.0)));
    // A short street, so that all levels are seen from near by.
    let levels = LevelOfDetail { importance: 0.35, ..default() };
    for i in 0..2 * FLAGS {
        let x = if i.is_multiple_of(2) { -3.0 } else { 3.0 };
        let place = Vec3::new(x, 0.0, -SPACING * f32::from(i / 2));
        let flag = Cloth::new(1.5, 1.0).with_particles(33, 33).with_pins(ClothPins::Left);
        commands.spawn((
            flag,
            levels.clone(),
            PAINTS[0],
            Transform::from_translation(place + Vec3::new(0.79, 3.2, 0.0)),
        ));
        let pole = Obstacle::capsule(0.03, 3.7);
        commands.spawn((pole, Transform::from_translation(place + Vec3::Y * 1.85)));
    }
}

fn run_down_the_street(time: Res<Time>, mut viewer: Single<&mut Transform, With<Viewer>>) {
    let length = SPACING * f32::from(FLAGS);
    viewer.translation.z = 8.0 - 0.5 * length * (1.0 - (0.4 * (time.elapsed_secs() - 3.0).max(0.0)).cos());
}

fn paint_by_level(mut flags: Query<(&CurrentDetail, &mut Paint), Changed<CurrentDetail>>) {
    for (detail, mut paint) in &mut flags {
        *paint = PAINTS[detail.level().min(PAINTS.len() - 1)];
    }
}
