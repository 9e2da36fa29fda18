//! Obstacles that are pushed back, are told of it, or are put somewhere else.

use bevy::prelude::*;
use bevy_drape::environment::{ObstacleReaction, TeleportObstacle};
use bevy_drape::prelude::*;
use drape_solver::state::measure;

use crate::common::*;

const SIDE: f32 = 0.3;

/// Momentum of a cloth and a dynamic obstacle, in kg m/s.
fn momentum(app: &App, cloth: Entity, obstacle: Entity) -> Vec3 {
    let dynamic = get::<DynamicObstacle>(app, obstacle);
    measure::momentum(get::<Particles>(app, cloth)).as_vec3() + dynamic.velocity * dynamic.mass
}

fn shot_box(velocity: Vec3) -> (Obstacle, DynamicObstacle) {
    let dynamic = DynamicObstacle::cuboid(1.0, Vec3::splat(SIDE));
    (Obstacle::cuboid(SIDE, SIDE, SIDE), DynamicObstacle { velocity, gravity_scale: 0.0, ..dynamic })
}

#[test]
fn a_box_shot_at_a_hanging_curtain_slows_down_by_what_it_is_told() {
    let mut app = app();
    let cloth = app.world_mut().spawn(curtain()).id();
    step(&mut app, 2);
    let middle = centre(&app, cloth);
    let at = Transform::from_translation(middle - Vec3::Z * 0.5);
    let shot = app.world_mut().spawn((shot_box(Vec3::Z * 5.0), at)).id();
    let still = app.world_mut().spawn(Obstacle::ground()).insert(Transform::from_xyz(0.0, -9.0, 0.0)).id();
    let mut told = Vec3::ZERO;
    for _ in 0..30 {
        step(&mut app, 1);
        told += get::<ObstacleReaction>(&app, shot).impulse;
    }
    let velocity = get::<DynamicObstacle>(&app, shot).velocity;
    assert!(velocity.z < 4.5, "{velocity}");
    assert!((velocity - Vec3::Z * 5.0 - told).length() < 1e-4, "{velocity} m/s, {told} N s");
    assert!(app.world().get::<ObstacleReaction>(still).is_none());
}

#[test]
fn a_box_and_a_free_cloth_keep_their_momentum() {
    let mut app = app();
    weightless(&mut app);
    let surface = BodySurface { drag: 0.0, ..default() };
    let cloth = app.world_mut().spawn((free_cloth(), surface)).id();
    step(&mut app, 2);
    let at = Transform::from_translation(centre(&app, cloth) + Vec3::new(0.1, 0.05, -0.4));
    let shot = app.world_mut().spawn((shot_box(Vec3::Z * 4.0), at)).id();
    let before = momentum(&app, cloth, shot);
    run(&mut app, 0.5);
    assert!(speed(&app, cloth) > 0.5, "it was hit");
    let lost = (momentum(&app, cloth, shot) - before).length() / before.length();
    assert!(lost < 1e-4, "{lost} of the momentum");
}

#[test]
fn an_obstacle_that_does_not_ask_is_told_nothing_and_one_that_stops_asking_no_more() {
    let mut app = app();
    let ground = app.world_mut().spawn((Obstacle::ground(), ObstacleReaction::default())).id();
    app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.15, 0.0)));
    step(&mut app, 5);
    let force = get::<ObstacleReaction>(&app, ground).impulse / STEP;
    let weight = Projectile::default().mass * GRAVITY;
    assert!((force.y + weight).abs() < 0.05 * weight, "{force} N");
    app.world_mut().entity_mut(ground).remove::<ObstacleReaction>();
    step(&mut app, 5);
    assert!(app.world().get::<ObstacleReaction>(ground).is_none());
}

#[test]
fn a_teleported_obstacle_gives_no_velocity() {
    for is_teleport in [true, false] {
        let mut app = app();
        weightless(&mut app);
        let cloth = app.world_mut().spawn(free_cloth()).id();
        step(&mut app, 2);
        let middle = centre(&app, cloth);
        let start = Transform::from_translation(middle - Vec3::Z);
        let obstacle = app.world_mut().spawn((Obstacle::cuboid(0.2, 0.2, 0.2), start)).id();
        step(&mut app, 2);
        let mut entity = app.world_mut().entity_mut(obstacle);
        entity.insert(Transform::from_translation(middle + Vec3::Z));
        if is_teleport {
            entity.insert(TeleportObstacle);
        }
        step(&mut app, 1);
        assert_eq!(speed(&app, cloth) < 1e-3, is_teleport, "{} m/s", speed(&app, cloth));
        assert!(app.world().get::<TeleportObstacle>(obstacle).is_none());
    }
}

