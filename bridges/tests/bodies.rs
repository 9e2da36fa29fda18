//! Dynamic bodies that cloth pushes, carries and wakes.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::environment::Obstacle;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

#[track_caller]
fn assert_asleep(app: &App, body: Entity, cloth: Entity) {
    assert!(is_asleep(app, body), "the body is awake, at {} m/s", velocities(app, body)[0].length());
    let particles = app.world().get::<Particles>(cloth).expect("it is built");
    let fastest = (0..particles.len()).map(|i| particles.velocity(i).length()).fold(0.0, f32::max);
    let activity = app.world().get::<Activity>(cloth);
    assert_eq!(activity, Some(&Activity::Resting), "the cloth is awake, at {fastest} m/s");
}

#[test]
fn cloth_lies_on_every_shape_of_dynamic_bodies() {
    for (name, collider, top) in shapes() {
        let mut app = app();
        ground(&mut app);
        // Shapes without a volume have the mass that they are given. No ball rolls from under the sheet.
        let at = Transform::from_xyz(0.0, 1.0, 0.0);
        let body = app.world_mut().spawn((DYNAMIC, collider, mass(20.0, 1.0), at, drifting())).id();
        let sheet = sheet(&mut app, 1.1 + top);
        run(&mut app, 2.0);
        let height = place(&app, body).y;
        let highest = greatest(&app, sheet);
        assert!((highest - height - top).abs() < 0.03, "{name}: it lies at {highest} on a body at {height}");
        assert!(height < 1.0, "{name}: nothing weighs on it, it is at {height}");
        assert!(least(&app, sheet) > -1e-3, "{name}: it is below the ground");
    }
}

#[test]
fn a_crate_that_falls_carries_the_sheet_on_it_down() {
    let mut app = app();
    ground(&mut app);
    let crate_ = app.world_mut().spawn((box_of(0.6, 10.0), Transform::from_xyz(0.0, 2.0, 0.0))).id();
    let sheet = sheet(&mut app, 2.35);
    run(&mut app, 5.0);
    let top = place(&app, crate_).y + 0.3;
    assert!((top - 0.6).abs() < 0.02, "the crate lies on the ground, its top at {top}");
    assert!((greatest(&app, sheet) - top).abs() < 0.03, "the sheet lies on it, at {}", greatest(&app, sheet));
}

#[test]
fn a_net_catches_a_crate_and_lets_it_fall_when_it_goes() {
    let mut app = app();
    ground(&mut app);
    let net = net(&mut app, 2.0);
    let crate_ = app.world_mut().spawn((box_of(0.3, 1.0), Transform::from_xyz(0.0, 2.6, 0.0))).id();
    run(&mut app, 8.0);
    let at = place(&app, crate_);
    assert!(at.y > 1.2 && at.y < 2.15, "it hangs in the net, at {at}");
    assert!(is_asleep(&app, crate_), "it sleeps there");
    app.world_mut().despawn(net);
    run(&mut app, 2.0);
    assert!(place(&app, crate_).y < 0.16, "it has fallen, to {}", place(&app, crate_));
}

/// The crate slept on while the pins went up, and the net slid through it.
#[test]
fn a_crate_that_sleeps_in_a_net_goes_with_its_pins() {
    for fabric in [Fabric::default(), Fabric::NET] {
        let mut app = app();
        let net = net(&mut app, 2.0);
        app.world_mut().entity_mut(net).insert(fabric);
        let crate_ = app.world_mut().spawn((box_of(0.3, 4.0), Transform::from_xyz(0.0, 2.3, 0.0))).id();
        run(&mut app, 6.0);
        assert!(is_asleep(&app, crate_), "it sleeps in the net");
        let before = place(&app, crate_).y;
        for _ in 0..128 {
            app.world_mut().get_mut::<Transform>(net).expect("it is there").translation.y += 0.05 / 64.0;
            app.update();
        }
        let risen = place(&app, crate_).y - before;
        assert!((risen - 0.1).abs() < 0.01, "it has gone up by {risen} m, its net by 0.1 m");
    }
}

