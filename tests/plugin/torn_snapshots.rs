//! Snapshots across tears and cuts: what was whole is whole again, and pieces that are gone come back.

use bevy::prelude::*;
use bevy_drape::attach::{Tie, TiedParticles};
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::prelude::*;
use bevy_drape::snapshot::{Key, Snapshot, SnapshotError, members};
use bevy_drape::tear::{BodySplit, CutCloth};
use bevy_drape_script::checkpoint::Checkpoint;

use crate::common::*;
use crate::snapshots::RolledBack;

/// A component that a game may have on its cloth.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct Colour(u32);

/// A level cut through a curtain of 1 m around the origin, at this height.
fn cut(app: &mut App, height: f32, [from, to]: [f32; 2]) {
    let edge = |x: f32| [Vec3::new(x, height, -2.0), Vec3::new(x, height, 2.0)];
    app.world_mut().write_message(CutCloth::sweep(edge(from), edge(to)));
}

/// The bodies by their numbers, and the bits of all of them.
fn state(app: &mut App) -> (Vec<Key>, u64) {
    let (keys, entities): (Vec<Key>, Vec<Entity>) = members(app.world_mut()).into_iter().unzip();
    (keys, hash(app, &entities))
}

fn entity_of(app: &mut App, key: Key) -> Entity {
    let all = members(app.world_mut());
    all.iter().find(|&&(other, _)| other == key).expect("a body").1
}

/// A curtain that is slit, then cut in two, of whose pieces the lower one is cut again, in steps of its own.
fn play(app: &mut App, from: usize, to: usize) {
    for frame in from..to {
        match frame {
            5 => cut(app, 0.13, [-2.0, 0.1]),
            10 => cut(app, -0.1, [-2.0, 2.0]),
            20 => cut(app, -0.45, [-2.0, 2.0]),
            _ => {}
        }
        step(app, 1);
    }
}

fn cut_app() -> App {
    let mut app = app();
    app.world_mut().spawn((curtain(), dragless(), Colour(7)));
    app.world_mut().spawn((curtain(), Transform::from_xyz(9.0, 0.0, 0.0)));
    step(&mut app, 2);
    app
}

/// Any state comes back from any other: from before and after each cut. All goes on with the same bits, which have the same numbers.
#[test]
fn any_state_comes_back_across_cuts() {
    let mut app = cut_app();
    let mut saved: Vec<(usize, Snapshot, (Vec<Key>, u64))> = Vec::new();
    for frame in [0, 4, 6, 12, 22, 30] {
        let last = saved.last().map_or(0, |&(frame, ..)| frame);
        play(&mut app, last, frame);
        let now = state(&mut app);
        saved.push((frame, Snapshot::take(app.world_mut()), now));
    }
    let counts: Vec<usize> = saved.iter().map(|(_, _, (keys, _))| keys.len()).collect();
    assert_eq!(counts, [2, 2, 2, 3, 4, 4]);
    let (last, _, end) = saved.last().expect("several").clone();
    let mut at = saved.len() - 1;
    for to in [0, 3, 1, 4, 2, 5, 0, 4, 3, 2, 1, 5, 2, 0] {
        let (frame, snapshot, then) = &saved[to];
        assert_eq!(snapshot.restore(app.world_mut()), Ok(()), "from {at} to {to}");
        assert_eq!(state(&mut app), *then, "from {at} to {to}");
        assert_eq!(Snapshot::take(app.world_mut()), *snapshot, "from {at} to {to}");
        for (_, entity) in members(app.world_mut()) {
            let joined = get::<Sticks>(&app, entity).particle_count();
            assert_eq!(get::<Particles>(&app, entity).len(), joined);
        }
        play(&mut app, *frame, last);
        assert_eq!(state(&mut app), end, "from {at} by {to} to the end");
        at = saved.len() - 1;
        // The next one is restored from another state than the end, too.
        if to % 2 == 1 {
            snapshot.restore(app.world_mut()).expect("of this world");
            at = to;
        }
    }
}

/// A new world with the same scene, in which nothing was cut, takes the state after the cuts, and one after cuts that before them.
#[test]
fn another_world_takes_what_was_cut() {
    let mut first = cut_app();
    let early = Snapshot::take(first.world_mut());
    play(&mut first, 0, 25);
    let late = Snapshot::take(first.world_mut());
    play(&mut first, 25, 30);
    let end = state(&mut first);
    let mut second = cut_app();
    late.restore(second.world_mut()).expect("the same scene");
    play(&mut second, 25, 30);
    assert_eq!(state(&mut second), end);
    early.restore(second.world_mut()).expect("the same scene");
    play(&mut second, 0, 30);
    assert_eq!(state(&mut second), end);
}

