//! A cloth that balls bounce and roll on, and what the contact events tell.
//!
//! `cargo run --release --example trampoline --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::contact::BallHit;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A trampoline counts what lands on it",
    controls: "",
    eye: Vec3::new(1.5, 1.75, 2.7),
    target: Vec3::new(0.0, 0.75, 0.0),
    picture_time: 2.0,
    build: |app| {
        app.add_systems(Update, count).add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Hits so far.
#[derive(Resource, Default)]
struct Landings(u32);

fn setup(mut commands: Commands) {
    commands.init_resource::<Landings>();
    commands.spawn(Obstacle::ground());
    let sheet = Cloth::new(2.0, 2.0).with_particles(49, 49).with_pins(ClothPins::Corners);
    let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
    commands.spawn((
        sheet,
        Paint::rgb(0.85, 0.72, 0.45),
        Transform::from_xyz(0.0, 0.9, 0.0).with_rotation(flat),
    ));
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        commands.spawn((Obstacle::capsule(0.04, 0.9), Transform::from_xyz(x, 0.42, z)));
    }
    for ball in 0..6_u8 {
        let angle = 1.1 * f32::from(ball);
        let place = Vec3::new(0.5 * angle.cos(), 1.6 + 0.35 * f32::from(ball), 0.5 * angle.sin());
        let ball =
            Projectile { radius: 0.13, mass: 0.5, velocity: Vec3::ZERO, restitution: 0.6, ..default() };
        commands.spawn((ball, Transform::from_translation(place)));
    }
}

fn count(mut hits: MessageReader<BallHit>, mut landings: ResMut<Landings>) {
    for hit in hits.read() {
        landings.0 += 1;
        debug!("landing {} at {}", landings.0, hit.point);
    }
}