/// A light net holds crates that weigh up to 400 times as much, level or tilted, with its border or its corners pinned. Crates of 4 kg went through.
#[test]
fn a_light_net_holds_crates_of_any_weight() {
    let border = |i: &u32| [0, 32].contains(&(i % 33)) || [0, 32].contains(&(i / 33));
    let corners = |i: &u32| [0, 32].contains(&(i % 33)) && [0, 32].contains(&(i / 33));
    for (name, is_pin) in [("border", &border as &dyn Fn(&u32) -> bool), ("corners", &corners)] {
        for (kilograms, fall, tilt) in [(0.25, 0.3, 0.3), (4.0, 1.0, 0.0), (4.0, 0.5, 0.7), (100.0, 0.5, 0.0)]
        {
            let mut app = app();
            let lying = Transform::from_xyz(0.0, 2.0, 0.0)
                .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
            let pins = ClothPins::Indices((0..33 * 33).filter(is_pin).collect());
            let net = Cloth::new(1.6, 1.6).with_particles(33, 33).with_pins(pins);
            let net = app.world_mut().spawn((net, Fabric::NET, lying)).id();
            let at = Transform::from_xyz(0.03, 2.2 + fall, 0.02).with_rotation(Quat::from_rotation_z(tilt));
            let crate_ = app.world_mut().spawn((box_of(0.3, kilograms), at)).id();
            let what = format!("{kilograms} kg, tilted by {tilt}, pinned at the {name}");
            for _ in 0..20 {
                run(&mut app, 0.2);
                let (at, lowest) = (place(&app, crate_), least(&app, net));
                assert!(at.y > lowest, "{what}: it is at {at}, below the net at {lowest}");
                assert!(lowest > 1.84, "{what}: the net stretches down to {lowest}");
            }
            assert!(is_asleep(&app, crate_), "{what}: it is awake, at {:?}", velocities(&app, crate_));
        }
    }
}

/// Crates that lie side by side in a net fall asleep together, and stay where they are. In Rapier they sank by up to 0.1 m/s: each was sent
/// to sleep alone, fell in Rapier's step, and was woken by its neighbour.
#[test]
fn crates_beside_each_other_in_a_net_do_not_sink() {
    let mut app = app();
    let net = net(&mut app, 2.0);
    app.world_mut().entity_mut(net).insert(Fabric::NET);
    let spawn = |app: &mut App, place: [f32; 3]| {
        let at = Transform::from_translation(place.into()).with_rotation(Quat::from_rotation_y(place[1]));
        app.world_mut().spawn((box_of(0.2, 4.0), at)).id()
    };
    let crates = [[-0.12, 2.3, 0.0], [0.12, 2.35, 0.05], [0.0, 2.6, 0.2]].map(|place| spawn(&mut app, place));
    run(&mut app, 3.0);
    let before = crates.map(|body| place(&app, body));
    run(&mut app, 4.0);
    for (body, before) in crates.into_iter().zip(before) {
        let at = place(&app, body);
        assert!(at.distance(before) < 0.02, "it has moved from {before} to {at}");
        assert!(is_asleep(&app, body), "it is awake, at {:?}", velocities(&app, body));
    }
}

/// The sheet keeps a crate of any weight off the floor, twice its thickness of 5 mm high. It let the crate through to the floor, and trembled.
#[test]
fn a_crate_on_a_sheet_on_the_floor_comes_to_rest() {
    for (kilograms, height, tilt) in [(0.2, 0.5, 0.3), (2.0, 0.2, 0.0), (20.0, 0.5, 0.3), (200.0, 2.0, 0.0)] {
        let mut app = app();
        ground(&mut app);
        let sheet = sheet(&mut app, 0.05);
        run(&mut app, 1.0);
        let start = Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_z(tilt));
        let crate_ = app.world_mut().spawn((box_of(0.3, kilograms), start)).id();
        run(&mut app, 6.0);
        let at = place(&app, crate_);
        assert!((at.y - 0.16).abs() < 2e-3, "{kilograms} kg: it lies at {at}");
        // A tilted one or one that falls far rolls or jumps aside.
        assert!(kilograms != 2.0 || at.with_y(0.0).length() < 0.02, "{kilograms} kg: it has slid, to {at}");
        assert!(greatest(&app, sheet) < 0.05, "{kilograms} kg: the sheet is thrown up");
        assert_asleep(&app, crate_, sheet);
    }
}

