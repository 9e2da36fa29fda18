//! Where the vertices are.

use bevy::camera::primitives::Aabb;
use bevy::prelude::*;
use bevy_drape::sleep::SceneManager;

use crate::*;

/// Positions of the particles before and after the last of some steps, and the app at the end of it.
fn swung(transform: Transform) -> (App, Entity, [Vec<Vec3>; 2]) {
    let mut app = app();
    let (play_area_min, play_area_max) = (Vec3::splat(-1e5), Vec3::splat(1e5));
    app.insert_resource(SceneManager { play_area_min, play_area_max, ..default() });
    let cloth = app.world_mut().spawn((swinging(), transform)).id();
    start(&mut app);
    for _ in 0..20 {
        frame(&mut app, 1.0);
    }
    let before = particles(&app, cloth);
    frame(&mut app, 1.0);
    let after = particles(&app, cloth);
    assert!(farthest(&before, &after) > 0.005, "the cloth moves");
    (app, cloth, [before, after])
}

#[test]
fn right_after_a_step_the_state_before_it_is_shown() {
    let (app, cloth, [before, _]) = swung(Transform::IDENTITY);
    assert_eq!(vertices(&app, cloth), before, "an entity that is not moved at all has exact copies");
}

#[test]
fn half_a_step_later_the_middle_is_shown() {
    let (mut app, cloth, [before, after]) = swung(Transform::from_xyz(0.3, 2.0, -1.0));
    frame(&mut app, 0.5);
    let middle: Vec<Vec3> = before.iter().zip(&after).map(|(a, b)| a.midpoint(*b)).collect();
    assert!(farthest(&world_vertices(&app, cloth), &middle) < 1e-6);
}

#[test]
fn motion_is_even_at_any_frame_rate() {
    // At 2.5 frames a step the free upper corner must not stand still or jump.
    let (mut app, cloth, _) = swung(Transform::IDENTITY);
    let corner = |app: &App| world_vertices(app, cloth)[8];
    let mut last = corner(&app);
    let mut ways = Vec::new();
    for _ in 0..20 {
        frame(&mut app, 0.4);
        ways.push(corner(&app).distance(last));
        last = corner(&app);
    }
    for pair in ways.windows(2) {
        assert!((pair[0] / pair[1] - 1.0).abs() < 0.35, "uneven ways from frame to frame: {ways:?}");
    }
}

#[test]
fn outside_the_fixed_loop_the_last_step_is_shown() {
    let mut app = app_in(Update);
    let cloth = app.world_mut().spawn(swinging()).id();
    start(&mut app);
    for _ in 0..10 {
        frame(&mut app, 0.7);
        assert_eq!(
            app.world().get::<Mesh3d>(cloth).map(|_| vertices(&app, cloth)),
            Some(particles(&app, cloth))
        );
    }
}

#[test]
fn a_cloth_under_a_turned_and_scaled_parent_is_seen_where_its_particles_are() {
    let mut app = app();
    let parent = Transform::from_xyz(5.0, -3.0, 2.0)
        .with_rotation(Quat::from_euler(EulerRot::YXZ, 1.0, 0.4, -0.2))
        .with_scale(Vec3::splat(2.0));
    let child = Transform::from_xyz(0.5, 1.0, 0.0).with_rotation(Quat::from_rotation_x(-0.7));
    let parent = app.world_mut().spawn(parent).id();
    let cloth = app.world_mut().spawn((swinging(), child, ChildOf(parent))).id();
    start(&mut app);
    for step in 0..20 {
        // The parent turns on, and its pins with it.
        let mut transform = app.world_mut().get_mut::<Transform>(parent).expect("spawned");
        transform.rotate_y(0.01 * step as f32);
        frame(&mut app, 1.0);
    }
    let before = particles(&app, cloth);
    frame(&mut app, 1.0);
    assert!(farthest(&world_vertices(&app, cloth), &before) < 1e-5);
    for _ in 0..50 {
        frame(&mut app, 0.37);
        assert_bounds_hold(&app, cloth);
    }
}

fn assert_bounds_hold(app: &App, cloth: Entity) {
    let bounds = app.world().get::<Aabb>(cloth).expect("bounds");
    let (low, high) = (Vec3::from(bounds.min()), Vec3::from(bounds.max()));
    for vertex in vertices(app, cloth) {
        assert!(vertex.cmpge(low).all() && vertex.cmple(high).all(), "{vertex} is outside {low}..{high}");
    }
}

#[test]
fn bounds_hold_all_vertices_of_both_steps_and_no_more() {
    let (mut app, cloth, [before, after]) = swung(Transform::IDENTITY);
    for _ in 0..4 {
        assert_bounds_hold(&app, cloth);
        let bounds = app.world().get::<Aabb>(cloth).expect("bounds");
        let all = Aabb::enclosing(before.iter().chain(&after)).expect("not empty");
        assert!((bounds.center - all.center).abs().max_element() < 1e-5);
        assert!((bounds.half_extents - all.half_extents).abs().max_element() < 1e-5);
        frame(&mut app, 0.24);
    }
}

#[test]
fn far_from_the_origin_vertices_are_as_fine_as_near_it() {
    // There a number in the world is half a millimetre off; a vertex next to its entity need not be.
    let place = Vec3::new(8192.0, 0.0, -8192.0);
    let (_, _, [_, near]) = swung(Transform::IDENTITY);
    let (mut app, cloth, _) = swung(Transform::from_translation(place));
    frame(&mut app, 0.999_999);
    assert!(farthest(&vertices(&app, cloth), &near) < 1e-4);
}
