//! The result does not depend on other apps, entity ids or other islands.

use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::common::*;

/// A curtain, a ball that hits it, a rope and a sphere, in this order.
fn scene(app: &mut App) -> Vec<Entity> {
    let world = app.world_mut();
    world.spawn(Obstacle::ground());
    world.spawn((Obstacle::sphere(0.2), Transform::from_xyz(0.0, 0.8, 0.1)));
    let ball = Projectile { velocity: Vec3::new(0.3, 1.0, 9.0), ..default() };
    vec![
        world.spawn((curtain(), Transform::from_xyz(0.0, 1.5, 0.0))).id(),
        world.spawn((ball, Transform::from_xyz(0.0, 1.5, -2.0))).id(),
        world.spawn((Rope::default(), Transform::from_xyz(0.4, 2.5, 0.0))).id(),
    ]
}

#[test]
fn two_apps_in_one_process_do_not_affect_each_other() {
    let mut alone = app();
    let bodies = scene(&mut alone);
    run(&mut alone, 1.5);
    let expected = hash(&alone, &bodies);

    let (mut a, mut b) = (app(), app());
    let in_a = scene(&mut a);
    // The other one has other gravity, wind and clock, and starts earlier.
    b.insert_resource(DrapeGravity(Vec3::new(1.0, -3.0, 0.0)));
    b.world_mut().resource_mut::<Wind>().velocity = Vec3::X * 8.0;
    b.world_mut().resource_mut::<DrapeClock>().time_scale = 0.7;
    let in_b = scene(&mut b);
    step(&mut b, 7);
    for _ in 0..90 {
        step(&mut a, 1);
        step(&mut b, 1);
    }
    assert_eq!(hash(&a, &in_a), expected);
    assert_ne!(hash(&b, &in_b), expected);
}

#[test]
fn entity_ids_do_not_matter() {
    let mut plain = app();
    let bodies = scene(&mut plain);
    run(&mut plain, 1.5);

    let mut used = app();
    // Ids are handed out anew, last in first out.
    let others: Vec<Entity> = (0..50).map(|_| used.world_mut().spawn_empty().id()).collect();
    for entity in others.into_iter().step_by(3) {
        used.world_mut().entity_mut(entity).despawn();
    }
    let in_used = scene(&mut used);
    assert_ne!(in_used, bodies);
    run(&mut used, 1.5);
    assert_eq!(hash(&used, &in_used), hash(&plain, &bodies));
}

#[test]
fn a_body_does_not_feel_what_is_far_away() {
    let mut plain = app();
    let bodies = scene(&mut plain);
    let mut crowded = app();
    let in_crowded = scene(&mut crowded);
    for i in 0..10 {
        let at = Transform::from_xyz(20.0 + 5.0 * i as f32, 3.0, 0.0);
        // More substeps, and faster balls, than those of the others.
        crowded.world_mut().spawn((curtain(), SolverSettings { substeps: 20, ..default() }, at));
        let ball = Projectile { velocity: Vec3::Z * 60.0, ..default() };
        crowded.world_mut().spawn((ball, at.with_translation(at.translation - Vec3::Z * 10.0)));
    }
    run(&mut plain, 1.5);
    run(&mut crowded, 1.5);
    assert_eq!(hash(&crowded, &in_crowded), hash(&plain, &bodies));
}

#[test]
fn the_order_of_creation_matters_and_not_that_of_ids() {
    // Four balls that press on one another: the contact that is solved last has the last word.
    let run_scene = |is_reversed: bool| {
        let mut app = app();
        let mut entities: Vec<Entity> = (0..4).map(|_| app.world_mut().spawn_empty().id()).collect();
        if is_reversed {
            entities.reverse();
        }
        for (i, &entity) in entities.iter().enumerate() {
            let place = Vec3::new(0.2 * i as f32, 0.03 * (i * i) as f32, 0.0);
            let ball = (Projectile::default(), Transform::from_translation(place));
            app.world_mut().entity_mut(entity).insert(ball);
            step(&mut app, 1);
        }
        run(&mut app, 0.5);
        hash(&app, &entities)
    };
    assert_eq!(run_scene(true), run_scene(false));
}

#[test]
fn what_is_spawned_later_comes_later_whatever_its_components_are() {
    // Two bodies and a ball between them: all in one island, and the order of its members is theirs of creation.
    let run_scene = |with_marker: bool| {
        let mut app = app();
        let at = |z: f32| Transform::from_xyz(0.0, 0.0, z);
        let first = app.world_mut().spawn((free_cloth(), at(-0.1))).id();
        if with_marker {
            app.world_mut().entity_mut(first).insert(Name::new("first"));
        }
        step(&mut app, 1);
        let second = app.world_mut().spawn((free_cloth(), at(0.3))).id();
        step(&mut app, 1);
        let ball = app.world_mut().spawn((Projectile { radius: 0.1, ..default() }, at(0.1))).id();
        run(&mut app, 1.0);
        hash(&app, &[first, second, ball])
    };
    assert_eq!(run_scene(false), run_scene(true));
}
