//! Laws of mechanics of ropes that are tied to dynamic bodies.

use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::engine::*;
use crate::scene::*;

/// A crate that is tied to a rope by its middle does not turn: it swings as a mathematical pendulum.
#[test]
fn a_crate_on_a_rope_swings_with_its_period() {
    let mut app = app();
    let (length, angle) = (1.5_f32, 0.1_f32);
    let at = Quat::from_rotation_z(angle) * Vec3::NEG_Y * length;
    let crate_ = spawn_crate(&mut app, 5.0, at);
    hang(&mut app, Vec3::ZERO, crate_, at);
    let (mut crossings, mut last) = (Vec::new(), at.x);
    for index in 0..600 {
        app.update();
        let now = place(&app, crate_).x;
        if last * now < 0.0 {
            crossings.push((index as f32 + last / (last - now)) * TIMESTEP.as_secs_f32());
        }
        last = now;
    }
    let period = crossings[2] - crossings[0];
    // To second order in the amplitude.
    let expected = core::f32::consts::TAU * (length / G).sqrt() * (1.0 + angle * angle / 16.0);
    assert!((period / expected - 1.0).abs() < 5e-3, "{period} s, not {expected} s");
}

/// One crate tows another, of a hundredth to a hundred times its mass: momentum is kept, and nothing gains energy.
#[test]
fn a_crate_tows_another_and_keeps_momentum() {
    for kilograms in [0.04, 0.4, 4.0, 40.0, 400.0] {
        let mut app = app();
        set_gravity(&mut app, Vec3::ZERO);
        app.insert_resource(DrapeGravity(Vec3::ZERO));
        let first = spawn_crate(&mut app, kilograms, Vec3::X * (1.0 + HALF));
        let second = spawn_crate(&mut app, 4.0, Vec3::NEG_X * HALF);
        let tied = Attachment::last(first).and(Tie::first(second));
        let still = BodySurface { drag: 0.0, ..default() };
        let rope = Rope::new(Vec3::ZERO, Vec3::X, 33);
        let rope = app.world_mut().spawn((rope, still, tied)).id();
        run(&mut app, 0.1);
        let velocity = Vec3::new(2.0, 0.7, 0.0);
        app.world_mut().entity_mut(first).insert(moving(velocity, Vec3::ZERO));
        app.world_mut().entity_mut(second).insert(sleepless());
        let momentum = |app: &App| {
            let particles = app.world().get::<Particles>(rope).expect("it is built");
            let free = (0..particles.len()).filter(|&i| !particles.is_pinned(i));
            let of_rope = free.map(|i| particles.velocity(i) / particles.inverse_mass(i)).sum::<Vec3>();
            of_rope + velocities(app, first)[0] * kilograms + velocities(app, second)[0] * 4.0
        };
        let energy = |app: &App| {
            let of = |body: Entity, mass: f32| {
                let [velocity, spin] = velocities(app, body);
                0.5 * mass * (velocity.length_squared() + spin.length_squared() * HALF * HALF * 2.0 / 3.0)
            };
            of(first, kilograms) + of(second, 4.0)
        };
        let (before, at_start) = (velocity * kilograms, 0.5 * kilograms * velocity.length_squared());
        for _ in 0..200 {
            app.update();
            // Places in single precision carry a velocity of 1e-5 m/s from engine to cloth and back.
            let lost = (momentum(&app) - before).length() / (kilograms + 4.1);
            assert!(lost < 1e-4, "{kilograms} kg: all together are {lost} m/s faster or slower");
            assert!(energy(&app) < 1.001 * at_start, "{kilograms} kg: {} J of {at_start}", energy(&app));
        }
        let towed = velocities(&app, second)[0].x;
        assert!(towed > 0.02 * kilograms.min(4.0), "{kilograms} kg: the other goes at {towed} m/s");
    }
}

/// Two crates hang on a rope over a smooth bar: Atwood's machine.
#[test]
fn two_crates_on_a_rope_over_a_bar_run_as_atwoods_machine() {
    const RADIUS: f32 = 0.2;
    const THICKNESS: f32 = 0.005;
    const SIDE: f32 = 0.7;
    const LINKS: u32 = 60;
    let (light, heavy, density) = (1.0, 1.5, 0.05);
    let mut app = app();
    let lying = Transform::from_rotation(Quat::from_rotation_x(core::f32::consts::FRAC_PI_2));
    app.world_mut().spawn((STATIC, capsule(RADIUS, 1.0), friction(0.0), lying));
    let radius = RADIUS + THICKNESS;
    let arc = core::f32::consts::PI * radius;
    let length = arc + 2.0 * SIDE;
    let rope = Rope { linear_density: density, ..Rope::new(Vec3::ZERO, Vec3::X * length, LINKS + 1) };
    let surface = BodySurface { thickness: THICKNESS, friction: 0.0, static_friction: 0.0, drag: 0.0 };
    let settings = SolverSettings { substeps: 16, ..default() };
    let rope = app.world_mut().spawn((rope, surface, settings)).id();
    app.update();
    let place_of = |i: u32| {
        let along = length * i as f32 / LINKS as f32 - SIDE;
        let angle = core::f32::consts::PI - (along / radius).clamp(0.0, core::f32::consts::PI);
        let down = (-along).max(along - arc).max(0.0);
        Vec3::new(radius * ops::cos(angle), radius * ops::sin(angle) - down, 0.0)
    };
    let mut particles = app.world_mut().get_mut::<Particles>(rope).expect("it is built");
    for i in 0..=LINKS {
        particles.set_motion(i as usize, place_of(i), place_of(i), TIMESTEP.as_secs_f32());
    }
    let ends = [(0, light), (LINKS, heavy)].map(|(end, kilograms)| {
        spawn_crate(&mut app, kilograms, place_of(end) + Vec3::NEG_Y * (HALF + 0.01))
    });
    app.world_mut().entity_mut(rope).insert(Attachment::first(ends[0]).and(Tie::last(ends[1])));
    let seconds = 0.5;
    let before = ends.map(|body| place(&app, body).y);
    run(&mut app, seconds);
    let after = ends.map(|body| place(&app, body).y);
    let way = 0.5 * (after[0] - before[0] + before[1] - after[1]);
    let k = (2.0 * density * G / (light + heavy + density * length)).sqrt();
    let expected = (heavy - light) / (2.0 * density) * (ops::cosh(k * seconds) - 1.0);
    assert!((way / expected - 1.0).abs() < 0.03, "they have gone {way} m, not {expected} m");
}