#[test]
fn dynamic_obstacles_that_cannot_be() {
    let good = DynamicObstacle::sphere(1.0, 0.1);
    let bad = [
        (DynamicObstacle { mass: 0.0, ..good }, "mass"),
        (DynamicObstacle { inertia: Vec3::new(1.0, -1.0, 1.0), ..good }, "inertia"),
        (DynamicObstacle { velocity: Vec3::NAN, ..good }, "velocity"),
        (DynamicObstacle { gravity_scale: f32::INFINITY, ..good }, "gravity_scale"),
    ];
    for (dynamic, word) in bad {
        let mut app = app();
        let entity = app.world_mut().spawn((Obstacle::sphere(0.1), dynamic)).id();
        step(&mut app, 2);
        assert_eq!(get::<Transform>(&app, entity).translation, Vec3::ZERO);
        let told = refusals(&app, entity);
        assert!(told.len() == 1 && told[0].contains("DynamicObstacle") && told[0].contains(word), "{told:?}");
        *get_mut::<DynamicObstacle>(&mut app, entity) = good;
        step(&mut app, 2);
        assert!(refusals(&app, entity).is_empty());
        assert!(get::<Transform>(&app, entity).translation.y < 0.0, "it falls");
    }
}

/// One box between two cloths: all three are one island, and what one cloth does to the box the other feels.
#[test]
fn a_box_between_two_cloths_keeps_the_momentum_of_all_three() {
    let mut app = app();
    weightless(&mut app);
    let surface = BodySurface { drag: 0.0, ..default() };
    let cloths = [-0.3, 0.3].map(|z| {
        let at = Transform::from_xyz(0.0, 0.0, z);
        app.world_mut().spawn((free_cloth(), surface, at)).id()
    });
    step(&mut app, 2);
    let middle = centre(&app, cloths[0]) + Vec3::Z * 0.3;
    let at = Transform::from_translation(middle);
    let shot = app.world_mut().spawn((shot_box(Vec3::Z * 6.0), at)).id();
    for (cloth, velocity) in cloths.into_iter().zip([Vec3::Z * 8.0, Vec3::NEG_Z]) {
        let mut particles = get_mut::<Particles>(&mut app, cloth);
        (0..particles.len()).for_each(|i| particles.set_velocity(i, velocity));
    }
    let total = |app: &App| {
        momentum(app, cloths[0], shot) + measure::momentum(get::<Particles>(app, cloths[1])).as_vec3()
    };
    let before = total(&app);
    let mut both = 0;
    for _ in 0..60 {
        step(&mut app, 1);
        both += usize::from(cloths.iter().all(|&cloth| speed(&app, cloth) > 0.1));
        let lost = (total(&app) - before).length() / before.length();
        assert!(lost < 1e-4, "{lost} of the momentum");
    }
    assert!(both > 0);
    let ahead = measure::momentum(get::<Particles>(&app, cloths[1]));
    assert!(ahead.z > 0.0, "the cloth ahead was hit: {ahead} kg m/s");
}

/// A heavy ball hits a light box: the box flies off no faster than the ball came.
#[test]
fn a_heavy_ball_pushes_a_light_box_ahead() {
    let mut app = app();
    weightless(&mut app);
    let dynamic = DynamicObstacle { gravity_scale: 0.0, ..DynamicObstacle::cuboid(0.05, Vec3::splat(SIDE)) };
    let shot = app.world_mut().spawn((Obstacle::cuboid(SIDE, SIDE, SIDE), dynamic)).id();
    let ball = Projectile { mass: 5.0, radius: 0.1, velocity: Vec3::X * 10.0, drag: 0.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(-1.0, 0.0, 0.0)));
    run(&mut app, 0.3);
    let velocity = get::<DynamicObstacle>(&app, shot).velocity;
    assert!((velocity.x / (10.0 * 5.0 / 5.05) - 1.0).abs() < 0.05, "{velocity} m/s");
    assert!(get::<Transform>(&app, shot).translation.x > 1.0);
}

/// An obstacle that is no longer dynamic stays where it is.
#[test]
fn an_obstacle_that_is_no_longer_dynamic_stays() {
    let mut app = app();
    let at = Transform::from_xyz(0.0, 5.0, 0.0);
    let obstacle = app.world_mut().spawn((Obstacle::sphere(0.2), DynamicObstacle::sphere(1.0, 0.2), at)).id();
    app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.1, 5.3, 0.0)));
    run(&mut app, 0.2);
    app.world_mut().entity_mut(obstacle).remove::<DynamicObstacle>();
    let before = *get::<Transform>(&app, obstacle);
    assert!(before.translation.y < 4.9);
    run(&mut app, 0.5);
    assert_eq!(*get::<Transform>(&app, obstacle), before);
}

/// Locked axes held against contacts alone: gravity moved the box along them.
#[test]
fn a_box_does_not_fall_along_a_locked_axis() {
    let mut app = app();
    let dynamic = DynamicObstacle {
        locked_translation: [false, true, false],
        velocity: Vec3::X,
        ..DynamicObstacle::cuboid(1.0, Vec3::splat(SIDE))
    };
    let slider = app.world_mut().spawn((Obstacle::cuboid(SIDE, SIDE, SIDE), dynamic)).id();
    run(&mut app, 0.5);
    let place = get::<Transform>(&app, slider).translation;
    assert!(place.y == 0.0 && (place.x - 0.5).abs() < 0.03, "{place}");
}
