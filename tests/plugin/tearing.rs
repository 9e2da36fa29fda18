//! Tears and cuts: what comes off is a body of its own, and everyone is told.

use bevy::prelude::*;
use bevy_drape::attach::Grab;
use bevy_drape::body::{Activity, Sticks, StructuralSolve};
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::ray_cast::cast_ray;
use bevy_drape::tear::{BodySplit, CutCloth, StickTorn};
use drape_solver::state::measure;

use crate::common::*;

/// A component that a game may have on its cloth.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct Colour(u32);

/// The messages about tears and splits.
#[derive(Resource, Default)]
struct Told {
    torn: Vec<StickTorn>,
    split: Vec<BodySplit>,
    observed: Vec<BodySplit>,
}

fn tearing_app() -> App {
    let mut app = app();
    app.init_resource::<Told>().add_observer(|split: On<BodySplit>, mut told: ResMut<Told>| {
        told.observed.push(split.event().clone());
    });
    app.add_systems(
        Last,
        |mut torn: MessageReader<StickTorn>, mut split: MessageReader<BodySplit>, mut told: ResMut<Told>| {
            told.torn.extend(torn.read());
            told.split.extend(split.read().cloned());
        },
    );
    app
}

/// A level cut through a curtain of 1 m around the origin, at this height.
fn level(height: f32) -> CutCloth {
    let edge = |x: f32| [Vec3::new(x, height, -2.0), Vec3::new(x, height, 2.0)];
    CutCloth::sweep(edge(-2.0), edge(2.0))
}

fn mass(app: &mut App) -> f64 {
    let mut bodies = app.world_mut().query::<&Particles>();
    bodies.iter(app.world()).map(|particles| measure::mass(particles)).sum()
}

#[test]
fn what_is_cut_off_is_a_clone_with_a_body_of_its_own_and_falls() {
    let mut app = tearing_app();
    let place = Transform::from_xyz(3.0, 0.0, 0.0);
    let curtain = app.world_mut().spawn((curtain(), place, Colour(7), dragless())).id();
    let other = app.world_mut().spawn(self::curtain()).id();
    run(&mut app, 0.2);
    let before = mass(&mut app);
    let cut = CutCloth::sweep(
        [Vec3::new(2.0, -0.1, -2.0), Vec3::new(2.0, -0.1, 2.0)],
        [Vec3::new(4.0, -0.1, -2.0), Vec3::new(4.0, -0.1, 2.0)],
    );
    app.world_mut().write_message(cut);
    step(&mut app, 1);
    let told = app.world().resource::<Told>();
    assert_eq!((told.split.len(), &told.split), (1, &told.observed));
    let split = told.split[0].clone();
    assert_eq!(split.body, curtain);
    assert!(!told.torn.is_empty() && told.torn.iter().all(|torn| torn.body == curtain && torn.is_cut));
    let piece = split.piece.expect("large enough");
    assert_eq!(get::<Particles>(&app, piece).len(), split.origins.len());
    assert_eq!((*get::<Colour>(&app, piece), *get::<BodySurface>(&app, piece)), (Colour(7), dragless()));
    assert!(app.world().get::<Cloth>(piece).is_none(), "it is no longer what it was built from");
    assert_eq!(get::<Particles>(&app, other).len(), 81, "the other curtain is elsewhere");
    assert!((mass(&mut app) - before).abs() < 1e-5 * before);

    let start = centre(&app, piece).y;
    let speed = app
        .world()
        .get::<Particles>(piece)
        .map(|p| measure::momentum(p) / measure::mass(p))
        .expect("a body")
        .y;
    run(&mut app, 0.5);
    let expected = start + speed as f32 * 0.5 - 0.5 * GRAVITY * 0.25;
    assert!(
        (centre(&app, piece).y - expected).abs() < 0.02,
        "{}, expected {expected}",
        centre(&app, piece).y
    );
    assert!(get::<Particles>(&app, curtain).positions().all(|place| place.y > -0.3), "the rest hangs");
    // The transform of a body moves its pins; the piece has none left.
    get_mut::<Transform>(&mut app, curtain).translation.y += 1.0;
    step(&mut app, 1);
    assert!(get::<Particles>(&app, curtain).position(0).y > 1.4);
}

