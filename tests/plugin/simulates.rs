//! Adding the plugin to an app is enough for cloths, ropes and balls to move as physics has it.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::prelude::*;

use crate::common::*;

#[test]
fn a_curtain_hangs_from_its_pins() {
    let mut app = app();
    // Held out flat in front of the rail, so that it has some way to fall.
    let transform =
        Transform::from_xyz(0.0, 2.0, 0.0).with_rotation(Quat::from_rotation_x(core::f32::consts::FRAC_PI_2));
    let curtain = app.world_mut().spawn((curtain(), transform, quiet())).id();
    step(&mut app, 1);
    let pins: Vec<Vec3> = get::<Particles>(&app, curtain).positions().take(9).collect();
    run(&mut app, 8.0);
    let particles = get::<Particles>(&app, curtain);
    for (i, &pin) in pins.iter().enumerate() {
        assert!(particles.position(i).distance(pin) < 1e-6, "pin {i} moved");
    }
    for (i, position) in particles.positions().enumerate() {
        let (below, row) = (2.0 - position.y, i / 9);
        assert!((below - row as f32 / 8.0).abs() < 0.02, "row {row} hangs {below} m below the rail");
    }
}

#[test]
fn a_free_cloth_falls_as_a_stone_does() {
    let mut app = app();
    let cloth = app.world_mut().spawn((free_cloth(), dragless())).id();
    step(&mut app, 1);
    let start = centre(&app, cloth).y;
    let speed = -get::<Particles>(&app, cloth).velocity(0).y;
    run(&mut app, 1.0);
    let fallen = start - centre(&app, cloth).y;
    // From the speed after one step, of one substep's mean: half a substep's gravity is the tolerance.
    let expected = speed + 0.5 * GRAVITY;
    assert!((fallen - expected).abs() < 0.02, "it fell {fallen} m, a stone falls {expected} m");
}

#[test]
fn a_rope_swings_down_and_keeps_its_length() {
    let mut app = app();
    let rope = Rope::new(Vec3::new(0.0, 3.0, 0.0), Vec3::new(1.0, 3.0, 0.0), 17);
    let rope = app.world_mut().spawn((rope, quiet())).id();
    run(&mut app, 0.3);
    let tip = get::<Particles>(&app, rope).position(16);
    assert!(tip.y < 2.9 && tip.x > 0.1, "it swings: {tip}");
    run(&mut app, 10.0);
    let particles = get::<Particles>(&app, rope);
    assert!(particles.position(0).distance(Vec3::new(0.0, 3.0, 0.0)) < 1e-6);
    assert!(particles.position(16).distance(Vec3::new(0.0, 2.0, 0.0)) < 0.01, "{}", particles.position(16));
}

#[test]
fn a_ball_flies_on_the_parabola_to_the_end_of_every_step() {
    let mut app = app();
    let (start, velocity) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(8.0, 9.0, -4.0));
    let ball = Projectile { velocity, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_translation(start))).id();
    for count in 1..=90 {
        step(&mut app, 1);
        let t = count as f32 * STEP;
        let expected = start + velocity * t + 0.5 * Vec3::NEG_Y * GRAVITY * t * t;
        let position = ball_position(&app, ball);
        assert!(position.distance(expected) < 1e-4, "after {t} s at {position}, expected {expected}");
        assert_eq!(get::<Transform>(&app, ball).translation, position);
    }
}

#[test]
fn drag_brings_a_ball_to_its_terminal_velocity() {
    let mut app = app();
    let ball = app.world_mut().spawn(Projectile { drag: 2.0, ..default() }).id();
    run(&mut app, 6.0);
    let velocity = get::<ProjectileState>(&app, ball).velocity();
    assert!((velocity.y + GRAVITY / 2.0).abs() < 0.01, "{velocity}");
}

#[test]
fn wind_carries_a_free_cloth_off() {
    let mut app = app();
    weightless(&mut app);
    app.world_mut().resource_mut::<Wind>().velocity = Vec3::new(0.0, 0.0, 5.0);
    let cloth = app.world_mut().spawn((free_cloth(), dragless())).id();
    run(&mut app, 2.0);
    let velocity = (centre(&app, cloth).z, speed(&app, cloth));
    assert!(velocity.0 > 2.0 && velocity.1 < 5.1, "it is {} m away and {} m/s fast", velocity.0, velocity.1);
}

#[test]
fn cloth_lies_on_an_obstacle_at_the_distance_of_its_thickness() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let flat = Transform::from_xyz(0.0, 0.2, 0.0)
        .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let surface = BodySurface { thickness: 0.01, ..quiet() };
    let cloth = app.world_mut().spawn((free_cloth(), flat, surface)).id();
    settle(&mut app, cloth);
    for position in get::<Particles>(&app, cloth).positions() {
        assert!((position.y - 0.01).abs() < 2e-3, "{position}");
    }
}

#[test]
fn a_scaled_and_turned_obstacle_is_where_its_transform_says() {
    let mut app = app();
    // A cube of half a metre, stretched to a plank of 2 m x 0.2 m x 1 m and put upright.
    let plank = Transform::from_xyz(0.0, 1.0, 0.0)
        .with_scale(Vec3::new(4.0, 0.4, 2.0))
        .with_rotation(Quat::from_rotation_z(core::f32::consts::FRAC_PI_2));
    app.world_mut().spawn((Obstacle::cuboid(0.5, 0.5, 0.5), plank));
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 3.0, 0.0))).id();
    run(&mut app, 0.55);
    // The top of the upright plank is at 1 m + 1 m; the ball's centre stops a radius above.
    assert!((ball_position(&app, ball).y - 2.15).abs() < 0.02, "{}", ball_position(&app, ball));
}

#[test]
fn a_turntable_takes_along_what_lies_on_it() {
    let mut app = app();
    // Scaled: the scale that is read back from a turning matrix wavers in its last digits.
    let table = Transform::from_scale(Vec3::new(1.3, 0.7, 1.1));
    let table = app.world_mut().spawn((Obstacle::cuboid(5.0, 1.0 / 0.7, 5.0).with_friction(1.0), table)).id();
    let start = Vec3::new(1.5, 0.65, 0.0);
    let ball = Projectile { friction: 1.0, rolling_resistance: 10.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_translation(start))).id();
    step(&mut app, 10);
    for _ in 0..120 {
        get_mut::<Transform>(&mut app, table).rotate_y(0.3 * STEP);
        step(&mut app, 1);
    }
    // Two seconds at 0.3 rad/s. Friction is strong: the ball takes a twentieth of a second to get to 0.45 m/s.
    let position = ball_position(&app, ball);
    let angle = (-position.z).atan2(position.x);
    assert!((angle - 0.6).abs() < 0.06, "the table turned by 0.6 rad, the ball went along by {angle}");
}

#[test]
fn the_transform_plugin_makes_no_difference() {
    let run_app = |with_transforms: bool| {
        let mut app = app();
        if with_transforms {
            app.add_plugins(TransformPlugin);
        }
        let cloth = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 1.0, 0.0))).id();
        app.world_mut().spawn((Obstacle::sphere(0.3), Transform::from_xyz(0.0, 0.6, 0.1)));
        run(&mut app, 1.0);
        hash(&app, &[cloth])
    };
    assert_eq!(run_app(true), run_app(false));
}
