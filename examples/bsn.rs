//! A washing line, a flag and a basket on a rope, written in Bevy's scene notation.
//!
//! `cargo run --release --example bsn --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use core::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A scene in Bevy's scene notation",
    controls: "",
    eye: Vec3::new(0.6, 1.5, 4.3),
    target: Vec3::new(-0.05, 1.32, 0.0),
    picture_time: 2.0,
    build: |app| {
        app.insert_resource(Wind { velocity: Vec3::new(2.5, 0.0, 1.0), ..default() });
        app.add_systems(Startup, |mut commands: Commands| commands.spawn_scene_list(scene()));
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// A pole of this height in metres.
fn pole(height: f32) -> impl Scene {
    bsn! {
        Obstacle { shape: ObstacleShape::Capsule { radius: 0.03, length: height } }
        Paint::rgb(0.45, 0.42, 0.40)
    }
}

fn scene() -> impl SceneList {
    bsn_list! {
        #Ground
        Obstacle { shape: ObstacleShape::HalfSpace { normal: Vec3::Y } }
        --
        #Flagpole
        @pole(2.6)
        Transform { translation: Vec3 { x: 0.9, y: 1.3 } }
        Children [
            #Flag
            Cloth { size: Vec2 { x: 1.3, y: 0.8 }, particles: UVec2 { x: 40, y: 25 }, pins: ClothPins::Left }
            Fabric { drag: 1.2 }
            Paint::rgb(0.78, 0.12, 0.10)
            Transform { translation: Vec3 { x: 0.68, y: 0.85 } }
        ]
        --
        #LeftPost
        @pole(1.8)
        Transform { translation: Vec3 { x: -2.2, y: 0.9 } }
        --
        #MiddlePost
        @pole(1.8)
        Transform { translation: Vec3 { x: -0.4, y: 0.9 } }
        --
        #Line
        Rope { end: { Vec3::X * 1.8 }, particles: 40, pin_end: true }
        RopeMesh { radius: 0.008 }
        Paint::rgb(0.70, 0.55, 0.30)
        Transform { translation: Vec3 { x: -2.2, y: 1.76 } }
        --
        #Sheet
        Cloth { size: Vec2 { x: 1.4, y: 1.1 }, particles: UVec2 { x: 44, y: 35 } }
        Paint::rgb(0.88, 0.86, 0.78)
        Transform { translation: Vec3 { x: -1.3, y: 1.205 } }
        --
        #Beam
        @pole(0.9)
        Transform { translation: Vec3 { x: 0.45, y: 2.3 }, rotation: { Quat::from_rotation_z(FRAC_PI_2) } }
        --
        #Rope
        Rope { end: { Vec3::NEG_Y * 1.2 }, particles: 40, end_mass: 3.0 }
        RopeMesh { radius: 0.012 }
        Paint::rgb(0.70, 0.55, 0.30)
        Transform { translation: Vec3 { x: 0.25, y: 2.27 } }
        --
        #Basket
        Obstacle { shape: ObstacleShape::Cylinder { radius: 0.14, height: 0.2 } }
        // Only to look at: the rope carries its weight.
        DrapeLayers { memberships: 0, filters: 0 }
        FollowParticle { body: #Rope, offset: { Vec3::NEG_Y * 0.1 } }
        Paint::rgb(0.50, 0.33, 0.16)
    }
}
