//! Bad input is refused with one clear message, and all the rest runs on.

use std::sync::Mutex;

use bevy::log::tracing_subscriber::{self, Layer, layer::SubscriberExt};
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::common::*;

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// Spawns `bundle` beside a ball in free flight; asserts that it is refused in words that name `words`, and that the
/// ball flies on. Returns the app and the entity.
fn assert_refused(bundle: impl Bundle, words: &[&str]) -> (App, Entity) {
    let mut app = app();
    let witness = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(50.0, 0.0, 0.0))).id();
    let bad = app.world_mut().spawn(bundle).id();
    run(&mut app, 0.5);
    let messages = refusals(&app, bad);
    assert_eq!(messages.len(), 1, "{messages:?}");
    for word in [bad.to_string().as_str()].iter().chain(words) {
        assert!(messages[0].contains(word), "“{}” does not name {word}", messages[0]);
    }
    assert_eq!(app.world().resource::<Refusals>().messages().len(), 1);
    let fallen = -ball_position(&app, witness).y;
    assert!((fallen - 0.5 * GRAVITY * 0.25).abs() < 1e-3, "the witness fell {fallen} m");
    let counts = counts(&app);
    assert_eq!(counts.0, 1, "only the witness is active: {counts:?}");
    (app, bad)
}

/// Asserts that nothing is said about `entity` any more and that it is simulated.
fn assert_mended(app: &mut App, entity: Entity) {
    step(app, 3);
    assert_eq!(activity(app, entity), Activity::Active);
    let before = hash(app, &[entity]);
    step(app, 10);
    assert_ne!(hash(app, &[entity]), before, "it stands still");
    assert_eq!(activity(app, entity), Activity::Active);
}

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
        (with(|c| c.areal_density = -1.0), "density"),
        (with(|c| c.areal_density = 0.0), "density"),
        (with(|c| c.areal_density = f32::NAN), "density"),
        (with(|c| c.structural_stiffness = 1.5), "stiffness"),
        (with(|c| c.bend_stiffness = f32::NAN), "stiffness"),
        (with(|c| c.damping = -1.0), "damping"),
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
fn a_cloth_that_is_spoilt_later_is_taken_out() {
    let mut app = app();
    let cloth = app.world_mut().spawn(curtain()).id();
    step(&mut app, 5);
    get_mut::<Cloth>(&mut app, cloth).areal_density = -2.0;
    step(&mut app, 5);
    assert!(app.world().get::<Particles>(cloth).is_none());
    assert_eq!(counts(&app), (0, 0, 0));
    assert_eq!(refusals(&app, cloth).len(), 1);
    // A second fault is told, too.
    get_mut::<Cloth>(&mut app, cloth).areal_density = 0.2;
    get_mut::<Cloth>(&mut app, cloth).size.x = -1.0;
    step(&mut app, 5);
    assert!(refusals(&app, cloth)[0].contains("width"), "{:?}", refusals(&app, cloth));
    app.world_mut().entity_mut(cloth).despawn();
    step(&mut app, 1);
    assert_eq!(app.world().resource::<Refusals>().messages().len(), 0, "who is gone is forgotten");
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
        (Obstacle::cuboid(1.0, -1.0, 1.0), "extent"),
        (Obstacle::capsule(-0.1, 1.0), "radius"),
        (ground.clone().with_friction(-1.0), "friction"),
        (ground.clone().with_friction(f32::NAN), "friction"),
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
fn settings_out_of_range() {
    let good = SolverSettings::default();
    let bad = [
        (SolverSettings { substeps: 0, ..good }, "substeps"),
        (SolverSettings { substeps: u32::MAX, ..good }, "substeps"),
        (SolverSettings { iterations: 0, ..good }, "iterations"),
        (SolverSettings { drag: f32::NAN, ..good }, "drag"),
        (SolverSettings { drag: -1.0, ..good }, "drag"),
        (SolverSettings { friction: f32::INFINITY, ..good }, "friction"),
        (SolverSettings { thickness: f32::NAN, ..good }, "thickness"),
    ];
    for (settings, word) in bad {
        let (mut app, entity) = assert_refused((free_cloth(), settings), &["SolverSettings", word]);
        assert_eq!(activity(&app, entity), Activity::Culled);
        app.world_mut().entity_mut(entity).insert(good);
        assert_mended(&mut app, entity);
    }
    // The same as the settings of all.
    let mut app = app();
    app.insert_resource(DefaultSolverSettings(SolverSettings { substeps: 0, ..good }));
    let a = app.world_mut().spawn(free_cloth()).id();
    let b = app.world_mut().spawn((free_cloth(), good, Transform::from_xyz(5.0, 0.0, 0.0))).id();
    run(&mut app, 0.5);
    assert_eq!((activity(&app, a), activity(&app, b)), (Activity::Culled, Activity::Active));
    app.insert_resource(DefaultSolverSettings::default());
    assert_mended(&mut app, a);
}

#[test]
fn gravity_and_wind_that_are_not_finite() {
    for bad in BAD.into_iter().chain([1e30]) {
        let mut app = app();
        let cloth = app.world_mut().spawn((free_cloth(), dragless())).id();
        step(&mut app, 1);
        app.insert_resource(DrapeGravity(Vec3::new(0.0, bad, 0.0)));
        app.world_mut().resource_mut::<Wind>().velocity.x = bad;
        // A ball that is launched meanwhile flies under the last good gravity.
        let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(9.0, 0.0, 0.0))).id();
        run(&mut app, 1.0);
        let messages: Vec<&str> = app.world().resource::<Refusals>().messages().collect();
        assert_eq!(messages.len(), 2, "{messages:?}");
        for word in ["DrapeGravity", "Wind"] {
            assert!(messages.iter().any(|message| message.contains(word)), "{messages:?} do not name {word}");
        }
        let fallen = (-centre(&app, cloth).y, -ball_position(&app, ball).y);
        assert!(
            (fallen.0 - 0.5 * GRAVITY).abs() < 0.2 && (fallen.1 - 0.5 * GRAVITY).abs() < 1e-3,
            "{fallen:?}"
        );
        app.insert_resource(DrapeGravity(Vec3::ZERO));
        app.world_mut().resource_mut::<Wind>().velocity.x = 0.0;
        let speed = get::<ProjectileState>(&app, ball).velocity().y;
        run(&mut app, 1.0);
        assert!((get::<ProjectileState>(&app, ball).velocity().y - speed).abs() < 0.2, "weightless again");
        assert_eq!(app.world().resource::<Refusals>().messages().len(), 0);
    }
}