#[test]
fn a_sheet_on_a_table_sleeps_with_it_and_a_ball_wakes_both() {
    let mut app = app();
    ground(&mut app);
    let table = app.world_mut().spawn((box_of(1.0, 4.0), Transform::from_xyz(0.0, 0.5, 0.0))).id();
    let sheet = sheet(&mut app, 1.05);
    run(&mut app, 6.0);
    assert_asleep(&app, table, sheet);
    let before = place(&app, table);

    let ball = Projectile { velocity: Vec3::X * 20.0, mass: 2.0, ..Projectile::default() };
    app.world_mut().spawn((ball, Transform::from_xyz(-2.0, 0.6, 0.0)));
    run(&mut app, 0.5);
    let moved = place(&app, table).x - before.x;
    assert!(moved > 0.1, "the ball moved the table by {moved} m");
    assert_eq!(app.world().get::<Activity>(sheet), Some(&Activity::Active), "the sheet goes with it");
}

#[test]
fn colliders_of_one_body_move_as_one() {
    // A hammer: a light handle along X, its heavy head at the end, so its centre of mass is off its origin.
    let spawn = |app: &mut App| {
        let handle = (cuboid(Vec3::new(1.0, 0.05, 0.05)), density(100.0));
        let head = (cuboid(Vec3::new(0.1, 0.3, 0.1)), density(2000.0), Transform::from_xyz(0.5, 0.0, 0.0));
        let body = (DYNAMIC, GravityScale(0.0), moving(Vec3::ZERO, Vec3::Z), Transform::default());
        app.world_mut().spawn((body, handle, children![head])).id()
    };
    let mut app = app();
    let hammer = spawn(&mut app);
    run(&mut app, 0.1);
    let obstacles: Vec<_> = app
        .world_mut()
        .query_filtered::<(&Obstacle, &ObstacleOf), Allow<Disabled>>()
        .iter(app.world())
        .collect();
    assert_eq!(obstacles.len(), 1, "both colliders are one obstacle");
    run(&mut app, 1.0);
    // Nothing touches it: it goes where the engine alone moves it.
    let mut alone = app_without_cloth();
    let same = spawn(&mut alone);
    run(&mut alone, 0.1);
    run(&mut alone, 1.0);
    assert_eq!(app.world().get::<Transform>(hammer), alone.world().get::<Transform>(same));
    let obstacle = app.world().get::<BodyObstacle>(hammer).expect("it has one").entity();
    let middle = app.world().get::<Transform>(obstacle).expect("it is there").translation;
    let expected = app.world().get::<Transform>(hammer).expect("it is there").transform_point(Vec3::X * 0.48);
    assert!(middle.distance(expected) < 0.03, "its centre of mass is at {middle}, not at {expected}");
}

#[test]
fn a_body_that_becomes_static_or_goes_loses_its_obstacle() {
    let mut app = app();
    let crate_ = app.world_mut().spawn((box_of(0.3, 1.0), Transform::default())).id();
    let count = |app: &mut App| {
        let world = app.world_mut();
        let all = world.query_filtered::<&Obstacle, Allow<Disabled>>().iter(world).count();
        (all, world.query_filtered::<&ObstacleOf, Allow<Disabled>>().iter(world).count())
    };
    run(&mut app, 0.1);
    assert_eq!(count(&mut app), (1, 1));
    app.world_mut().entity_mut(crate_).insert(STATIC);
    run(&mut app, 0.1);
    assert_eq!(count(&mut app), (1, 0));
    app.world_mut().entity_mut(crate_).insert(DYNAMIC);
    run(&mut app, 0.1);
    assert_eq!(count(&mut app), (1, 1));
    app.world_mut().entity_mut(crate_).remove::<Collider>();
    run(&mut app, 0.1);
    assert_eq!(count(&mut app), (0, 0));
    app.world_mut().entity_mut(crate_).insert(sphere(0.2));
    run(&mut app, 0.1);
    assert_eq!(count(&mut app), (1, 1));
    app.world_mut().despawn(crate_);
    run(&mut app, 0.1);
    assert_eq!(count(&mut app), (0, 0));
}
