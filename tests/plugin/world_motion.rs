//! The share of its parent's motion that a body feels; teleports; parents that move once a frame.

use bevy::prelude::*;
use bevy_drape::attach::TeleportCloth;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::transform::MovedByFrame;

use crate::common::*;

/// A curtain on a waggon, that feels this much of its motion.
fn on_waggon(linear: f32, angular: f32) -> (App, Entity, Entity) {
    let mut app = app();
    let waggon = app.world_mut().spawn(Transform::default()).id();
    let motion = WorldMotion::of(waggon).with_scale(linear, angular);
    let curtain = app
        .world_mut()
        .spawn((curtain(), quiet(), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(waggon), motion))
        .id();
    settle(&mut app, curtain);
    (app, waggon, curtain)
}

/// The place of a corner of the hem, in the waggon's coordinates.
fn hem(app: &App, waggon: Entity, curtain: Entity) -> Vec3 {
    let waggon = *get::<GlobalTransform>(app, waggon);
    waggon.affine().inverse().transform_point3(get::<Particles>(app, curtain).position(72))
}

#[test]
fn the_less_is_felt_the_less_it_swings() {
    let mut swings = Vec::new();
    for linear in [0.0, 0.3, 1.0] {
        let (mut app, waggon, curtain) = on_waggon(linear, 1.0);
        let rest = hem(&app, waggon, curtain);
        let mut most = 0.0_f32;
        for count in 0..120 {
            let time = count as f32 * STEP;
            get_mut::<Transform>(&mut app, waggon).translation.z = 0.5 - 0.5 * libm::cosf(4.0 * time);
            step(&mut app, 1);
            most = most.max(hem(&app, waggon, curtain).distance(rest));
        }
        swings.push(most);
    }
    assert!(swings[0] < 0.01, "it feels nothing: {swings:?}");
    assert!(swings[1] > 0.05 && swings[1] < 0.6 * swings[2], "{swings:?}");
    assert!(swings[2] > 0.2, "{swings:?}");
}

#[test]
fn turning_is_felt_apart_from_translation() {
    let mut swings = Vec::new();
    for angular in [0.0, 1.0] {
        let (mut app, waggon, curtain) = on_waggon(1.0, angular);
        let rest = hem(&app, waggon, curtain);
        let mut most = 0.0_f32;
        for _ in 0..60 {
            get_mut::<Transform>(&mut app, waggon).rotate_y(0.05);
            step(&mut app, 1);
            most = most.max(hem(&app, waggon, curtain).distance(rest));
        }
        swings.push(most);
    }
    assert!(swings[0] < 0.02 && swings[1] > 0.1, "{swings:?}");
}

#[test]
fn a_way_too_long_for_a_step_is_a_teleport_and_shorter_ones_can_be_marked() {
    for (way, is_marked) in [(Vec3::new(30.0, 1.0, -4.0), false), (Vec3::new(1.5, 0.0, 0.0), true)] {
        let (mut app, waggon, curtain) = on_waggon(1.0, 1.0);
        let capsule = (Obstacle::capsule(0.2, 0.6), Transform::from_xyz(0.0, 0.7, 0.25));
        app.world_mut().spawn((capsule, ChildOf(waggon)));
        run(&mut app, 1.0);
        let before = hem(&app, waggon, curtain);
        let mut transform = get_mut::<Transform>(&mut app, waggon);
        transform.translation += way;
        transform.rotate_y(2.0);
        if is_marked {
            app.world_mut().entity_mut(curtain).insert(TeleportCloth);
        }
        step(&mut app, 1);
        assert!(!app.world().entity(curtain).contains::<TeleportCloth>());
        assert!(hem(&app, waggon, curtain).distance(before) < 0.01);
        step(&mut app, 30);
        assert!(hem(&app, waggon, curtain).distance(before) < 0.02);
        assert!(get::<Particles>(&app, curtain).greatest_speed() < 0.5);
    }
}

#[test]
fn bodies_without_world_motion_are_teleported_with_what_they_hang_on() {
    let mut app = app();
    let post = app.world_mut().spawn(Transform::from_xyz(0.0, 1.0, 0.0)).id();
    let tied = app.world_mut().spawn((curtain(), quiet(), Attachment::pinned(post))).id();
    let pinned = app.world_mut().spawn((curtain(), quiet(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    settle(&mut app, tied);
    settle(&mut app, pinned);
    for (cloth, anchor) in [(tied, post), (pinned, pinned)] {
        let before: Vec<Vec3> = get::<Particles>(&app, cloth).positions().collect();
        let mut transform = get_mut::<Transform>(&mut app, anchor);
        let to = Transform::from_xyz(-3.0, 2.0, 1.0).with_rotation(Quat::from_rotation_y(1.0));
        let way = to.compute_affine() * transform.compute_affine().inverse();
        *transform = to;
        app.world_mut().entity_mut(cloth).insert(TeleportCloth);
        step(&mut app, 1);
        for (before, after) in before.into_iter().zip(get::<Particles>(&app, cloth).positions()) {
            assert!(way.transform_point3(before).distance(after) < 5e-3);
        }
    }
}

#[test]
fn shares_that_cannot_be_are_told_and_all_is_felt() {
    let (mut app, waggon, curtain) = on_waggon(1.0, 1.0);
    get_mut::<WorldMotion>(&mut app, curtain).linear = f32::NAN;
    get_mut::<Transform>(&mut app, waggon).translation.z = 0.3;
    step(&mut app, 2);
    let messages = refusals(&app, curtain);
    assert_eq!(messages.len(), 1);
    assert!(messages[0].contains("WorldMotion") && messages[0].contains("linear"), "{messages:?}");
    get_mut::<WorldMotion>(&mut app, curtain).linear = 0.5;
    get_mut::<Transform>(&mut app, waggon).translation.z = 0.6;
    step(&mut app, 2);
    assert!(refusals(&app, curtain).is_empty());
    assert!(get::<Particles>(&app, curtain).is_finite());
}

#[test]
fn a_transform_that_is_set_in_the_fixed_loop_is_left_alone() {
    let mut app = app();
    let thing = app.world_mut().spawn((Transform::default(), MovedByFrame)).id();
    app.add_systems(FixedUpdate, move |mut transforms: Query<&mut Transform, With<MovedByFrame>>| {
        transforms.iter_mut().for_each(|mut transform| transform.translation.x += 1.0);
    });
    frame_time(&mut app, 0.05);
    (0..10).for_each(|_| app.update());
    let steps = app.world().resource::<DrapeClock>().steps();
    assert!(steps > 20);
    assert_eq!(get::<Transform>(&app, thing).translation.x, steps as f32);
}
