//! States that are not finite are contained, and so is what jumps.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeSubsteps};

use crate::common::*;

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
        drape_solver::state::measure::stretch(get::<Particles>(&app, curtain), get::<Sticks>(&app, curtain));
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
    let stretch = drape_solver::state::measure::stretch(particles, get::<Sticks>(&app, curtain));
    assert!(stretch.max < 0.05, "{stretch:?}");
    assert!(centre(&app, curtain).distance(Vec3::new(80.0, 30.0, 0.0)) < 0.6, "{}", centre(&app, curtain));
}
