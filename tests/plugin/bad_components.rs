//! Components that cannot be used are refused with one clear message, and all the rest runs on.

use bevy::prelude::*;
use bevy_drape::body::{BendingFriction, MembraneStiffness, Sticks};
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::prelude::*;
use drape_solver::parry3d::math::Pose;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{BuildError, Shape};

use crate::common::*;

#[test]
fn cloths_that_cannot_be() {
    let with = |edit: fn(&mut Cloth)| {
        let mut cloth = curtain();
        edit(&mut cloth);
        cloth
    };
    let bad = [
        (with(|c| c.size.x = f32::NAN), "width"),
        (with(|c| c.size.y = f32::INFINITY), "height"),
        (with(|c| c.size.x = 0.0), "width"),
        (with(|c| c.size.y = -1.0), "height"),
        (with(|c| c.particles = UVec2::ZERO), "particles"),
        (with(|c| c.particles = UVec2::ONE), "particles"),
        (with(|c| c.particles = UVec2::new(1, 9)), "particles"),
        (with(|c| c.particles = UVec2::MAX), "particles"),
        (with(|c| c.pins = ClothPins::Indices(vec![81])), "pin"),
    ];
    for (cloth, word) in bad {
        let (mut app, entity) = assert_refused(cloth, &["Cloth", word]);
        assert!(app.world().get::<Particles>(entity).is_none());
        *get_mut::<Cloth>(&mut app, entity) = curtain();
        assert_mended(&mut app, entity);
        assert!(refusals(&app, entity).is_empty());
    }
}

#[test]
fn fabrics_out_of_range() {
    let bad = [
        (Fabric { areal_density: -1.0, ..default() }, "density"),
        (Fabric { areal_density: 0.0, ..default() }, "density"),
        (Fabric { areal_density: f32::NAN, ..default() }, "density"),
        (Fabric { stretch_stiffness: 1.5, ..default() }, "stiffness"),
        (Fabric { bend_stiffness: f32::NAN, ..default() }, "stiffness"),
        (Fabric { bending_rigidity: BendingRigidity::isotropic(-1.0), ..default() }, "bending_rigidity"),
        (Fabric { bending_rigidity: BendingRigidity::isotropic(f32::NAN), ..default() }, "bending_rigidity"),
        (Fabric { bending_friction: BendingFriction::isotropic(-1.0), ..default() }, "bending_friction"),
        (
            Fabric { membrane_stiffness: MembraneStiffness::balanced(-1.0, 0.0), ..default() },
            "membrane_stiffness",
        ),
        (Fabric { damping: -1.0, ..default() }, "damping"),
        (Fabric { drag: -1.0, ..default() }, "drag"),
        (Fabric { thickness: f32::NAN, ..default() }, "thickness"),
    ];
    for (fabric, word) in bad {
        let (mut app, entity) = assert_refused((free_cloth(), fabric), &["Fabric", word]);
        *get_mut::<Fabric>(&mut app, entity) = default();
        assert_mended(&mut app, entity);
        assert!(refusals(&app, entity).is_empty());
    }
}

#[test]
fn a_cloth_that_is_spoilt_later_is_taken_out() {
    let mut app = app();
    let cloth = app.world_mut().spawn(curtain()).id();
    step(&mut app, 5);
    get_mut::<Fabric>(&mut app, cloth).areal_density = -2.0;
    step(&mut app, 5);
    assert!(app.world().get::<Particles>(cloth).is_none());
    assert_eq!(counts(&app), (0, 0, 0));
    assert_eq!(refusals(&app, cloth).len(), 1);
    // A second fault is told, too.
    get_mut::<Fabric>(&mut app, cloth).areal_density = 0.2;
    get_mut::<Cloth>(&mut app, cloth).size.x = -1.0;
    step(&mut app, 5);
    assert!(refusals(&app, cloth)[0].contains("width"), "{:?}", refusals(&app, cloth));
    app.world_mut().entity_mut(cloth).despawn();
    step(&mut app, 1);
    assert!(app.world().resource::<Refusals>().is_empty(), "who is gone is forgotten");
}