/// A cloth with a ball lying in its box, so that both share an island, and a cloth elsewhere.
fn island(app: &mut App) -> (Entity, Entity, Entity) {
    let cloth = app.world_mut().spawn(curtain()).id();
    let ball = Projectile { velocity: Vec3::Z * 3.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.0, -0.3))).id();
    let other = app.world_mut().spawn((free_cloth(), Transform::from_xyz(9.0, 0.0, 0.0))).id();
    step(app, 3);
    (cloth, ball, other)
}

#[test]
fn nonsense_in_particles_is_contained() {
    let nonsense: [fn(&mut Particles); 5] = [
        |particles| particles.set_position(40, Vec3::NAN),
        |particles| particles.set_velocity(40, Vec3::splat(f32::INFINITY)),
        |particles| particles.add_force(40, Vec3::NAN),
        |particles| particles.apply_impulse(40, Vec3::splat(f32::NEG_INFINITY)),
        |particles| particles.set_pin_target(4, Vec3::NAN),
    ];
    for (case, spoil) in nonsense.into_iter().enumerate() {
        let mut app = app();
        let (cloth, ball, other) = island(&mut app);
        spoil(&mut get_mut::<Particles>(&mut app, cloth));
        run(&mut app, 0.5);
        assert_eq!(activity(&app, cloth), Activity::Culled, "case {case}");
        let messages = refusals(&app, cloth);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].contains("Particles") && messages[0].contains("finite"), "{messages:?}");
        assert!(ball_position(&app, ball).is_finite() && centre(&app, other).y < -0.5, "case {case}");
        assert_eq!(counts(&app), (2, 0, 1));
        // Mended by hand.
        let mut particles = get_mut::<Particles>(&mut app, cloth);
        particles.set_position(40, Vec3::ZERO);
        particles.set_velocity(40, Vec3::ZERO);
        assert_mended(&mut app, cloth);
        assert!(get::<Particles>(&app, cloth).is_finite());
    }
}

