//! A playground in Avian: a character walks through a curtain, a net catches crates, and a wrecking ball hits a stack of them.
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml -p drape_playground --example avian_playground --features
//! avian,window`; `--headless` runs without a window, and `--picture FILE` draws a picture with `--features avian,render`.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_avian::AvianDrapePlugin;
use drape_examples::feature::Feature;
use drape_playground::*;

const FEATURE: Feature = playground("Cloth, ropes and the bodies of Avian", |app| {
    app.add_plugins((PhysicsPlugins::default(), AvianDrapePlugin::default(), PlaygroundPlugin))
        .add_systems(Startup, (spawn_fixtures, spawn_character, drop_crates, hang_ball))
        .add_systems(FixedUpdate, turn_round);
});

fn main() -> std::process::ExitCode {
    FEATURE.run()
}

#[derive(Component)]
struct Character;

fn spawn_fixtures(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Collider::half_space(Vec3::Y)));
    for (place, size) in FIXTURES {
        let collider = Collider::cuboid(size.x, size.y, size.z);
        commands.spawn((RigidBody::Static, collider, Transform::from_translation(place), STEEL));
    }
}

/// A character that walks through the curtain.
fn spawn_character(mut commands: Commands) {
    commands.spawn((
        Character,
        RigidBody::Kinematic,
        Collider::capsule(CHARACTER_RADIUS, CHARACTER_LENGTH),
        LinearVelocity(Vec3::Z * WALK),
        Transform::from_translation(CHARACTER),
        COAT,
    ));
}

fn turn_round(mut characters: Query<(&Transform, &mut LinearVelocity), With<Character>>) {
    for (place, mut velocity) in &mut characters {
        if place.translation.z.abs() > CHARACTER.z.abs() {
            velocity.z = -place.translation.z.signum() * WALK;
        }
    }
}

/// Crates that fall into the net.
fn drop_crates(mut commands: Commands) {
    for place in falling_crates() {
        commands.spawn((Caught, crate_at(place)));
    }
}

/// A ball that hangs on a rope, and a stack of crates in its way.
fn hang_ball(mut commands: Commands) {
    let place = ball_place();
    let ball = (
        WreckingBall,
        RigidBody::Dynamic,
        Collider::sphere(BALL_RADIUS),
        ColliderDensity(BALL_DENSITY),
        Transform::from_translation(place),
        STEEL,
    );
    let ball = commands.spawn(ball).id();
    let hook = commands.spawn(Transform::from_translation(HOOK)).id();
    // Each end follows what it is tied to, and pulls at it.
    let tied = Attachment::first(hook).and(Tie::last(ball));
    commands.spawn((Rope::new(HOOK, place, 40), tied, RopeMesh::new(0.018), HEMP));
    for place in stacked_crates() {
        commands.spawn((Stacked(place.translation), crate_at(place)));
    }
}

fn crate_at(place: Transform) -> impl Bundle {
    let collider = Collider::cuboid(CRATE, CRATE, CRATE);
    (RigidBody::Dynamic, collider, ColliderDensity(WOOD_DENSITY), place, WOOD)
}