#[test]
fn ropes_that_cannot_be() {
    let good = Rope::default();
    let bad = [
        (Rope { particles: 1, ..good.clone() }, "particles"),
        (Rope { particles: 0, ..good.clone() }, "particles"),
        (Rope { linear_density: 0.0, ..good.clone() }, "density"),
        (Rope { linear_density: f32::NAN, ..good.clone() }, "density"),
        (Rope { end: Vec3::NAN, ..good.clone() }, "end"),
        (Rope { start: Vec3::splat(f32::INFINITY), ..good.clone() }, "start"),
        (Rope { end: good.start, ..good.clone() }, ""),
        (Rope { stretch_stiffness: -0.1, ..good.clone() }, "stiffness"),
    ];
    for (rope, word) in bad {
        let (mut app, entity) = assert_refused(rope, &["Rope", word]);
        *get_mut::<Rope>(&mut app, entity) = Rope { start: Vec3::X, pin_start: false, ..Rope::default() };
        assert_mended(&mut app, entity);
    }
}

#[test]
fn balls_that_cannot_be() {
    let good = Projectile::default();
    let bad = [
        (Projectile { radius: 0.0, ..good }, "radius"),
        (Projectile { radius: f32::NAN, ..good }, "radius"),
        (Projectile { mass: 0.0, ..good }, "mass"),
        (Projectile { mass: -1.0, ..good }, "mass"),
        (Projectile { mass: f32::INFINITY, ..good }, "mass"),
        (Projectile { velocity: Vec3::NAN, ..good }, "velocity"),
        (Projectile { drag: -1.0, ..good }, "drag"),
        (Projectile { friction: f32::NAN, ..good }, "friction"),
        (Projectile { static_friction: -1.0, ..good }, "static_friction"),
        (Projectile { restitution: 1.5, ..good }, "restitution"),
    ];
    for (ball, word) in bad {
        let (mut app, entity) = assert_refused(ball, &["Projectile", word]);
        *get_mut::<Projectile>(&mut app, entity) = good;
        assert_mended(&mut app, entity);
        assert!(refusals(&app, entity).is_empty());
    }
}

#[test]
fn obstacles_that_cannot_be() {
    let ground = Obstacle::ground();
    let bad = [
        (Obstacle::sphere(0.0), "radius"),
        (Obstacle::sphere(f32::NAN), "radius"),
        (Obstacle::cuboid(1.0, -1.0, 1.0), "size"),
        (Obstacle::cylinder(0.1, 0.0), "height"),
        (Obstacle::cone(f32::INFINITY, 1.0), "radius"),
        (Obstacle::capsule(-0.1, 1.0), "radius"),
        (Obstacle::tapered_capsule(0.1, 0.0, 1.0), "top_radius"),
        (ground.clone().with_friction(-1.0), "friction"),
        (ground.clone().with_friction(f32::NAN), "friction"),
        (ground.clone().with_static_friction(-1.0), "static_friction"),
        (ground.clone().with_restitution(1.5), "restitution"),
    ];
    for (obstacle, word) in bad {
        let (mut app, entity) = assert_refused(obstacle, &["Obstacle", word]);
        *get_mut::<Obstacle>(&mut app, entity) = ground.clone();
        let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 1.0, 0.0))).id();
        run(&mut app, 1.0);
        assert!((ball_position(&app, ball).y - 0.15).abs() < 0.01, "the mended ground holds the ball");
        assert!(refusals(&app, entity).is_empty());
    }
}