#[test]
fn nonsense_in_a_ball_is_contained() {
    let nonsense: [fn(&mut ProjectileState); 6] = [
        |ball| ball.set_position(Vec3::NAN),
        |ball| ball.set_velocity(Vec3::splat(f32::INFINITY)),
        |ball| ball.set_spin(Vec3::NAN),
        |ball| ball.add_force(Vec3::NAN),
        |ball| ball.apply_impulse(Vec3::NAN),
        |ball| ball.set_rotation(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)),
    ];
    for (case, spoil) in nonsense.into_iter().enumerate() {
        let mut app = app();
        let (cloth, ball, other) = island(&mut app);
        spoil(&mut get_mut::<ProjectileState>(&mut app, ball));
        run(&mut app, 0.5);
        assert_eq!(activity(&app, ball), Activity::Culled, "case {case}");
        let messages = refusals(&app, ball);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].contains("ProjectileState") && messages[0].contains("finite"), "{messages:?}");
        assert!(get::<Particles>(&app, cloth).is_finite() && centre(&app, other).y < -0.5, "case {case}");
        assert!(get::<Transform>(&app, ball).is_finite());
        let mut state = get_mut::<ProjectileState>(&mut app, ball);
        state.set_position(Vec3::Y * 5.0);
        state.set_velocity(Vec3::ZERO);
        state.set_spin(Vec3::ZERO);
        state.set_rotation(Quat::IDENTITY);
        assert_mended(&mut app, ball);
    }
}

#[test]
fn nonsense_from_a_system_within_the_step_is_contained() {
    let mut app = app();
    let (cloth, ball, other) = island(&mut app);
    let spoil = |mut particles: Query<&mut Particles, With<Spoilt>>| {
        for mut particles in &mut particles {
            particles.set_position(40, Vec3::NAN);
        }
    };
    #[derive(Component)]
    struct Spoilt;
    app.world_mut().entity_mut(cloth).insert(Spoilt);
    app.add_systems(DrapeSubsteps, spoil.after(DrapeSystems::ProjectCollisions));
    // The ball has no business with the cloth now, but is in its island.
    get_mut::<ProjectileState>(&mut app, ball).set_position(Vec3::new(0.0, 0.0, -0.6));
    run(&mut app, 0.5);
    assert_eq!(activity(&app, cloth), Activity::Culled);
    assert_eq!(refusals(&app, cloth).len(), 1);
    assert!(ball_position(&app, ball).is_finite() && centre(&app, other).y < -0.5);
}

