//! Laws of mechanics between cloth and the bodies of an engine.

use std::process::{Command, Stdio};

use bevy::prelude::*;
use bevy_drape::drape_solver::state::measure;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

const SIDE: f32 = 0.3;

/// A sheet of 200 g that flies free, and a spinning box that flies at it off its middle. Nothing has weight.
fn hit(kilograms: f32) -> (App, Entity, Entity) {
    let mut app = app();
    set_gravity(&mut app, Vec3::ZERO);
    app.insert_resource(DrapeGravity(Vec3::ZERO)).insert_resource(Wind::default());
    let surface = BodySurface { drag: 0.0, ..default() };
    let cloth = Cloth::new(1.0, 1.0).with_particles(17, 17).with_pins(ClothPins::None);
    let sheet = app
        .world_mut()
        .spawn((cloth, surface, Fabric { areal_density: 0.2, damping: 0.0, ..default() }))
        .id();
    run(&mut app, 0.05);
    let middle = {
        let particles = app.world().get::<Particles>(sheet).expect("it is built");
        particles.positions().sum::<Vec3>() / particles.len() as f32
    };
    let at = Transform::from_translation(middle + Vec3::new(0.15, 0.0, -0.4));
    let motion = moving(Vec3::Z * 6.0, Vec3::new(1.0, 2.0, -1.0));
    let shot = app.world_mut().spawn((box_of(SIDE, kilograms), friction(0.5), motion, at)).id();
    (app, sheet, shot)
}

/// Momentum in kg m/s, angular momentum about the origin in kg m^2/s, and kinetic energy in joules.
fn motion(app: &App, sheet: Entity, shot: Entity, mass: f32) -> (Vec3, Vec3, f64) {
    let world = app.world();
    let particles = world.get::<Particles>(sheet).expect("it is built");
    let ([velocity, spin], place) = (velocities(app, shot), place(app, shot));
    let moment = mass * SIDE * SIDE / 6.0;
    let linear = measure::momentum(particles).as_vec3() + velocity * mass;
    let angular =
        measure::angular_momentum(particles).as_vec3() + place.cross(velocity) * mass + spin * moment;
    let energy = 0.5 * (mass * velocity.length_squared() + moment * spin.length_squared());
    (linear, angular, measure::kinetic_energy(particles) + f64::from(energy))
}

#[test]
fn a_box_and_a_free_sheet_keep_momentum_and_gain_no_energy() {
    for mass in [0.002, 0.02, 0.2, 2.0, 20.0] {
        let (mut app, sheet, shot) = hit(mass);
        app.update();
        let (linear, angular, start) = motion(&app, sheet, shot, mass);
        for index in 0..48 {
            app.update();
            let (now, turning, energy) = motion(&app, sheet, shot, mass);
            let lost = now.distance(linear) / linear.length();
            assert!(lost < 1e-5, "{mass} kg: {lost} of the momentum at step {index}");
            let lost = turning.distance(angular) / linear.length();
            assert!(lost < 6e-3, "{mass} kg: {lost} m of angular momentum at step {index}");
            assert!(energy < 1.0001 * start, "{mass} kg: {start} to {energy} J at step {index}");
        }
        let (.., end) = motion(&app, sheet, shot, mass);
        assert!(end < 0.999 * start, "{mass} kg: it has hit the sheet");
    }
}

/// After a central hit of a ball on a box at rest they separate by Newton's law of restitution, and keep momentum.
#[test]
fn a_ball_rebounds_from_bodies_by_newtons_law_of_restitution() {
    const SPEED: f32 = 4.0;
    for (kilograms, coefficient) in [0.1, 1.0, 10.0].into_iter().flat_map(|m| [(m, 0.0), (m, 0.6)]) {
        let what = format!("{kilograms} kg, {coefficient}");
        let mut app = app();
        set_gravity(&mut app, Vec3::ZERO);
        app.insert_resource(DrapeGravity(Vec3::ZERO));
        let surface = (restitution(coefficient), friction(0.0));
        let body = (box_of(SIDE, kilograms), surface, sleepless());
        let shot = app.world_mut().spawn((body, Transform::from_xyz(0.0, 0.0, 1.0))).id();
        let projectile = Projectile {
            velocity: Vec3::Z * SPEED,
            mass: 1.0,
            radius: 0.1,
            drag: 0.0,
            restitution: coefficient,
            ..default()
        };
        let ball = app.world_mut().spawn((projectile, Transform::default())).id();
        run(&mut app, 0.4);
        let before = place(&app, ball).z;
        app.update();
        let after = (place(&app, ball).z - before) / TIMESTEP.as_secs_f32();
        let pushed = velocities(&app, shot)[0].z;
        let apart = (pushed - after) / SPEED;
        assert!((apart - coefficient).abs() < 0.01, "{what}: they separate by {apart}");
        let momentum = after + kilograms * pushed;
        assert!((momentum / SPEED - 1.0).abs() < 1e-4, "{what}: {momentum} kg m/s");
    }
}