/// What is cut off right below the pins has virtual copies of them, which nothing holds: the piece falls, and stays where it is when
/// its transform moves.
#[test]
fn what_is_cut_off_right_below_the_pins_has_none() {
    let mut app = tearing_app();
    let curtain = app.world_mut().spawn((curtain(), dragless())).id();
    step(&mut app, 2);
    app.world_mut().write_message(level(0.44));
    step(&mut app, 1);
    let piece = app.world().resource::<Told>().split[0].piece.expect("large enough");
    let [pinned, free] = [0, 1].map(|place| {
        let of = |entity: Entity| {
            let particles = get::<Particles>(&app, entity);
            (0..particles.len()).any(|i| particles.is_pinned(i))
        };
        let mut both = [curtain, piece];
        both.sort_by_key(|&entity| !of(entity));
        both[place]
    });
    let before = centre(&app, free).y;
    get_mut::<Transform>(&mut app, free).translation.y += 1.0;
    run(&mut app, 0.2);
    assert!(centre(&app, free).y < before, "it falls");
    assert!(get::<Particles>(&app, pinned).positions().all(|place| place.y > 0.3));
}

#[test]
fn only_the_body_that_is_named_is_cut() {
    let mut app = tearing_app();
    let [first, second] =
        [0.0, 0.2].map(|z| app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 0.0, z))).id());
    step(&mut app, 2);
    app.world_mut().write_message(level(0.05).only(second));
    step(&mut app, 1);
    assert!(app.world().resource::<Told>().split.iter().all(|split| split.body == second));
    assert_eq!(get::<Particles>(&app, first).len(), 81);
    assert_eq!(app.world().resource::<Told>().split.len(), 1);
}

#[test]
fn a_cut_wakes_a_curtain_that_hangs_asleep() {
    let mut app = tearing_app();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    settle(&mut app, curtain);
    app.world_mut().write_message(level(0.05));
    step(&mut app, 1);
    assert_eq!(activity(&app, curtain), Activity::Active);
    let piece = app.world().resource::<Told>().split[0].piece.expect("large enough");
    assert_eq!(activity(&app, piece), Activity::Active);
}

/// A heavy ball tears a curtain that may tear, and does not tear one that may not.
#[test]
fn a_cannon_ball_tears_what_is_tearable() {
    for is_tearable in [true, false] {
        let mut app = tearing_app();
        let cloth = Cloth::new(2.0, 2.0).with_particles(33, 33).with_pins(ClothPins::Corners);
        let curtain = app.world_mut().spawn(cloth).id();
        if is_tearable {
            app.world_mut().entity_mut(curtain).insert(Tearable {
                strain: 0.3,
                most_at_once: 32,
                ..default()
            });
        }
        let ball = Projectile { radius: 0.15, mass: 20.0, velocity: Vec3::Z * 40.0, ..default() };
        app.world_mut().spawn((ball, Transform::from_xyz(0.1, 0.1, -1.0)));
        step(&mut app, 1);
        let before = mass(&mut app);
        run(&mut app, 0.5);
        let told = app.world().resource::<Told>();
        assert_eq!(told.torn.is_empty(), !is_tearable, "{} sticks torn", told.torn.len());
        assert!(told.torn.iter().all(|torn| !torn.is_cut && torn.length > 1.3 * torn.rest_length));
        let vanished = told.split.iter().filter(|split| split.piece.is_none()).count();
        let after = mass(&mut app);
        assert!(
            after <= before * (1.0 + 1e-6) && (vanished > 0 || after > before * (1.0 - 1e-5)),
            "{after} of {before} kg"
        );
        let faces: usize =
            app.world_mut().query::<&Sticks>().iter(app.world()).map(|sticks| sticks.faces().len()).sum();
        assert!(faces <= 2 * 32 * 32 && (vanished > 0 || faces == 2 * 32 * 32));
    }
}