/// A shape and the scale of its transform must leave something that has an inside, or a surface: if not, that obstacle is
/// left out by name, and a ball beside it still lands on the ground.
#[test]
fn shapes_that_cannot_be() {
    let flat = vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
    let parry = |shape: SharedShape| Obstacle::new(Shape::Parry(shape));
    let line = SharedShape::trimesh(flat, vec![[0, 1, 2]]).expect("parry takes it");
    let here = Transform::from_xyz(0.0, 1.0, 0.0);
    let bad = [
        (parry(line), here, "Obstacle"),
        (parry(SharedShape::ball(0.0)), here, "Obstacle"),
        (parry(SharedShape::cuboid(0.1, f32::NAN, 0.1)), here, "Obstacle"),
        (parry(SharedShape::voxels(Vec3::ONE, &[])), here, "Obstacle"),
        (parry(SharedShape::compound(vec![(Pose::IDENTITY, SharedShape::ball(-1.0))])), here, "Obstacle"),
        (Obstacle::sphere(0.5), here.with_scale(Vec3::new(-1.0, 1.0, 1.0)), "scale"),
        (Obstacle::sphere(0.5), here.with_scale(Vec3::ZERO), "scale"),
        (parry(SharedShape::cone(0.5, 0.5)), here.with_scale(Vec3::new(1.0, 0.0, 1.0)), "scale"),
    ];
    for (index, (obstacle, transform, word)) in bad.into_iter().enumerate() {
        let (mut app, entity) = assert_refused((obstacle, transform), &[word]);
        app.world_mut().spawn(Obstacle::ground());
        let beside = Transform::from_xyz(3.0, 1.0, 0.0);
        let ball = app.world_mut().spawn((Projectile::default(), beside)).id();
        run(&mut app, 1.0);
        assert!((ball_position(&app, ball).y - 0.15).abs() < 0.01, "case {index}: the rest runs on");
        *get_mut::<Obstacle>(&mut app, entity) = Obstacle::sphere(0.5);
        *get_mut::<Transform>(&mut app, entity) = here;
        step(&mut app, 2);
        assert!(refusals(&app, entity).is_empty(), "case {index}");
    }
}

#[test]
fn transforms_that_are_not_finite() {
    for bad in BAD {
        let nowhere = Transform::from_xyz(0.0, bad, 0.0);
        let here = Transform::from_xyz(0.0, 1.0, 0.0);
        for turned in [nowhere, here.with_scale(Vec3::splat(bad))] {
            let (mut app, entity) = assert_refused((free_cloth(), turned), &["Transform", "finite"]);
            *get_mut::<Transform>(&mut app, entity) = here;
            assert_mended(&mut app, entity);

            let (mut app, entity) = assert_refused((Rope::default(), turned), &["Transform", "finite"]);
            *get_mut::<Transform>(&mut app, entity) = here.with_rotation(Quat::from_rotation_z(1.0));
            assert_mended(&mut app, entity);

            let (mut app, entity) = assert_refused((Projectile::default(), turned), &["Transform", "finite"]);
            *get_mut::<Transform>(&mut app, entity) = here;
            assert_mended(&mut app, entity);

            let (mut app, entity) = assert_refused((Obstacle::ground(), turned), &["Transform", "finite"]);
            *get_mut::<Transform>(&mut app, entity) = here;
            let ball =
                app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
            run(&mut app, 1.0);
            assert!((ball_position(&app, ball).y - 1.15).abs() < 0.01, "the mended ground holds the ball");
        }
    }
}

#[test]
fn transforms_that_stop_to_be_finite() {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    let ground = app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -1.0, 0.0))).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(3.0, 0.0, 0.0))).id();
    step(&mut app, 5);
    let height = ball_position(&app, ball).y;
    for entity in [curtain, ground, ball] {
        get_mut::<Transform>(&mut app, entity).translation.y = f32::NAN;
    }
    run(&mut app, 3.0);
    for entity in [curtain, ground, ball] {
        let messages = refusals(&app, entity);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].contains("Transform"), "{messages:?}");
    }
    assert!(
        height < 0.0 && (ball_position(&app, ball).y + 0.85).abs() < 0.01,
        "the ball fell on to the ground"
    );
    assert!(get::<Particles>(&app, curtain).position(0).distance(Vec3::new(-0.5, 0.5, 0.0)) < 1e-6);
    assert!(get::<Transform>(&app, ball).is_finite());

    get_mut::<Transform>(&mut app, curtain).translation = Vec3::new(0.1, 0.0, 0.0);
    get_mut::<Transform>(&mut app, ground).translation = Vec3::new(0.0, -1.1, 0.0);
    run(&mut app, 1.0);
    assert!(get::<Particles>(&app, curtain).position(0).distance(Vec3::new(-0.4, 0.5, 0.0)) < 1e-6);
    assert!((ball_position(&app, ball).y + 0.95).abs() < 0.01);
}

