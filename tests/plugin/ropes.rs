//! Ropes that carry a weight, and ropes that are paid out and reeled in.

use bevy::prelude::*;
use bevy_drape::attach::rest_length;
use bevy_drape::attach::{PlaneLock, Winch};
use bevy_drape::body::{Activity, StickProjection, Sticks, StructuralSolve};
use bevy_drape::prelude::*;
use drape_solver::state::measure;

use crate::common::*;

/// Hangs so many kilograms on the last particle of a rope.
fn hang(app: &mut App, rope: Entity, mass: f32) {
    let mut particles = get_mut::<Particles>(app, rope);
    let last = particles.len() - 1;
    particles.set_inverse_mass(last, 1.0 / mass);
}

fn length(app: &App, rope: Entity) -> f32 {
    let particles = get::<Particles>(app, rope);
    (1..particles.len()).map(|i| particles.position(i).distance(particles.position(i - 1))).sum()
}

fn at_rest(app: &App, rope: Entity) -> f32 {
    rest_length(get::<Rope>(app, rope), get::<Sticks>(app, rope)).expect("whole")
}

/// Greatest stretch of a rope of 64 particles and 200 g in five seconds, with ten kilograms at its end, which is let go at `end`.
fn stretch_from(end: Vec3, structural: StructuralSolve) -> f32 {
    let mut app = app();
    let settings = SolverSettings { structural, ..default() };
    let rope = app.world_mut().spawn((Rope::new(Vec3::ZERO, end, 64), settings)).id();
    step(&mut app, 1);
    hang(&mut app, rope, 10.0);
    let mut worst = 0.0_f32;
    for _ in 0..300 {
        step(&mut app, 1);
        worst = worst.max(length(&app, rope) / end.length() - 1.0);
    }
    let stretch = measure::stretch(get::<Particles>(&app, rope), get::<Sticks>(&app, rope));
    println!("{structural:?}, from {end}: {worst:.5} at most, at last {:.5} rms", stretch.rms);
    worst.max(stretch.rms as f32)
}

#[test]
fn a_rope_of_64_with_ten_kilograms_at_its_end_stretches_by_less_than_a_hundredth() {
    for structural in [StructuralSolve::Sweeps, StructuralSolve::Lines] {
        assert!(stretch_from(Vec3::NEG_Y * 2.0, structural) < 0.01);
    }
    // On a swing from 60 degrees it pulls with twice its weight as it passes below. A sweep of a particle a fifty-thousandth of the
    // load leaves three hundredths; a chain is solved as one.
    let aside = Vec3::new(3.0_f32.sqrt(), -1.0, 0.0);
    assert!(stretch_from(aside, StructuralSolve::Sweeps) < 0.05);
    assert!(stretch_from(aside, StructuralSolve::Lines) < 0.001);
}

#[test]
fn a_winch_pays_out_and_reels_in_at_its_speed_between_its_bounds() {
    let mut app = app();
    let winch = Winch { speed: -0.5, least: 0.5, greatest: 1.5 };
    let rope = Rope { linear_density: 0.2, ..Rope::new(Vec3::ZERO, Vec3::NEG_Y, 33) };
    let rope = app.world_mut().spawn((rope, winch, BodySurface { drag: 4.0, ..default() })).id();
    step(&mut app, 1);
    hang(&mut app, rope, 2.0);
    let load = |app: &App| get::<Particles>(app, rope).position(32);
    run(&mut app, 0.5);
    let half_way = at_rest(&app, rope);
    assert!((half_way - 0.75).abs() < 0.02, "{half_way} m after half a second");
    run(&mut app, 2.0);
    assert!((at_rest(&app, rope) - 0.5).abs() < 1e-4, "it stops at its least length");
    assert!((load(&app) - Vec3::NEG_Y * 0.5).length() < 0.01, "the load is lifted to {}", load(&app));
    get_mut::<Winch>(&mut app, rope).speed = 1.0;
    run(&mut app, 4.0);
    assert!((at_rest(&app, rope) - 1.5).abs() < 1e-4, "and at its greatest");
    assert!((load(&app) - Vec3::NEG_Y * 1.5).length() < 0.02, "the load is let down to {}", load(&app));
    // Half a metre of rope more than there was, and of the end its half link; the first particle is pinned.
    let particles = get::<Particles>(&app, rope);
    let mass: f32 = (1..33).map(|i| 1.0 / particles.inverse_mass(i)).sum();
    let expected = 2.0 + 0.2 * 1.5 * (31.0 / 32.0) + 0.2 * 0.5 * 0.5 / 32.0;
    assert!((mass - expected).abs() < 2e-3, "{mass} kg, not {expected} kg");
    let still = length(&app, rope) / 1.5 - 1.0;
    assert!(still.abs() < 0.01, "stretched by {still}");
}