/// Lines leave no strain to tear by.
#[test]
fn what_may_tear_is_swept_if_there_are_iterations_for_it() {
    let fallen = |structural, iterations, is_tearable| -> Vec<Vec3> {
        let mut app = app();
        let settings = SolverSettings { structural, iterations, ..default() };
        let curtain = app.world_mut().spawn((curtain(), settings)).id();
        if is_tearable {
            app.world_mut().entity_mut(curtain).insert(Tearable::default());
        }
        step(&mut app, 30);
        get::<Particles>(&app, curtain).positions().collect()
    };
    for (iterations, is_swept) in [(2, true), (1, false)] {
        let [lines, sweeps] = [StructuralSolve::Lines, StructuralSolve::Sweeps]
            .map(|structural| fallen(structural, iterations, false));
        assert_ne!(lines, sweeps);
        let expected = if is_swept { sweeps } else { lines };
        assert_eq!(fallen(StructuralSolve::Lines, iterations, true), expected, "{iterations} iterations");
    }
}

/// A ray meets what is drawn: close to a cut, the side on which it comes, and nothing in a gap.
#[test]
fn rays_end_at_the_edges_of_cuts() {
    let mut app = tearing_app();
    let curtain = app.world_mut().spawn((curtain(), dragless())).id();
    step(&mut app, 1);
    app.world_mut().write_message(level(0.05));
    step(&mut app, 1);
    let piece = app.world().resource::<Told>().split[0].piece.expect("large enough");
    let hit = |app: &App, entity: Entity, y: f32| {
        let ray = Ray3d::new(Vec3::new(0.06, y, -1.0), Dir3::Z);
        let (particles, sticks) = (get::<Particles>(app, entity), get::<Sticks>(app, entity));
        cast_ray(ray, 2.0, particles, sticks, 0.0).is_some()
    };
    // The lower half is the larger one.
    for (y, expected) in [(0.055, [true, false]), (0.045, [false, true])] {
        assert_eq!([piece, curtain].map(|entity| hit(&app, entity, y)), expected, "at {y}");
    }
    run(&mut app, 0.3);
    assert_eq!([0.055, 0.04, 0.0].map(|y| hit(&app, curtain, y)), [false; 3], "it has fallen");
    assert_eq!([0.055, 0.04, 0.0].map(|y| hit(&app, piece, y)), [true, false, false]);
}

#[test]
fn crumbs_vanish_and_are_told_of() {
    let mut app = tearing_app();
    let tearable = Tearable { least_particles: 1000, ..default() };
    app.world_mut().spawn((curtain(), tearable));
    step(&mut app, 2);
    app.world_mut().write_message(level(0.05));
    step(&mut app, 1);
    let told = app.world().resource::<Told>();
    assert_eq!((told.split.len(), told.split[0].piece), (1, None));
    assert_eq!(app.world_mut().query::<&Particles>().iter(app.world()).count(), 1);
}

#[test]
fn a_hand_keeps_hold_of_what_it_held() {
    let mut app = tearing_app();
    let curtain = app.world_mut().spawn(curtain()).id();
    step(&mut app, 2);
    let grab = Grab::new(get::<Particles>(&app, curtain), 80, 0.3);
    let held = get::<Particles>(&app, curtain).position(80);
    app.world_mut().entity_mut(curtain).insert(grab);
    // From the left to the middle: nothing comes off, but particles are split.
    let edge = |x: f32| [Vec3::new(x, 0.05, -2.0), Vec3::new(x, 0.05, 2.0)];
    app.world_mut().write_message(CutCloth::sweep(edge(-2.0), edge(0.1)));
    step(&mut app, 1);
    assert!(get::<Particles>(&app, curtain).len() > 81, "it was cut");
    let firmest = get::<Grab>(&app, curtain).particles().map(|i| get::<Particles>(&app, curtain).position(i));
    assert!(firmest.into_iter().any(|place| place.distance(held) < 0.05));
}