/// A sheet on a slope of 20 degrees lies still above a friction of tan 20, and slides below it with `g (sin - f cos)`.
#[test]
fn a_sheet_on_a_slope_obeys_coulombs_law() {
    let slope = Quat::from_rotation_z(-20.0_f32.to_radians());
    let along = slope * Vec3::X;
    let (sine, cosine) = (-along.y, along.x);
    let lying = |height| {
        let flat = slope * Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        Transform::from_translation(slope * (Vec3::Y * height)).with_rotation(flat)
    };
    for part in [0.8, 1.1] {
        let coefficient = part * sine / cosine;
        let mut app = app();
        let below = (STATIC, half_space(), friction(coefficient));
        app.world_mut().spawn((below, Transform::from_rotation(slope)));
        let cloth = Cloth::new(0.8, 0.8).with_particles(17, 17).with_pins(ClothPins::None);
        let surface = BodySurface { friction: coefficient, drag: 0.0, ..default() };
        let sheet = app.world_mut().spawn((cloth, surface, lying(0.006))).id();
        run(&mut app, 0.5);
        let speed = |app: &App| {
            let particles = app.world().get::<Particles>(sheet).expect("it is built");
            particles.velocities().sum::<Vec3>().dot(along) / particles.len() as f32
        };
        let before = speed(&app);
        run(&mut app, 0.5);
        let acceleration = (speed(&app) - before) / 0.5;
        let expected = (G * (sine - coefficient * cosine)).max(0.0);
        assert!((acceleration - expected).abs() < 0.03, "{part}: {acceleration} m/s^2, not {expected}");
    }
}

/// Places of all particles and bodies after a thousand steps of crates that fall into a net and onto sheets.
fn bits_after_a_thousand_steps() -> Vec<u32> {
    let mut app = app();
    ground(&mut app);
    let mut bodies = Vec::new();
    for i in 0..4 {
        let at = Transform::from_xyz(0.35 * (i % 2) as f32, 1.0 + 0.4 * i as f32, 0.1 * i as f32);
        bodies.push(app.world_mut().spawn((DYNAMIC, cuboid(Vec3::splat(0.3)), at)).id());
    }
    let sheets = [0.3, 0.7].map(|height| sheet(&mut app, height));
    for _ in 0..1000 {
        app.update();
    }
    let world = app.world();
    let particles = sheets.map(|sheet| world.get::<Particles>(sheet).expect("it is built"));
    let places = particles.iter().flat_map(|particles| particles.positions());
    let bodies = bodies.iter().map(|&body| place(&app, body));
    places.chain(bodies).flat_map(|place| place.to_array()).map(f32::to_bits).collect()
}

/// Here, and in processes of one thread and of several.
#[test]
fn the_same_scene_gives_the_same_bits_of_cloth_and_bodies() {
    let line = || format!("bits: {:?}", bits_after_a_thousand_steps());
    if std::env::var_os(THREADS).is_some() {
        return println!("{}", line());
    }
    let others = ["1", "4"].map(|threads| {
        let mut command = Command::new(std::env::current_exe().expect("this test"));
        command.args([
            "--exact",
            "laws::the_same_scene_gives_the_same_bits_of_cloth_and_bodies",
            "--nocapture",
        ]);
        command.env(THREADS, threads).env("RAYON_NUM_THREADS", threads).stdout(Stdio::piped());
        (threads, command.spawn().expect("it runs"))
    });
    let line = line();
    for (threads, process) in others {
        let output = process.wait_with_output().expect("it ends");
        let printed = String::from_utf8_lossy(&output.stdout);
        assert!(printed.contains("bits: "), "{threads} threads: {printed}");
        assert!(printed.contains(&line), "other bits with {threads} threads");
    }
}