/// All of a step's length was taken in its first substep: a load was thrown up at the winch's speed times the number of substeps, and links folded.
#[test]
fn a_winch_does_not_throw_its_load() {
    let lines = SolverSettings::default();
    let sweeps = SolverSettings { structural: StructuralSolve::Sweeps, ..lines };
    let touching = SolverSettings { self_contact: SelfContact::On, ..sweeps };
    // Sticks of short ropes are listed, those of longer ones lie in rows.
    let cases = [
        (8, sweeps, 0.6),
        (32, sweeps, 0.6),
        (64, sweeps, 0.6),
        (64, lines, 0.6),
        (64, touching, 2.0),
        (64, sweeps, 2.0),
    ];
    for (particles, settings, speed) in cases {
        let mut app = app();
        let rope = Rope::new(Vec3::ZERO, Vec3::NEG_Y * 1.8, particles);
        let winch = Winch { speed: -speed, least: 0.4, greatest: 1.8 };
        let rope = app.world_mut().spawn((rope, Winch { speed: 0.0, ..winch }, settings)).id();
        step(&mut app, 1);
        hang(&mut app, rope, 10.0);
        run(&mut app, 1.0);
        *get_mut::<Winch>(&mut app, rope) = winch;
        let last = particles as usize - 1;
        let (mut fastest, mut slack) = (0.0_f32, 0.0_f32);
        for _ in 0..(60.0 * 1.2 / speed) as usize {
            step(&mut app, 1);
            let particles = get::<Particles>(&app, rope);
            fastest = fastest.max(particles.velocity(last).length());
            slack = slack.max(at_rest(&app, rope) + particles.position(last).y);
            let folds = (1..=last).filter(|&i| particles.position(i).y > particles.position(i - 1).y).count();
            assert_eq!(folds, 0, "{particles} particles: links folded", particles = last + 1);
        }
        println!("{particles} particles: {fastest} m/s at {speed} m/s, slack {slack} m");
        assert!(
            fastest < 1.3 * speed,
            "{particles} particles: a winch of {speed} m/s lifts its load at {fastest} m/s"
        );
        assert!(slack < 0.02, "{particles} particles: the load is {slack} m higher than the rope is long");
    }
}

