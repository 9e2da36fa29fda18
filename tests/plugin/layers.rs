//! Layers tell who touches whom.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;

use crate::common::*;

const MINE: DrapeLayers = DrapeLayers::new(1, 1);
const THEIRS: DrapeLayers = DrapeLayers::new(2, 2);

fn ball(at: Vec3, velocity: Vec3, layers: DrapeLayers) -> (Projectile, Transform, DrapeLayers) {
    (Projectile { velocity, ..default() }, Transform::from_translation(at), layers)
}

#[test]
fn each_pair_passes_if_the_layers_say_so() {
    for (other, is_stopped) in [(MINE, true), (THEIRS, false), (DrapeLayers::default(), true)] {
        let mut app = app();
        weightless(&mut app);
        app.world_mut().spawn((Obstacle::cuboid(0.2, 2.0, 2.0), Transform::from_xyz(1.0, 0.0, 0.0), other));
        let at_wall = app.world_mut().spawn(ball(Vec3::ZERO, Vec3::X * 3.0, MINE)).id();
        let at_ball = app.world_mut().spawn(ball(Vec3::Y * 9.0, Vec3::X * 3.0, MINE)).id();
        app.world_mut().spawn(ball(Vec3::new(1.0, 9.0, 0.0), Vec3::ZERO, other));
        let place = Transform::from_xyz(1.0, 20.0, 0.0)
            .with_rotation(Quat::from_rotation_y(core::f32::consts::FRAC_PI_2));
        let cloth = app.world_mut().spawn((free_cloth(), place, other)).id();
        step(&mut app, 1);
        let at = centre(&app, cloth).with_x(0.0);
        let at_cloth = app.world_mut().spawn(ball(at, Vec3::X * 3.0, MINE)).id();
        run(&mut app, 1.0);
        let speed = |ball: Entity| get::<ProjectileState>(&app, ball).velocity().x;
        for (ball, other) in [(at_wall, "obstacle"), (at_ball, "ball"), (at_cloth, "cloth")] {
            assert_eq!(speed(ball) < 2.99, is_stopped, "ball and {other}: {} m/s", speed(ball));
        }
    }
}

#[test]
fn a_sleeper_falls_when_layers_part_it_from_the_ground() {
    for change in [0, 1, 2] {
        let mut app = app();
        let ground = app.world_mut().spawn((Obstacle::ground(), THEIRS)).id();
        let cloth = (free_cloth(), quiet(), Transform::from_xyz(0.0, 0.6, 0.0), DrapeLayers::default());
        let cloth = app.world_mut().spawn(cloth).id();
        let ball = app.world_mut().spawn(ball(Vec3::new(5.0, 0.2, 0.0), Vec3::ZERO, THEIRS)).id();
        settle(&mut app, cloth);
        settle(&mut app, ball);
        assert!(centre(&app, cloth).y > -0.1);
        match change {
            0 => *get_mut::<DrapeLayers>(&mut app, ground) = MINE,
            1 => {
                *get_mut::<DrapeLayers>(&mut app, cloth) = MINE;
                *get_mut::<DrapeLayers>(&mut app, ball) = MINE;
            }
            _ => {
                // The default meets nobody who belongs to no layer.
                *get_mut::<DrapeLayers>(&mut app, ground) = DrapeLayers::new(0, 2);
            }
        }
        run(&mut app, 1.0);
        if change == 0 {
            assert!(centre(&app, cloth).y > -0.1, "the cloth touches all layers");
        } else {
            assert!(centre(&app, cloth).y < -1.0);
        }
        assert!(ball_position(&app, ball).y < -1.0);
    }
}

#[test]
fn a_sleeper_is_not_woken_by_what_it_cannot_touch() {
    for (layers, wakes) in [(MINE, true), (THEIRS, false)] {
        let mut app = app();
        let at = Transform::from_xyz(0.0, 2.0, 0.0);
        let cloth = app.world_mut().spawn((curtain(), quiet(), at, MINE)).id();
        settle(&mut app, cloth);
        let (low, high) = get::<Particles>(&app, cloth).bounds();
        let beside = (low + high) * 0.5 + Vec3::Z * 0.25;
        let wall = Transform::from_translation(beside);
        app.world_mut().spawn((Obstacle::cuboid(0.1, 0.1, 0.498), wall, layers));
        step(&mut app, 1);
        assert_eq!(activity(&app, cloth) == Activity::Active, wakes, "by an obstacle that appears");
        settle(&mut app, cloth);
        app.world_mut().spawn(ball(beside + Vec3::new(0.0, 0.4, -0.08), Vec3::ZERO, layers));
        step(&mut app, 2);
        assert_eq!(activity(&app, cloth) == Activity::Active, wakes, "by a ball that falls past");
    }
}

#[test]
fn without_layers_all_touch_all() {
    let mut app = app();
    let ground = app.world_mut().spawn((Obstacle::ground(), MINE)).id();
    let ball = app.world_mut().spawn(ball(Vec3::Y * 0.5, Vec3::ZERO, THEIRS)).id();
    app.world_mut().entity_mut(ball).remove::<DrapeLayers>();
    run(&mut app, 1.0);
    assert!(ball_position(&app, ball).y > 0.1, "without layers it meets those of MINE");
    app.world_mut().entity_mut(ball).insert(THEIRS);
    run(&mut app, 0.5);
    assert!(ball_position(&app, ball).y < 0.0, "layers that are given later count");
    // Back up, and the ground lays down its layers.
    get_mut::<ProjectileState>(&mut app, ball).set_position(Vec3::Y * 0.5);
    get_mut::<ProjectileState>(&mut app, ball).set_velocity(Vec3::ZERO);
    app.world_mut().entity_mut(ground).remove::<DrapeLayers>();
    run(&mut app, 1.0);
    assert!(ball_position(&app, ball).y > 0.1, "without layers the ground meets THEIRS");
}