/// A piece that comes back has the components of its cloth, but no description.
#[test]
fn a_piece_that_comes_back_is_a_clone() {
    let mut app = cut_app();
    play(&mut app, 0, 12);
    let saved = Snapshot::take(app.world_mut());
    let piece = entity_of(&mut app, Key::Body(3));
    app.world_mut().despawn(piece);
    step(&mut app, 1);
    saved.restore(app.world_mut()).expect("of this world");
    let back = entity_of(&mut app, Key::Body(3));
    assert_ne!(back, piece);
    assert_eq!(*get::<Colour>(&app, back), Colour(7));
    assert!(app.world().get::<Cloth>(back).is_none());
    // Nothing is left of the cloth from which the piece came: nothing can be cloned.
    for key in [Key::Body(1), Key::Body(3)] {
        let entity = entity_of(&mut app, key);
        app.world_mut().despawn(entity);
    }
    step(&mut app, 1);
    assert_eq!(saved.restore(app.world_mut()), Err(SnapshotError::Missing(Key::Body(1))));
}

/// A body whose state is restored at rest stays at rest, though its sticks change.
#[test]
fn a_torn_body_that_rested_rests_again() {
    let mut app = app();
    let ground = (Obstacle::ground().with_friction(0.9), Transform::from_xyz(0.0, -0.6, 0.0));
    app.world_mut().spawn(ground);
    let cloth = app.world_mut().spawn((curtain(), quiet())).id();
    step(&mut app, 2);
    let whole = Snapshot::take(app.world_mut());
    cut(&mut app, 0.1, [-2.0, 2.0]);
    step(&mut app, 1);
    settle(&mut app, cloth);
    run(&mut app, 5.0);
    let resting = Snapshot::take(app.world_mut());
    let activities = |app: &mut App| {
        let all = members(app.world_mut());
        all.iter().filter_map(|&(_, entity)| app.world().get::<Activity>(entity).copied()).collect::<Vec<_>>()
    };
    step(&mut app, 10);
    let (then, how) = (state(&mut app), activities(&mut app));
    assert!(how.contains(&Activity::Resting), "{how:?}");
    whole.restore(app.world_mut()).expect("of this world");
    step(&mut app, 3);
    resting.restore(app.world_mut()).expect("of this world");
    step(&mut app, 10);
    assert_eq!((state(&mut app), activities(&mut app)), (then, how));
}

/// A curtain that hung asleep before it was cut sleeps again: the piece that vanished beside it woke it.
#[test]
fn what_rested_before_a_cut_rests_again() {
    let mut app = app();
    let cloth = app.world_mut().spawn((curtain(), quiet())).id();
    settle(&mut app, cloth);
    let saved = Snapshot::take(app.world_mut());
    step(&mut app, 10);
    let then = state(&mut app);
    cut(&mut app, -0.1, [-2.0, 2.0]);
    step(&mut app, 3);
    assert_eq!(state(&mut app).0.len(), 2);
    saved.restore(app.world_mut()).expect("of this world");
    step(&mut app, 10);
    assert_eq!((state(&mut app), activity(&app, cloth)), (then, Activity::Resting));
}

/// A torn cloth that was built anew has another number: what is left of the old one does not become it.
#[test]
fn a_piece_does_not_stand_in_for_its_cloth() {
    let mut app = cut_app();
    play(&mut app, 0, 12);
    let saved = Snapshot::take(app.world_mut());
    let cloth = entity_of(&mut app, Key::Body(1));
    get_mut::<Cloth>(&mut app, cloth).particles = UVec2::splat(7);
    step(&mut app, 1);
    let before = state(&mut app);
    assert_eq!(saved.restore(app.world_mut()), Err(SnapshotError::Missing(Key::Body(1))));
    assert_eq!(state(&mut app), before);
}

