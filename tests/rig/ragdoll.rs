//! Ragdolls.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Ragdoll, Rig, Stick, StickBound};

use crate::support::*;

fn stairs(rigs: &mut Rigs) {
    rigs.spawn((Obstacle::ground(), Transform::default()));
    for k in 0..5 {
        let (height, depth) = (0.18 * (5 - k) as f32, if k == 0 { 2.0 } else { 0.28 });
        let right = 0.28 * (k + 1) as f32;
        let middle = Transform::from_xyz(right - 0.5 * depth, 0.5 * height, 0.0);
        rigs.spawn((Obstacle::cuboid(depth, height, 3.0), middle));
    }
}

/// Acceptance: pushed off the stairs it tumbles down and ends asleep, each limb as long as it was to 1 %.
#[test]
fn a_ragdoll_tumbles_down_the_stairs_and_sleeps() {
    let mut rigs = Rigs::new();
    stairs(&mut rigs);
    let top = Transform::from_xyz(0.1, 0.9, 0.0).with_rotation(Quat::from_rotation_y(1.57));
    // Falling forwards, about the feet.
    let before = top.with_rotation(Quat::from_rotation_z(2.0 * STEP) * top.rotation);
    let world = rigs.app.world_mut();
    let limbs = Ragdoll::default().spawn_moving(&mut world.commands(), before, top, STEP).expect("valid");
    world.flush();
    rigs.seconds(12.0);
    assert_eq!(rigs.count::<Rig>(), 1, "it is one body");
    assert_eq!(rigs.activity(limbs.particles[0]), Activity::Resting);
    let mut rods = 0;
    for &entity in &limbs.sticks {
        let stick = *rigs.app.world().get::<Stick>(entity).expect("a stick");
        let length = rigs.place(stick.a).distance(rigs.place(stick.b));
        let strain = length / stick.rest_length.expect("it has one") - 1.0;
        match stick.bound {
            StickBound::Exact => {
                rods += 1;
                assert!(strain.abs() < 0.01, "a limb is {strain} too long");
            }
            StickBound::AtLeast => assert!(strain > -0.05, "a joint is {strain} too closed"),
            StickBound::AtMost => assert!(strain < 0.05, "a joint is {strain} too open"),
        }
    }
    assert!(rods > 30);
    let head = rigs.place(limbs.particles[0]);
    assert!(head.y < 0.5 && head.x > 1.0, "its head is at {head}");
    rigs.assert_no_errors();
}

#[test]
fn a_ragdoll_that_cannot_be_spawns_nothing() {
    let mut rigs = Rigs::new();
    let doll = Ragdoll { height: 0.0, ..default() };
    let world = rigs.app.world_mut();
    let error = doll.spawn(&mut world.commands(), Transform::default()).expect_err("refused");
    world.flush();
    assert!(error.to_string().contains("height"));
    assert_eq!((rigs.count::<Particle>(), rigs.count::<Stick>()), (0, 0));
}
