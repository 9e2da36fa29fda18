//! When meshes are written, and when not.

use bevy::asset::AssetEvent;
use bevy::ecs::message::Messages;
use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::viewer::Viewer;

use crate::*;

/// Whether a mesh was written since the last call.
fn was_written(app: &mut App) -> bool {
    let mut messages = app.world_mut().resource_mut::<Messages<AssetEvent<Mesh>>>();
    messages.drain().any(|event| matches!(event, AssetEvent::Modified { .. }))
}

/// A curtain in honey: still within a few seconds.
fn damped() -> (Cloth, BodySurface) {
    (Cloth::new(1.0, 1.0).with_particles(8, 8), BodySurface { drag: 10.0, ..default() })
}

fn until_resting(app: &mut App, cloth: Entity) {
    for _ in 0..64 * 30 {
        frame(app, 1.0);
        if app.world().get::<Activity>(cloth) == Some(&Activity::Resting) {
            return;
        }
    }
    panic!("the curtain does not come to rest");
}

#[test]
fn a_moving_cloth_is_written_in_every_frame_that_shows_it_moved_and_not_later() {
    let mut app = app();
    app.world_mut().spawn(swinging());
    start(&mut app);
    frame(&mut app, 2.0);
    frame(&mut app, 0.0);
    was_written(&mut app);
    for _ in 0..10 {
        frame(&mut app, 0.4);
        assert!(was_written(&mut app));
        frame(&mut app, 0.0);
        assert!(!was_written(&mut app), "no time has passed");
    }
}

#[test]
fn a_cloth_that_fell_asleep_is_written_once_more_and_then_not_at_all() {
    let mut app = app();
    let cloth = app.world_mut().spawn(damped()).id();
    start(&mut app);
    until_resting(&mut app, cloth);
    frame(&mut app, 1.0);
    assert_eq!(vertices(&app, cloth), particles(&app, cloth), "the mesh shows the place of rest");
    was_written(&mut app);
    for _ in 0..40 {
        frame(&mut app, 0.7);
        assert!(!was_written(&mut app));
    }
}

#[test]
fn a_cloth_that_wakes_is_written_again() {
    let mut app = app();
    let cloth = app.world_mut().spawn(damped()).id();
    start(&mut app);
    until_resting(&mut app, cloth);
    frame(&mut app, 1.0);
    let rest = vertices(&app, cloth);
    app.world_mut().get_mut::<Particles>(cloth).expect("built").apply_impulse(63, Vec3::Z * 0.01);
    frame(&mut app, 1.0);
    frame(&mut app, 1.0);
    assert!(was_written(&mut app));
    assert_ne!(vertices(&app, cloth), rest);
}

#[test]
fn an_entity_that_moves_under_a_resting_free_cloth_leaves_it_where_it_is() {
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let free = Cloth::new(1.0, 1.0).with_particles(4, 4).with_pins(ClothPins::None);
    let cloth = app.world_mut().spawn(free).id();
    start(&mut app);
    until_resting(&mut app, cloth);
    let seen = world_vertices(&app, cloth);
    app.world_mut().get_mut::<Transform>(cloth).expect("spawned").translation = Vec3::new(3.0, 0.0, 0.0);
    frame(&mut app, 1.0);
    assert!(farthest(&world_vertices(&app, cloth), &seen) < 1e-6);
}

#[test]
fn a_paused_cloth_comes_to_the_last_step_and_is_then_not_written() {
    let mut app = app();
    let cloth = app.world_mut().spawn(swinging()).id();
    start(&mut app);
    for _ in 0..20 {
        frame(&mut app, 1.1);
    }
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    frame(&mut app, 1.0);
    assert_eq!(vertices(&app, cloth), particles(&app, cloth));
    was_written(&mut app);
    for _ in 0..20 {
        frame(&mut app, 0.3);
        assert!(!was_written(&mut app));
    }
    app.world_mut().resource_mut::<DrapeClock>().step_once();
    frame(&mut app, 1.0);
    frame(&mut app, 1.0);
    assert_eq!(vertices(&app, cloth), particles(&app, cloth), "a single step is shown");
    assert!(was_written(&mut app));
}

#[test]
fn buffers_are_written_in_place() {
    let mut app = app();
    let cloth = app.world_mut().spawn(swinging()).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let buffers = |app: &App| {
        [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL].map(|attribute| {
            let buffer = vectors(app, cloth, attribute);
            (buffer.as_ptr(), buffer.capacity())
        })
    };
    let (first, shape) = (buffers(&app), vertices(&app, cloth));
    for _ in 0..60 {
        frame(&mut app, 0.7);
        assert_eq!(buffers(&app), first);
    }
    assert_ne!(vertices(&app, cloth), shape);
}

#[test]
fn what_is_culled_is_hidden_and_comes_back_as_it_was() {
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let place = |visibility| (Cloth::new(1.0, 1.0).with_particles(4, 4), visibility);
    let cloths = [Visibility::Inherited, Visibility::Visible, Visibility::Hidden]
        .map(|visibility| app.world_mut().spawn(place(visibility)).id());
    let viewer = app.world_mut().spawn(Viewer).id();
    start(&mut app);
    until_resting(&mut app, cloths[0]);
    let seen = |app: &App| cloths.map(|cloth| *app.world().get::<Visibility>(cloth).expect("drawn"));
    let move_viewer = |app: &mut App, x: f32| {
        app.world_mut().get_mut::<Transform>(viewer).expect("spawned").translation.x = x;
        frame(app, 1.0);
        frame(app, 1.0);
    };
    move_viewer(&mut app, 1000.0);
    assert_eq!(seen(&app), [Visibility::Hidden; 3]);
    move_viewer(&mut app, 0.0);
    assert_eq!(seen(&app), [Visibility::Inherited, Visibility::Visible, Visibility::Hidden]);
}

#[test]
fn a_state_that_is_not_finite_is_not_shown() {
    let mut app = app();
    let cloth = app.world_mut().spawn(swinging()).id();
    start(&mut app);
    frame(&mut app, 1.0);
    app.world_mut().get_mut::<Particles>(cloth).expect("built").set_velocity(40, Vec3::splat(f32::NAN));
    app.world_mut().get_mut::<Particles>(cloth).expect("built").set_position(41, Vec3::splat(f32::NAN));
    for _ in 0..3 {
        frame(&mut app, 0.7);
        assert!(vertices(&app, cloth).iter().all(|vertex| vertex.is_finite()));
    }
}
