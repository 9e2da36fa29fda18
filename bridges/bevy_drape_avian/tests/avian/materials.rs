//! Friction and restitution of colliders and bodies.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::scene::*;

#[test]
fn friction_and_restitution_are_those_of_the_collider_else_of_the_body_else_of_the_world() {
    let mut app = app();
    app.insert_resource(DefaultFriction(Friction::new(0.1)));
    let ours = |app: &App, entity| {
        let obstacle = app.world().get::<Obstacle>(entity).expect("it is an obstacle");
        (obstacle.friction, obstacle.restitution)
    };
    let collider = app.world_mut().spawn(Collider::sphere(0.5)).id();
    let body = app.world_mut().spawn((RigidBody::Static, Restitution::new(0.4))).add_child(collider).id();
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.1, 0.4));
    app.world_mut().entity_mut(body).insert(Friction::new(0.7));
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.7, 0.4));
    // Taken from the body alone: once, its colliders kept it.
    app.world_mut().entity_mut(body).remove::<Friction>();
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.1, 0.4));
    app.world_mut().entity_mut(collider).insert(Friction::new(0.9));
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.9, 0.4));
    app.insert_resource(DefaultFriction(Friction::new(0.3)));
    app.world_mut().entity_mut(collider).remove::<Friction>();
    app.world_mut().entity_mut(body).remove::<Friction>();
    run(&mut app, 0.1);
    assert_eq!(ours(&app, collider), (0.3, 0.4));
}
