//! Snapshots of a world, and of a part of it: they bring back exactly what they are of.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::contact::{DrapeContactEnded, DrapeContactStarted};
use bevy_drape::prelude::*;
use bevy_drape::snapshot::{Key, Snapshot, SnapshotError, members};

use crate::common::*;

/// Taken back in time.
#[derive(Component, Clone)]
pub struct RolledBack;

/// Numbers of contacts that have started and ended.
#[derive(Resource, Default)]
struct Contacts {
    started: usize,
    ended: usize,
}

fn count_contacts(app: &mut App) {
    app.init_resource::<Contacts>().add_systems(
        Last,
        |mut started: MessageReader<DrapeContactStarted>,
         mut ended: MessageReader<DrapeContactEnded>,
         mut sums: ResMut<Contacts>| {
            sums.started += started.read().count();
            sums.ended += ended.read().count();
        },
    );
}

fn contacts(app: &App) -> (usize, usize) {
    let Contacts { started, ended } = app.world().resource();
    (*started, *ended)
}

fn take_part(app: &mut App) -> Snapshot {
    Snapshot::take_of::<With<RolledBack>>(app.world_mut())
}

fn restore_part(app: &mut App, saved: &Snapshot) {
    saved.restore_of::<With<RolledBack>>(app.world_mut()).expect("the same world");
}

fn set_enabled(app: &mut App, entity: Entity, is_enabled: bool) {
    let mut entity = app.world_mut().entity_mut(entity);
    if is_enabled {
        entity.remove::<Disabled>();
    } else {
        entity.insert(Disabled);
    }
}

/// A free cloth that lies down on the ground, a tenth of a second after it was spawned or later.
fn flat_cloth(height: f32) -> impl Bundle {
    let flat = Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(1.57));
    (free_cloth(), ContactEvents, flat)
}

/// The keys of all members; asserts that each is known once.
pub fn distinct_keys(app: &mut App) -> Vec<Key> {
    let keys: Vec<Key> = members(app.world_mut()).into_iter().map(|(key, _)| key).collect();
    assert!(keys.is_sorted_by(|a, b| a < b), "{keys:?}");
    keys
}

/// Obstacles come back into the solver's list in their own places, and the others stay in it.
#[test]
fn obstacles_come_back_beside_those_that_are_not_chosen() {
    let mut app = app();
    let plate = |app: &mut App, x: f32| {
        app.world_mut().spawn((Obstacle::cuboid(0.5, 0.1, 0.5), Transform::from_xyz(x, 0.0, 0.0))).id()
    };
    let plates = [0.0, 2.0, 4.0, 6.0].map(|x| plate(&mut app, x));
    for &chosen in &plates[1..3] {
        app.world_mut().entity_mut(chosen).insert(RolledBack);
    }
    step(&mut app, 2);
    let saved = take_part(&mut app);
    // One is taken away, two come, one of which belongs to the part.
    app.world_mut().entity_mut(plates[1]).insert(Disabled);
    let [stays, goes] = [8.0, 10.0].map(|x| plate(&mut app, x));
    app.world_mut().entity_mut(goes).insert(RolledBack);
    step(&mut app, 2);
    restore_part(&mut app, &saved);
    distinct_keys(&mut app);
    assert!(app.world().get_entity(goes).is_err());
    assert!(app.world().get_entity(stays).is_ok());
    let balls = [0.0, 2.0, 4.0, 6.0, 8.0, 10.0].map(|x| {
        let ball = Projectile { radius: 0.1, mass: 1.0, restitution: 0.0, ..default() };
        app.world_mut().spawn((ball, Transform::from_xyz(x, 0.5, 0.0))).id()
    });
    run(&mut app, 1.5);
    let lies = balls.map(|ball| ball_position(&app, ball).y > 0.0);
    assert_eq!(lies, [true, true, true, true, true, false]);
}

/// The list of obstacles has the order that it had, whatever was enabled and disabled since: contacts come in that order. In a part,
/// the disabled ones came back behind those that are not chosen.
#[test]
fn what_touches_several_obstacles_goes_on_with_the_same_bits() {
    let places = [Vec3::new(-0.25, 0.0, 0.0), Vec3::new(0.25, 0.0, 0.0), Vec3::new(0.0, 0.0, 0.25)];
    for chosen in [[true, true, true], [true, false, false], [false, true, false]] {
        let mut app = app();
        let spheres = [0, 1, 2].map(|i| {
            let sphere = (Obstacle::sphere(0.3).with_friction(0.5), Transform::from_translation(places[i]));
            let sphere = app.world_mut().spawn(sphere).id();
            if chosen[i] {
                app.world_mut().entity_mut(sphere).insert(RolledBack);
            }
            sphere
        });
        let ball = Projectile { radius: 0.2, mass: 1.0, friction: 0.5, ..default() };
        let ball = app.world_mut().spawn((RolledBack, ball, Transform::from_xyz(0.02, 0.6, 0.1))).id();
        step(&mut app, 5);
        let saved = if chosen == [true; 3] { Snapshot::take(app.world_mut()) } else { take_part(&mut app) };
        step(&mut app, 30);
        let expected = hash(&app, &[ball]);
        for i in [0, 1, 2].into_iter().filter(|&i| chosen[i]) {
            set_enabled(&mut app, spheres[i], false);
            step(&mut app, 1);
            set_enabled(&mut app, spheres[i], true);
            step(&mut app, 1);
        }
        if chosen == [true; 3] {
            saved.restore(app.world_mut()).expect("the same world");
        } else {
            restore_part(&mut app, &saved);
        }
        step(&mut app, 30);
        assert_eq!(hash(&app, &[ball]), expected, "{chosen:?}");
    }
}

