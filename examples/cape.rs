//! A cape on a skinned character that walks, runs, jumps and turns about: pins and limits painted on its mesh, capsules on the
//! bones, and a share of the character's motion that it does not feel.
//!
//! `cargo run --release --example cape --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::prelude::*;
use drape_examples::character::{self, Character};
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A cape on a character that walks, runs, jumps and turns",
    controls: "Space: turn at once, as in a teleport",
    eye: Vec3::new(-1.25, 1.35, -1.05),
    target: Vec3::new(-3.5, 0.95, 0.2),
    picture_time: 12.4,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(Update, animate);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

fn setup(world: &mut World) {
    world.spawn(Obstacle::ground());
    let surface = BodySurface { drag: 1.0, thickness: 0.01, ..default() };
    let character = character::spawn(world, (surface, Paint::rgb(0.62, 0.10, 0.14)));
    let motion = WorldMotion::of(character.root).with_scale(0.6, 0.6);
    world.entity_mut(character.cape).insert(motion);
    world.insert_resource(character);
}

/// Length of the run along Z in metres, after which the character is put back.
const TRACK: f32 = 6.0;

/// Moves the joints once a frame, as an animation player does.
fn animate(world: &mut World) {
    let time = world.resource::<Time>().elapsed_secs() % character::WALK;
    let keys = world.get_resource::<ButtonInput<KeyCode>>();
    let mut is_teleport = keys.is_some_and(|keys| keys.just_pressed(KeyCode::Space));
    world.resource_scope(|world, mut character: Mut<Character>| {
        if is_teleport {
            character.heading += 2.0;
        }
        if time < character.time - 1.0 {
            character.rewind();
            is_teleport = true;
        }
        character.advance(time);
        // So far that it is a teleport by itself.
        character.place.z = (character.place.z + 0.5 * TRACK).rem_euclid(TRACK) - 0.5 * TRACK;
        if is_teleport {
            world.entity_mut(character.cape).insert(TeleportCloth);
        }
        character.write(world);
    });
}
