//! Sheets that listen to themselves: each blushes when it touches something, and turns blue when it has fallen asleep.
//!
//! `cargo run --release --example observers --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use core::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_drape::contact::DrapeContactStarted;
use bevy_drape::prelude::*;
use bevy_drape::sleep::{BodySlept, BodyWoken};
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Sheets that turn red when they touch something, and blue when they sleep",
    controls: "",
    eye: Vec3::new(1.6, 1.7, 4.3),
    target: Vec3::new(0.45, 0.6, 0.0),
    picture_time: 3.2,
    build: |app| {
        app.add_systems(Startup, setup);
    },
};

const IN_FLIGHT: Paint = Paint::rgb(0.90, 0.88, 0.80);
const TOUCHING: Paint = Paint::rgb(0.85, 0.22, 0.14);
const ASLEEP: Paint = Paint::rgb(0.14, 0.32, 0.72);

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    // The higher a sheet hangs, the later it lands.
    for (place, height) in [0.75, 1.0, 2.0, 12.5, 13.6].into_iter().enumerate() {
        let x = 1.3 * (place as f32 - 2.0);
        commands.spawn((Obstacle::sphere(0.32), Transform::from_xyz(x, 0.32, 0.0)));
        let sheet = Cloth::new(1.0, 1.0).with_spacing(0.03).with_pins(ClothPins::None);
        let level = Transform::from_xyz(x, height, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
        commands
            .spawn((sheet, Fabric { drag: 2.0, ..default() }, ContactEvents, IN_FLIGHT, level))
            .observe(|touched: On<DrapeContactStarted>, mut paints: Query<&mut Paint>| {
                paint(touched.event_target(), TOUCHING, &mut paints);
            })
            .observe(|slept: On<BodySlept>, mut paints: Query<&mut Paint>| {
                paint(slept.event_target(), ASLEEP, &mut paints);
            })
            .observe(|woken: On<BodyWoken>, mut paints: Query<&mut Paint>| {
                paint(woken.event_target(), TOUCHING, &mut paints);
            });
    }
}

fn paint(sheet: Entity, colour: Paint, paints: &mut Query<&mut Paint>) {
    if let Ok(mut paint) = paints.get_mut(sheet) {
        paint.set_if_neq(colour);
    }
}
