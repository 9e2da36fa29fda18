//! A dancer with a ponytail and a skirt of bones: chains of joints of skinned meshes, solved as a rope and as cloth.
//!
//! `cargo run --release --example bones --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use core::f32::consts::{FRAC_PI_3, PI, TAU};

use bevy::prelude::*;
use bevy_drape::bones::{BoneCloth, BoneWeave};
use bevy_drape::prelude::*;
use drape_examples::character::{self, Character, HEAD, HIPS, bone_meshes};
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A ponytail and a skirt of bones",
    controls: "",
    eye: Vec3::new(1.8, 1.2, 2.1),
    target: Vec3::new(0.0, 0.93, 0.0),
    picture_time: 7.5,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(Update, dance);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Chains of the skirt.
const CHAINS: usize = 24;

fn setup(world: &mut World) {
    world.spawn(Obstacle::ground());
    let character = character::spawn_figure(world);
    let [head, hips] = [HEAD, HIPS].map(|joint| character.joints[joint]);
    for &capsule in &character.capsules {
        world.entity_mut(capsule).insert(Visibility::Hidden);
    }
    bone_meshes::spawn_figure(world, &character.joints, Paint::rgb(0.50, 0.52, 0.54));

    let hair = spawn_chain(world, head, Vec3::new(0.0, 0.2, 0.1), Vec3::new(0.0, -0.9, 0.44) * 0.075, 7);
    bone_meshes::spawn_tail(world, &hair, 0.04, Paint::rgb(0.16, 0.06, 0.025));
    let tail =
        BoneCloth { drive_frequency: 5.0, drive_damping: 0.4, max_bend: 0.6, ..BoneCloth::new([hair[0]]) };
    world.spawn((tail, BodySurface { thickness: 0.03, drag: 1.0, ..default() }));

    let skirt: Vec<Vec<Entity>> = (0..CHAINS)
        .map(|chain| {
            let out = Quat::from_rotation_y(TAU * chain as f32 / CHAINS as f32) * Vec3::X;
            // In pleats.
            let way = (out * [0.62, 0.3][chain % 2] + Vec3::NEG_Y).normalize() * 0.1;
            spawn_chain(world, hips, out * 0.16 + Vec3::Y * 0.06, way, 5)
        })
        .collect();
    bone_meshes::spawn_skirt(world, &skirt, Paint::rgb(0.55, 0.07, 0.16));
    let roots = skirt.iter().map(|chain| chain[0]);
    let skirt = BoneCloth { drive_frequency: 2.0, drive_damping: 0.3, ..BoneCloth::new(roots) };
    let surface = BodySurface { thickness: 0.012, friction: 0.2, drag: 1.0, ..default() };
    world.spawn((skirt.with_weave(BoneWeave::Tube), surface));
    world.insert_resource(character);
}

/// A chain of joints from `start` on, in the coordinates of its parent, each as long and in the direction of `bone`.
fn spawn_chain(world: &mut World, parent: Entity, start: Vec3, bone: Vec3, count: usize) -> Vec<Entity> {
    // As in Blender, where bones lie along their Y axis.
    let turn = Quat::from_rotation_arc(Vec3::Y, bone.normalize());
    let root = Transform::from_translation(start).with_rotation(turn);
    let next = Transform::from_translation(Vec3::Y * bone.length());
    let mut joints: Vec<Entity> = Vec::new();
    for place in core::iter::once(root).chain(core::iter::repeat(next)).take(count) {
        let parent = joints.last().copied().unwrap_or(parent);
        joints.push(world.spawn((place, Visibility::default(), ChildOf(parent))).id());
    }
    joints
}

/// Turns round and back, with arms held out and bent knees, once a frame as an animation player does.
fn dance(world: &mut World) {
    let time = world.resource::<Time>().elapsed_secs();
    // At most one turn in a second.
    let heading = TAU / FRAC_PI_3 * (1.0 - libm::cosf(FRAC_PI_3 * time));
    let bounce = 0.5 - 0.5 * libm::cosf(TAU * time);
    world.resource_scope(|world, character: Mut<Character>| {
        let (_, mut joints) = character.pose();
        for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
            joints[character::ARMS[side]].rotation = Quat::from_rotation_z(-sign * 0.42 * PI);
            let bend = 0.45 * bounce;
            joints[character::THIGHS[side]].rotation =
                Quat::from_rotation_x(bend) * Quat::from_rotation_z(-0.12 * sign);
            joints[character::SHINS[side]].rotation = Quat::from_rotation_x(-2.0 * bend);
        }
        joints[HEAD].rotation = Quat::from_rotation_x(0.15 * libm::sinf(TAU * time));
        let down = 0.9 * (1.0 - libm::cosf(0.45 * bounce));
        let root = Transform::from_xyz(0.0, -down, 0.0).with_rotation(Quat::from_rotation_y(heading));
        character.show(world, root, &joints);
    });
}