#[test]
fn a_body_that_is_spoilt_within_the_step_leaves_the_hits_of_others_right() {
    #[derive(Component)]
    struct Spoilt;
    let mut app = app();
    weightless(&mut app);
    // Two cloths and a ball in one island. The ball hits the second in the step in which the first is spoilt.
    let first = app.world_mut().spawn((free_cloth(), Spoilt, Transform::from_xyz(0.0, 0.0, -0.3))).id();
    let second = app.world_mut().spawn((free_cloth(), Transform::from_xyz(0.0, 0.0, 0.3))).id();
    let ball = Projectile { radius: 0.1, velocity: Vec3::Z * 13.0, ..default() };
    let ball = app.world_mut().spawn(ball).id();
    let spoil = |mut bodies: Query<&mut Particles, With<Spoilt>>| {
        bodies.iter_mut().for_each(|mut particles| particles.set_position(40, Vec3::NAN));
    };
    app.add_systems(DrapeSchedule, spoil.after(DrapeSystems::Substeps).before(DrapeSystems::Finish));
    step(&mut app, 1);
    assert_eq!(refusals(&app, first).len(), 1);
    let hits: Vec<_> =
        app.world().resource::<Hits>().0.iter().map(|hit| (hit.projectile, hit.target)).collect();
    assert_eq!(hits, [(ball, second)]);
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
fn a_teleporting_obstacle_shoots_nothing_off() {
    let mut app = app();
    let obstacle = app.world_mut().spawn((Obstacle::sphere(0.3), Transform::from_xyz(0.0, 0.0, -50.0))).id();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(5.0, 0.4, 0.0))).id();
    step(&mut app, 5);
    // Into the curtain, then under the ball, then off.
    for place in [Vec3::new(0.0, 0.0, -0.1), Vec3::new(5.0, 0.0, 0.0), Vec3::splat(1e5)] {
        get_mut::<Transform>(&mut app, obstacle).translation = place;
        for _ in 0..20 {
            step(&mut app, 1);
            assert!(speed(&app, curtain) < 10.0, "the curtain got a speed of {}", speed(&app, curtain));
            let velocity = get::<ProjectileState>(&app, ball).velocity();
            assert!(velocity.length() < 15.0, "the ball got {velocity}");
        }
    }
    run(&mut app, 2.0);
    let stretch =
        drape_solver::measure::stretch(get::<Particles>(&app, curtain), get::<Sticks>(&app, curtain));
    assert!(stretch.max < 0.05, "{stretch:?}");
}

#[test]
fn a_teleporting_curtain_stays_in_one_piece() {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    step(&mut app, 5);
    get_mut::<Transform>(&mut app, curtain).translation = Vec3::new(80.0, 30.0, 0.0);
    run(&mut app, 5.0);
    let particles = get::<Particles>(&app, curtain);
    assert!(particles.is_finite());
    let stretch = drape_solver::measure::stretch(particles, get::<Sticks>(&app, curtain));
    assert!(stretch.max < 0.05, "{stretch:?}");
    assert!(centre(&app, curtain).distance(Vec3::new(80.0, 30.0, 0.0)) < 0.6, "{}", centre(&app, curtain));
}

/// Lines of the log of this process.
static LOG: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Collector;

impl<S: bevy::log::tracing::Subscriber> Layer<S> for Collector {
    fn on_event(&self, event: &bevy::log::tracing::Event<'_>, _: tracing_subscriber::layer::Context<'_, S>) {
        struct Line(String);
        impl bevy::log::tracing::field::Visit for Line {
            fn record_debug(&mut self, _: &bevy::log::tracing::field::Field, value: &dyn core::fmt::Debug) {
                self.0 += &format!("{value:?}");
            }
        }
        let mut line = Line(format!("{} ", event.metadata().level()));
        event.record(&mut line);
        LOG.lock().expect("no panic while it is held").push(line.0);
    }
}

#[test]
fn a_fault_is_logged_as_an_error_once() {
    let subscriber = tracing_subscriber::registry().with(Collector);
    bevy::log::tracing::subscriber::set_global_default(subscriber).expect("no other test logs");
    let mut app = app();
    // Other tests log, too: this value is this test's own.
    let cloth = app.world_mut().spawn(Cloth { areal_density: -123.25, ..curtain() }).id();
    let transform = app.world_mut().spawn((free_cloth(), Transform::from_xyz(f32::NAN, 0.0, 0.0))).id();
    for _ in 0..60 {
        get_mut::<Cloth>(&mut app, cloth).set_changed();
        get_mut::<Transform>(&mut app, transform).set_changed();
        step(&mut app, 1);
    }
    let log = LOG.lock().expect("no panic while it is held");
    let told = |word: &str| log.iter().filter(|line| line.contains(word)).cloned().collect::<Vec<_>>();
    let lines = told("-123.25");
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].starts_with("ERROR") && lines[0].contains(&cloth.to_string()), "{lines:?}");
    assert_eq!(refusals(&app, transform).len(), 1);
}