/// A plate that is not chosen, moved in the last step before others go back, stands still afterwards and drags nothing along.
#[test]
fn an_obstacle_that_is_not_chosen_comes_to_a_stop() {
    let mut app = app();
    app.world_mut().spawn((RolledBack, curtain(), Transform::from_xyz(9.0, 0.0, 0.0)));
    let plate = Obstacle::cuboid(2.0, 0.1, 0.5).with_friction(1.0);
    let plate = app.world_mut().spawn((plate, Transform::default())).id();
    let ball = Projectile { radius: 0.1, mass: 1.0, friction: 1.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.2, 0.0))).id();
    step(&mut app, 30);
    let saved = take_part(&mut app);
    for _ in 0..3 {
        get_mut::<Transform>(&mut app, plate).translation.x += 0.01;
        step(&mut app, 1);
    }
    restore_part(&mut app, &saved);
    run(&mut app, 2.0);
    let speed = get::<ProjectileState>(&app, ball).velocity().length();
    assert!(speed < 0.3, "the ball goes at {speed} m/s");
}

/// Contacts between things that are not chosen go on: they are not told again.
#[test]
fn contacts_of_what_is_not_chosen_are_told_once() {
    let mut app = app();
    count_contacts(&mut app);
    app.world_mut().spawn((RolledBack, curtain(), Transform::from_xyz(9.0, 0.0, 0.0)));
    app.world_mut().spawn(Obstacle::ground());
    app.world_mut().spawn(flat_cloth(0.05));
    step(&mut app, 20);
    assert_eq!(contacts(&app), (1, 0));
    let saved = take_part(&mut app);
    step(&mut app, 1);
    restore_part(&mut app, &saved);
    step(&mut app, 20);
    assert_eq!(contacts(&app), (1, 0));
}

/// Contacts of the part with the ground, which does not belong to it, go back with the part: they were kept, so that a cloth that came
/// down again told nothing.
#[test]
fn contacts_with_what_is_not_chosen_go_back() {
    let mut app = app();
    count_contacts(&mut app);
    app.world_mut().spawn(Obstacle::ground());
    app.world_mut().spawn((RolledBack, flat_cloth(0.05)));
    let ball = Projectile { radius: 0.1, mass: 1.0, restitution: 0.0, ..default() };
    app.world_mut().spawn((RolledBack, ball, Transform::from_xyz(5.0, 0.15, 0.0)));
    step(&mut app, 1);
    let before = take_part(&mut app);
    step(&mut app, 19);
    let hits = |app: &App| app.world().resource::<Hits>().0.len();
    assert_eq!((contacts(&app), hits(&app)), ((1, 0), 1));
    let after = take_part(&mut app);
    for (saved, sum) in [(&after, 1), (&before, 2)] {
        restore_part(&mut app, saved);
        step(&mut app, 20);
        assert_eq!((contacts(&app), hits(&app)), ((sum, 0), sum));
    }
}

/// A restored world forgets the contacts of what it despawns: they were told to end, of entities that were gone.
#[test]
fn contacts_of_what_is_gone_are_forgotten() {
    let mut app = app();
    count_contacts(&mut app);
    step(&mut app, 1);
    let saved = Snapshot::take(app.world_mut());
    app.world_mut().spawn(Obstacle::ground());
    app.world_mut().spawn(flat_cloth(0.05));
    step(&mut app, 20);
    assert_eq!(contacts(&app), (1, 0));
    saved.restore(app.world_mut()).expect("the same world");
    step(&mut app, 20);
    assert_eq!(contacts(&app), (1, 0));
}

