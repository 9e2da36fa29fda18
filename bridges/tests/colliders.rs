//! Colliders of static and kinematic bodies as obstacles of cloth.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

#[test]
fn cloth_lies_on_every_shape_of_static_bodies() {
    assert_cloth_lies_on_every_shape(STATIC);
}

#[test]
fn cloth_lies_on_every_shape_of_kinematic_bodies() {
    assert_cloth_lies_on_every_shape(KINEMATIC);
}

fn assert_cloth_lies_on_every_shape(body: impl Bundle + Copy + core::fmt::Debug) {
    for (name, collider, top) in shapes() {
        let mut app = app();
        app.world_mut().spawn((body, collider, Transform::from_xyz(0.0, 1.0, 0.0)));
        // Whatever slips off is caught.
        ground(&mut app);
        let sheet = sheet(&mut app, 1.1 + top);
        run(&mut app, 2.0);
        let highest = greatest(&app, sheet);
        assert!((highest - 1.0 - top).abs() < 0.03, "{name}, {body:?}: it lies at {highest}");
        assert!(least(&app, sheet) > -1e-3, "{name}, {body:?}: it is below the ground");
    }
}

#[test]
fn a_door_that_swings_pushes_a_curtain() {
    let mut app = app();
    app.world_mut().spawn((
        KINEMATIC,
        cuboid(Vec3::new(1.6, 1.0, 0.1)),
        moving(Vec3::Z, Vec3::ZERO),
        Transform::from_xyz(0.0, 1.0, -0.6),
    ));
    let curtain = app
        .world_mut()
        .spawn((Cloth::new(1.0, 1.0).with_particles(17, 17), Transform::from_xyz(0.0, 1.3, 0.0)))
        .id();
    run(&mut app, 1.0);
    // The face of the door is at z = 0.45.
    let particles = app.world().get::<Particles>(curtain).expect("the curtain is built");
    let lowest = particles.positions().min_by(|a, b| a.y.total_cmp(&b.y)).expect("it has particles");
    assert!(lowest.z > 0.3, "it is pushed ahead, to {lowest}");
    for place in particles.positions().filter(|p| p.y < 1.4) {
        assert!(place.z > 0.43, "{place} is inside the door");
    }
}

#[test]
fn colliders_below_a_body_have_their_own_places_and_scales() {
    let mut app = app();
    app.world_mut().spawn((
        STATIC,
        Transform::from_xyz(0.0, 0.5, 0.0),
        children![(
            cuboid(Vec3::new(1.0, 1.0, 1.0)),
            Transform::from_xyz(0.0, 0.5, 0.0).with_scale(Vec3::new(1.0, 0.2, 1.0)),
        )],
    ));
    let sheet = sheet(&mut app, 1.3);
    run(&mut app, 3.0);
    assert!((greatest(&app, sheet) - 1.1).abs() < 0.03, "it lies at {}", greatest(&app, sheet));
}

/// How high a sheet lies above the ground after two seconds, if it fell on a slab whose top is at 1 m.
fn falls_on(prepare: impl FnOnce(&mut EntityWorldMut)) -> f32 {
    let mut app = app();
    ground(&mut app);
    let place = Transform::from_xyz(0.0, 0.9, 0.0);
    let mut slab = app.world_mut().spawn((STATIC, cuboid(Vec3::new(1.0, 0.2, 1.0)), place));
    prepare(&mut slab);
    let sheet = sheet(&mut app, 1.1);
    run(&mut app, 2.0);
    greatest(&app, sheet)
}

#[test]
fn a_collider_can_be_left_out_and_sensors_stop_nothing() {
    assert!(falls_on(|_| {}) > 0.99);
    assert!(falls_on(|slab| _ = slab.insert(NoObstacle)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(Sensor)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(ColliderDisabled)) < 0.1);
    assert!(falls_on(|slab| _ = slab.insert(layers(0, 0))) < 0.1);
}

#[test]
fn an_obstacle_comes_goes_and_changes_with_its_collider() {
    let mut app = app();
    ground(&mut app);
    let slab = app.world_mut().spawn((STATIC, Transform::from_xyz(0.0, 0.9, 0.0))).id();
    run(&mut app, 0.1);
    assert!(app.world().get::<Obstacle>(slab).is_none());

    app.world_mut().entity_mut(slab).insert(cuboid(Vec3::new(1.0, 0.2, 1.0)));
    let sheet = sheet(&mut app, 1.1);
    run(&mut app, 3.0);
    assert!((greatest(&app, sheet) - 1.0).abs() < 0.03);
    assert_eq!(app.world().get::<Activity>(sheet), Some(&Activity::Resting), "it has come to rest");

    *app.world_mut().get_mut::<Collider>(slab).expect("it has one") = cuboid(Vec3::new(1.0, 0.4, 1.0));
    run(&mut app, 1.0);
    assert!(
        (greatest(&app, sheet) - 1.1).abs() < 0.03,
        "a thicker slab lifts it to {}",
        greatest(&app, sheet)
    );

    app.world_mut().entity_mut(slab).remove::<Collider>();
    run(&mut app, 2.0);
    let slab = app.world().entity(slab);
    assert!(!slab.contains::<Obstacle>() && !slab.contains::<ColliderObstacle>());
    assert!(greatest(&app, sheet) < 0.1, "it has fallen to the ground");
}

#[test]
fn an_obstacle_of_your_own_stays() {
    let mut app = app();
    let own = Obstacle::sphere(0.3);
    let entity = app.world_mut().spawn((STATIC, cuboid(Vec3::new(1.0, 1.0, 1.0)), own)).id();
    run(&mut app, 0.1);
    let obstacle = app.world().get::<Obstacle>(entity).expect("it is there");
    assert!(matches!(obstacle.shape, ObstacleShape::Sphere { .. }));
    assert!(app.world().get::<ColliderObstacle>(entity).is_none());
}

#[test]
fn cloth_and_colliders_combine_their_friction_by_the_rule_of_the_collider() {
    // A slope of 30 degrees, whose tangent is 0.58; cloth has a friction of 0.5.
    fn slides(friction: impl Bundle) -> bool {
        let mut app = app();
        let slope = Transform::from_rotation(Quat::from_rotation_z(-30_f32.to_radians()));
        app.world_mut().spawn((STATIC, cuboid(Vec3::new(9.0, 0.2, 9.0)), friction, slope));
        let above = slope.with_translation(slope.rotation * Vec3::Y * 0.12);
        let lying = above * Transform::from_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
        let cloth = Cloth::new(0.8, 0.8).with_particles(17, 17).with_pins(ClothPins::None);
        let sheet = app.world_mut().spawn((cloth, lying, BodySurface { friction: 0.5, ..default() })).id();
        run(&mut app, 0.1);
        let before = heights(&app, sheet).sum::<f32>();
        run(&mut app, 1.5);
        (before - heights(&app, sheet).sum::<f32>()) / 289.0 > 0.1
    }
    assert!(slides(friction(0.5)) && !slides(friction(0.8)), "by the average");
    assert!(!slides(friction_by_greater(0.7)));
    assert!(slides(friction_by_product(0.9)));
    assert!(slides(friction_by_smaller(0.9)));
}
