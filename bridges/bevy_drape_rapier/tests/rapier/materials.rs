//! Scales and surfaces of colliders.

use bevy::prelude::*;
use bevy_drape::environment::CombineRule;
use bevy_drape::prelude::*;
use bevy_rapier3d::prelude::{
    CoefficientCombineRule, Collider, ColliderScale, Friction, Restitution, RigidBody,
};

use crate::scene::*;

#[test]
fn a_collider_scale_counts_with_the_scale_of_the_transform_or_instead_of_it() {
    for (scale, top) in [
        (ColliderScale::Relative(Vec3::new(1.0, 0.5, 1.0)), 0.5),
        (ColliderScale::Absolute(Vec3::new(1.0, 0.5, 1.0)), 0.25),
    ] {
        let mut app = app();
        let double = Transform::from_scale(Vec3::splat(2.0));
        app.world_mut().spawn((RigidBody::Fixed, Collider::cuboid(0.5, 0.5, 0.5), scale, double));
        let sheet = sheet(&mut app, 0.8);
        run(&mut app, 3.0);
        let highest = greatest(&app, sheet);
        assert!((highest - top).abs() < 0.03, "{scale:?}: it lies at {highest}");
    }
}

#[test]
fn friction_and_restitution_are_those_of_the_collider() {
    let mut app = app();
    let friction = Friction { coefficient: 0.7, combine_rule: CoefficientCombineRule::ClampedSum };
    let collider = app.world_mut().spawn((Collider::ball(0.5), friction, Transform::default())).id();
    run(&mut app, 0.1);
    let obstacle = app.world().get::<Obstacle>(collider).expect("it is an obstacle");
    assert_eq!((obstacle.friction, obstacle.friction_rule), (0.7, CombineRule::ClampedSum));
    assert_eq!((obstacle.restitution, obstacle.restitution_rule), (0.0, CombineRule::Average));
    app.world_mut().entity_mut(collider).insert(Restitution::new(0.4)).remove::<Friction>();
    run(&mut app, 0.1);
    let obstacle = app.world().get::<Obstacle>(collider).expect("it is an obstacle");
    assert_eq!((obstacle.friction, obstacle.restitution), (0.5, 0.4));
}