#[test]
fn a_part_is_not_restored_as_a_whole() {
    let mut app = app();
    let early = Snapshot::take(app.world_mut());
    app.world_mut().spawn((RolledBack, curtain()));
    let other = app.world_mut().spawn((curtain(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    step(&mut app, 1);
    let saved = take_part(&mut app);
    assert_eq!(saved.restore(app.world_mut()), Err(SnapshotError::PartOfWorld));
    assert_eq!(early.restore(app.world_mut()), Err(SnapshotError::NotStepped));
    assert!(app.world().get_entity(other).is_ok());
}

/// Bodies and balls that were disabled, or are, come back as they were. Snapshots left them out.
#[test]
fn disabled_bodies_and_balls_come_back_as_they_were() {
    let mut app = app();
    let curtains = [0.0, 3.0]
        .map(|x| app.world_mut().spawn((RolledBack, curtain(), Transform::from_xyz(x, 0.0, 0.0))).id());
    let balls = [6.0, 9.0].map(|x| {
        let ball = Projectile { velocity: Vec3::X, ..default() };
        app.world_mut().spawn((RolledBack, ball, Transform::from_xyz(x, 0.0, 0.0))).id()
    });
    let all = [curtains[0], curtains[1], balls[0], balls[1]];
    step(&mut app, 10);
    for entity in [curtains[0], balls[0]] {
        set_enabled(&mut app, entity, false);
    }
    step(&mut app, 5);
    let saved = take_part(&mut app);
    let then = hash(&app, &all);
    step(&mut app, 10);
    let expected = hash(&app, &all);
    for (entity, is_enabled) in
        [(curtains[0], true), (balls[0], true), (curtains[1], false), (balls[1], false)]
    {
        set_enabled(&mut app, entity, is_enabled);
    }
    step(&mut app, 10);
    restore_part(&mut app, &saved);
    assert_eq!(hash(&app, &all), then);
    let is_disabled = all.map(|entity| app.world().entity(entity).contains::<Disabled>());
    assert_eq!(is_disabled, [true, false, true, false]);
    step(&mut app, 10);
    assert_eq!(hash(&app, &all), expected);
}

/// A ball that is gone is spawned once, however often it comes back: without the component of the filter it was not found the second time.
#[test]
fn a_ball_that_is_gone_comes_back_once() {
    let mut app = app();
    let ball = app.world_mut().spawn((RolledBack, Projectile::default())).id();
    step(&mut app, 5);
    let saved = take_part(&mut app);
    let then = hash(&app, &[ball]);
    app.world_mut().despawn(ball);
    for _ in 0..2 {
        step(&mut app, 3);
        restore_part(&mut app, &saved);
        let keys = members(app.world_mut());
        let [(Key::Ball(1), ball)] = keys[..] else { panic!("{keys:?}") };
        assert_eq!(hash(&app, &[ball]), then);
    }
}

/// A push that the step has not taken yet goes back with the rest.
#[test]
fn a_push_belongs_to_the_snapshot() {
    let mut app = app();
    let cloth = app.world_mut().spawn((RolledBack, curtain())).id();
    step(&mut app, 5);
    get_mut::<Particles>(&mut app, cloth).apply_impulse(60, 0.05 * Vec3::Z);
    let saved = take_part(&mut app);
    step(&mut app, 10);
    let expected = hash(&app, &[cloth]);
    restore_part(&mut app, &saved);
    step(&mut app, 10);
    assert_eq!(hash(&app, &[cloth]), expected);
}

/// Obstacles that are spawned again after the past came back have the numbers that they had: on another machine, which guessed rightly,
/// they have those too.
#[test]
fn what_is_spawned_again_has_the_same_numbers() {
    let mut app = app();
    app.world_mut().spawn((RolledBack, Obstacle::ground()));
    step(&mut app, 1);
    let saved = take_part(&mut app);
    let play = |app: &mut App| {
        let crate_ = (RolledBack, Obstacle::cuboid(0.1, 0.1, 0.1), Transform::from_xyz(0.0, 0.5, 0.0));
        app.world_mut().spawn(crate_.clone());
        let gone = app.world_mut().spawn(crate_.clone()).id();
        step(app, 1);
        app.world_mut().despawn(gone);
        app.world_mut().spawn((RolledBack, curtain()));
        app.world_mut().spawn(crate_);
        step(app, 1);
        distinct_keys(app)
    };
    let straight = play(&mut app);
    restore_part(&mut app, &saved);
    assert_eq!(play(&mut app), straight);
}

/// A ball that lay on a plate falls when the plate is despawned just before other things go back. It hung in the air: the plate was gone
/// before the step could hear of it.
#[test]
fn what_rests_wakes_though_others_go_back() {
    let mut app = app();
    app.world_mut().spawn((RolledBack, Obstacle::sphere(0.1), Transform::from_xyz(9.0, 0.0, 0.0)));
    let plate = app.world_mut().spawn(Obstacle::cuboid(1.0, 0.1, 1.0)).id();
    let ball = Projectile { radius: 0.1, mass: 1.0, restitution: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.16, 0.0))).id();
    settle(&mut app, ball);
    let saved = take_part(&mut app);
    app.world_mut().despawn(plate);
    restore_part(&mut app, &saved);
    step(&mut app, 30);
    assert!(ball_position(&app, ball).y < -0.5);
}