#[test]
fn a_tear_that_cannot_be_and_a_blade_that_is_nowhere_are_said_to_be_so() {
    for strain in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let mut app = tearing_app();
        let curtain = app.world_mut().spawn((curtain(), Tearable { strain, ..default() })).id();
        step(&mut app, 3);
        let messages = refusals(&app, curtain);
        assert!(
            messages.len() == 1 && messages[0].contains("Tearable") && messages[0].contains("strain"),
            "{messages:?}"
        );
        assert_eq!(activity(&app, curtain), Activity::Active, "it is simulated all the same");
        get_mut::<Tearable>(&mut app, curtain).strain = 0.5;
        step(&mut app, 1);
        assert!(refusals(&app, curtain).is_empty(), "mended");
    }
    let mut app = tearing_app();
    app.world_mut().spawn(curtain());
    app.world_mut().write_message(CutCloth { blade: vec![[Vec3::NAN; 3]], only: None });
    step(&mut app, 2);
    let messages: Vec<String> = app.world().resource::<Refusals>().iter().map(ToString::to_string).collect();
    assert!(messages.len() == 1 && messages[0].contains("CutCloth"), "{messages:?}");
}

/// Two runs give the same bits, whatever the entities are called.
#[test]
fn the_same_tears_give_the_same_bits() {
    let run = |others: usize| {
        let mut app = tearing_app();
        for _ in 0..others {
            app.world_mut().spawn_empty();
        }
        let cloth = Cloth::new(1.0, 1.0).with_particles(33, 33);
        let curtain = app.world_mut().spawn((cloth, Tearable { strain: 0.2, ..default() })).id();
        step(&mut app, 20);
        app.world_mut().write_message(level(-0.1));
        app.world_mut().write_message(CutCloth::star(Vec3::new(0.1, 0.2, 0.0), Dir3::Z, 0.1));
        let ball = Projectile { velocity: Vec3::Z * 25.0, ..default() };
        app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.3, -0.5)));
        step(&mut app, 60);
        let mut bodies = vec![curtain];
        bodies.extend(app.world().resource::<Told>().split.iter().filter_map(|split| split.piece));
        (bodies.len(), hash(&app, &bodies))
    };
    let first = run(0);
    assert!(first.0 > 1);
    assert_eq!(first, run(100));
}

/// It was despawned before the rest had been done to it, which panicked.
#[test]
fn an_observer_may_despawn_what_was_split() {
    let mut app = tearing_app();
    app.add_observer(|split: On<BodySplit>, mut commands: Commands| {
        commands.entity(split.body).try_despawn();
    });
    let curtain = app.world_mut().spawn(curtain()).id();
    step(&mut app, 2);
    app.world_mut().write_message(level(0.2));
    app.world_mut().write_message(level(-0.2));
    step(&mut app, 2);
    assert!(app.world().get_entity(curtain).is_err(), "it is gone");
    assert_eq!(
        app.world_mut().query::<&Particles>().iter(app.world()).count(),
        1,
        "and what came off is not"
    );
}

/// It passed while nobody looked: messages are forgotten after two ticks.
#[test]
fn a_cut_in_a_pause_is_made_after_it() {
    let mut app = tearing_app();
    app.world_mut().spawn(curtain());
    step(&mut app, 2);
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    app.world_mut().write_message(level(0.0));
    step(&mut app, 5);
    assert!(app.world().resource::<Told>().torn.is_empty());
    app.world_mut().resource_mut::<DrapeClock>().paused = false;
    step(&mut app, 2);
    assert_eq!(app.world().resource::<Told>().split.len(), 1);
}

/// The second of two strokes in a step did not see what had come off by the first.
#[test]
fn two_strokes_in_a_step_leave_four_quarters() {
    let mut app = tearing_app();
    weightless(&mut app);
    app.world_mut().spawn(curtain().with_pins(ClothPins::None));
    step(&mut app, 2);
    let upright = |z: f32| [Vec3::new(0.01, 2.0, z), Vec3::new(0.01, -2.0, z)];
    app.world_mut().write_message(level(0.01));
    app.world_mut().write_message(CutCloth::sweep(upright(-2.0), upright(2.0)));
    step(&mut app, 1);
    let mut sizes: Vec<usize> =
        app.world_mut().query::<&Particles>().iter(app.world()).map(|body| body.len()).collect();
    sizes.sort_unstable();
    assert_eq!(sizes.len(), 4, "{sizes:?}");
    assert!(sizes[0] >= 16, "{sizes:?}");
}