/// Ties hold the particles that they held, before and after a cut.
#[test]
fn ties_go_back_across_cuts() {
    let mut app = app();
    let hand = app.world_mut().spawn(Transform::from_xyz(0.0, -0.5, 0.0)).id();
    let ties = Attachment { ties: vec![Tie::new(hand, TiedParticles::Indices(vec![72, 80]))] };
    let cloth = app.world_mut().spawn((curtain(), ties.clone())).id();
    step(&mut app, 2);
    let whole = Snapshot::take(app.world_mut());
    cut(&mut app, -0.1, [-2.0, 2.0]);
    step(&mut app, 1);
    let torn = Snapshot::take(app.world_mut());
    let play = |app: &mut App| {
        for _ in 0..20 {
            get_mut::<Transform>(app, hand).translation.z += 0.02;
            step(app, 1);
        }
        state(app)
    };
    let end = play(&mut app);
    let held = |app: &App, entity: Entity| match &get::<Attachment>(app, entity).ties[0].particles {
        TiedParticles::Indices(held) => held.len(),
        other => panic!("{other:?}"),
    };
    get_mut::<Transform>(&mut app, hand).translation.z = 0.0;
    whole.restore(app.world_mut()).expect("of this world");
    assert_eq!(get::<Attachment>(&app, cloth), &ties);
    step(&mut app, 1);
    let down = get::<Particles>(&app, cloth).position(76).y;
    assert!(down < -0.4, "{down}");
    torn.restore(app.world_mut()).expect("of this world");
    let piece = entity_of(&mut app, Key::Body(2));
    assert_eq!([cloth, piece].map(|entity| held(&app, entity)), [0, 2]);
    assert_eq!(play(&mut app), end);
}

/// Cuts in the frames that a game takes back, in every frame eight.
#[test]
fn rollback_goes_across_cuts() {
    let world = || {
        let mut app = app();
        app.world_mut().spawn((RolledBack, curtain(), dragless()));
        let rope = Rope::new(Vec3::new(0.2, 0.4, 0.1), Vec3::new(0.2, -0.4, 0.1), 20);
        app.world_mut().spawn((RolledBack, rope));
        app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -1.0, 0.0)));
        step(&mut app, 2);
        app
    };
    let (mut straight, mut rolled) = (world(), world());
    let mut saved = Vec::new();
    for frame in 0..40 {
        if let Some(then) = frame_before(frame) {
            let snapshot: &Snapshot = &saved[then];
            snapshot.restore_of::<With<RolledBack>>(rolled.world_mut()).expect("of this world");
            play(&mut rolled, then, frame);
        }
        assert_eq!(state(&mut rolled), state(&mut straight), "after {frame} frames");
        saved.push(Snapshot::take_of::<With<RolledBack>>(rolled.world_mut()));
        play(&mut rolled, frame, frame + 1);
        play(&mut straight, frame, frame + 1);
    }
    let keys = state(&mut straight).0;
    assert!(keys.len() > 5, "cloth and rope were cut: {keys:?}");
}

fn frame_before(frame: usize) -> Option<usize> {
    frame.checked_sub(8)
}

/// Cloth that tears by itself goes back, too, and nobody is told of it.
#[test]
fn tears_go_back() {
    let mut app = app();
    let tearable = Tearable { strain: 0.1, ..default() };
    app.world_mut().spawn((curtain(), tearable));
    let ball = Projectile { radius: 0.1, mass: 8.0, velocity: Vec3::NEG_Z * 15.0, ..default() };
    step(&mut app, 2);
    app.world_mut().spawn((ball, Transform::from_xyz(0.1, 0.0, 1.0)));
    let mut saved = Vec::new();
    for _ in 0..30 {
        step(&mut app, 1);
        let now = state(&mut app);
        saved.push((Snapshot::take(app.world_mut()), now));
    }
    let torn = |app: &mut App| {
        let mut sticks = app.world_mut().query::<&Sticks>();
        sticks.iter(app.world()).map(|sticks| sticks.particle_count()).sum::<usize>()
    };
    assert!(torn(&mut app) > 81, "the ball has torn it");
    for from in [25, 3, 12, 0, 18] {
        saved[from].0.restore(app.world_mut()).expect("of this world");
        for (_, then) in &saved[from + 1..] {
            step(&mut app, 1);
            assert_eq!(state(&mut app), *then, "from {from}");
        }
    }
    // Files hold the edges along which it tore.
    let checkpoint = Checkpoint::take(app.world_mut(), "torn");
    let bytes = checkpoint.to_bytes().expect("can be written");
    assert!(Checkpoint::from_bytes(&bytes).expect("can be read") == checkpoint);
    saved[0].0.restore(app.world_mut()).expect("of this world");
    assert_eq!(torn(&mut app), 81);
    let mut splits = app.world_mut().resource_mut::<Messages<BodySplit>>();
    splits.clear();
    saved[29].0.restore(app.world_mut()).expect("of this world");
    assert!(app.world().resource::<Messages<BodySplit>>().is_empty());
}
