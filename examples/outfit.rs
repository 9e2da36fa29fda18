//! A shirt under a jacket under a cape, which touch each other, on a character that sprints, turns and falls.
//!
//! `cargo run --release --example outfit --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::prelude::*;
use drape_examples::character::{self, Character, SPRINT, bone_meshes};
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A shirt under a jacket under a cape",
    controls: "",
    eye: Vec3::new(-1.5, 1.35, 0.75),
    target: Vec3::new(0.0, 0.97, -1.75),
    picture_time: 1.8,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(Update, run);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(world: &mut World) {
    world.spawn(Obstacle::ground());
    let character = character::spawn_figure(world);
    for &capsule in &character.capsules {
        world.entity_mut(capsule).insert(Visibility::Hidden);
    }
    bone_meshes::spawn_figure(world, &character.joints, Paint::rgb(0.50, 0.52, 0.54));
    let paints = [Paint::rgb(0.80, 0.74, 0.62), Paint::rgb(0.12, 0.20, 0.34), Paint::rgb(0.55, 0.06, 0.10)];
    let outfit = character::spawn_outfit(world, &character);
    for (garment, paint) in outfit.into_iter().zip(paints) {
        world.entity_mut(garment).insert(paint);
    }
    world.insert_resource(character);
    world.insert_resource(Clothes(outfit));
}

/// From the skin outwards.
#[derive(Resource)]
struct Clothes([Entity; 3]);

/// Length of the run along Z in metres, after which the character is put back.
const TRACK: f32 = 6.0;

/// Moves the joints once a frame, as an animation player does.
fn run(world: &mut World) {
    let time = world.resource::<Time>().elapsed_secs() % (SPRINT + 1.0);
    world.resource_scope(|world, mut character: Mut<Character>| {
        if time < 1.0 && character.time > 15.0 {
            character.rewind();
            for garment in world.resource::<Clothes>().0 {
                world.entity_mut(garment).insert(TeleportCloth);
            }
        }
        let (mut root, joints) = character.sprint(time);
        // So far that it is a teleport by itself.
        root.translation.z = (root.translation.z + 0.5 * TRACK).rem_euclid(TRACK) - 0.5 * TRACK;
        root.translation.x = 0.0;
        character.show(world, root, &joints);
    });
}