#[test]
fn cannons_that_cannot_fire() {
    let good = Cannon::default();
    let bad_ball = Projectile { radius: -1.0, ..default() };
    let bad = [
        (Cannon { elevation: f32::NAN, ..good }, Transform::IDENTITY, "Cannon"),
        (Cannon { muzzle_speed: f32::INFINITY, ..good }, Transform::IDENTITY, "muzzle speed"),
        (Cannon { barrel_length: f32::NAN, ..good }, Transform::IDENTITY, "barrel length"),
        (Cannon { muzzle_speed: 1e20, ..good }, Transform::IDENTITY, "velocity"),
        (Cannon { ball: bad_ball, ..good }, Transform::IDENTITY, "radius"),
        (good, Transform::from_xyz(f32::NAN, 0.0, 0.0), "Transform"),
    ];
    for (cannon, transform, word) in bad {
        let mut app = app();
        let entity = app.world_mut().spawn((cannon, transform)).id();
        for _ in 0..5 {
            app.world_mut().write_message(FireCannon { cannon: entity });
            step(&mut app, 2);
        }
        let messages = refusals(&app, entity);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].contains(word) && messages[0].contains(&entity.to_string()), "{messages:?}");
        assert_eq!(counts(&app), (0, 0, 0));
        assert!(app.world().resource::<Shots>().0.is_empty());
        app.world_mut().entity_mut(entity).insert((good, Transform::IDENTITY));
        app.world_mut().write_message(FireCannon { cannon: entity });
        step(&mut app, 2);
        assert_eq!(counts(&app), (1, 0, 0));
    }
    let mut app = app();
    let no_cannon = app.world_mut().spawn_empty().id();
    app.world_mut().write_message(FireCannon { cannon: no_cannon });
    step(&mut app, 3);
    assert_eq!(counts(&app), (0, 0, 0));
}

#[test]
fn particles_and_sticks_that_do_not_belong_together() {
    let mut app = app();
    let (long, _) = Rope::default().build(&GlobalTransform::IDENTITY).expect("a rope");
    let (_, short) = Rope { particles: 4, ..default() }.build(&GlobalTransform::IDENTITY).expect("a rope");
    let mismatch = app.world_mut().spawn((Particles(long.clone()), Sticks(short))).id();
    let empty = app.world_mut().spawn((Particles::default(), Sticks::default())).id();
    let alone = app.world_mut().spawn(Particles(long)).id();
    let witness = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(9.0, 0.0, 0.0))).id();
    run(&mut app, 0.5);
    assert!(refusals(&app, mismatch)[0].contains("32") && refusals(&app, mismatch)[0].contains('4'));
    assert_eq!(refusals(&app, empty).len(), 1);
    assert!(refusals(&app, alone).is_empty(), "it is no body yet");
    assert!(ball_position(&app, witness).y < -1.0);
}

#[test]
fn a_refusal_has_its_entity_its_component_and_a_typed_error() {
    let (app, entity) =
        assert_refused((curtain(), Fabric { areal_density: -1.0, ..default() }), &["areal_density"]);
    let refusals: Vec<_> = app.world().resource::<Refusals>().of(entity).collect();
    assert_eq!((refusals[0].entity, refusals[0].component), (Some(entity), "Fabric"));
    let error = refusals[0].error().downcast_ref::<BuildError>();
    assert!(matches!(error, Some(BuildError::NotPositive { value: -1.0, .. })), "{error:?}");
}