/// The same between two bodies: a crane's hook that is held by nothing else, and a crate.
#[test]
fn a_winch_between_two_crates_draws_them_together_at_its_speed() {
    let mut app = app();
    weightless(&mut app);
    let [left, right] = [-1.0, 1.0].map(|x| {
        let crate_ = (Obstacle::cuboid(0.2, 0.2, 0.2), DynamicObstacle::cuboid(5.0, Vec3::splat(0.2)));
        app.world_mut().spawn((crate_, Transform::from_xyz(x, 0.0, 0.0))).id()
    });
    let tied = Attachment::first(left).and(Tie::last(right));
    let winch = Winch { speed: -0.5, least: 0.5, greatest: 2.0 };
    app.world_mut().spawn((Rope::new(Vec3::NEG_X, Vec3::X, 64), tied, winch));
    let mut fastest = 0.0_f32;
    let place = |app: &App, entity| get::<Transform>(app, entity).translation.x;
    let mut before = place(&app, right);
    for frame in 0..90 {
        step(&mut app, 1);
        let now = place(&app, right);
        // The first steps build the rope and take hold.
        if frame > 5 {
            fastest = fastest.max((before - now) * 60.0);
        }
        before = now;
    }
    println!("at most {fastest} m/s");
    assert!(fastest < 0.5, "a crate is drawn at {fastest} m/s, its half of the winch's speed is 0.25 m/s");
    assert!(fastest > 0.15, "a crate is drawn at {fastest} m/s only");
    assert!(place(&app, left) > -0.8 && before < 0.8);
}

#[test]
fn a_winch_that_is_none_is_told_and_a_sleeping_rope_wakes_for_one_that_turns() {
    let mut app = app();
    let rope = app.world_mut().spawn((Rope::default(), Winch { least: 0.0, ..Winch::new(1.0) })).id();
    step(&mut app, 2);
    let told = app.world().resource::<Refusals>().iter().any(|refusal| refusal.component == "Winch");
    assert!(told && (at_rest(&app, rope) - 1.0).abs() < 1e-6);
    get_mut::<Winch>(&mut app, rope).set_if_neq(Winch::default());
    run(&mut app, 10.0);
    assert_eq!(get::<Activity>(&app, rope), &Activity::Resting);
    assert!(app.world().resource::<Refusals>().is_empty());
    get_mut::<Winch>(&mut app, rope).speed = 0.2;
    run(&mut app, 1.0);
    assert_eq!(get::<Activity>(&app, rope), &Activity::Active);
    assert!((at_rest(&app, rope) - 1.2).abs() < 0.01);
}

#[test]
fn a_body_in_a_plane_stays_there() {
    let mut app = app();
    app.world_mut().spawn((Obstacle::cuboid(4.0, 0.2, 4.0), Transform::from_xyz(0.0, -0.2, 0.0)));
    // A disc beside the plane's middle would push the ball out of it.
    app.world_mut().spawn((Obstacle::sphere(0.3), Transform::from_xyz(0.15, 0.2, 0.05)));
    let turned = Transform::from_xyz(0.0, 1.2, 0.0).with_rotation(Quat::from_rotation_y(0.5));
    let normal = turned.rotation * Vec3::Z;
    let ball = (SoftBall { stiffness: 0.9999, damping: 3.0, ..SoftBall::new(0.25) }, turned);
    let ball = app.world_mut().spawn((ball, PlaneLock { normal, distance: 0.0 })).id();
    for _ in 0..300 {
        step(&mut app, 1);
        let farthest = get::<Particles>(&app, ball).positions().map(|place| place.dot(normal).abs());
        let farthest = farthest.fold(0.0, f32::max);
        assert!(farthest < 1.1e-5, "{farthest} m out of its plane");
    }
}

/// All of its columns are put into one line: particles in one place have no direction to be parted in.
#[test]
fn a_cloth_that_is_edge_on_to_its_plane_is_a_bundle_and_stays_finite() {
    for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
        let mut app = app();
        let place = Transform::from_rotation(Quat::from_rotation_y(core::f32::consts::FRAC_PI_2));
        let settings = SolverSettings { projection, ..default() };
        let cloth = Cloth::new(1.0, 1.0).with_particles(17, 17);
        app.world_mut().spawn((cloth, settings, PlaneLock::default(), Tearable::default(), place));
        step(&mut app, 240);
        assert!(app.world().resource::<Refusals>().is_empty());
        let mut bodies = app.world_mut().query::<&Particles>();
        assert!(bodies.iter(app.world()).all(|body| body.is_finite() && body.greatest_speed() < 50.0));
    }
}
