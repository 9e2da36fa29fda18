//! S1: the Verlet step, in free flight.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::measure;
use drape_solver::{Island, Particles};

use crate::common::*;

/// Position after `n` substeps of `h` by the discrete closed form `x0 + n v h + a h^2 n (n + 1) / 2`.
fn discrete(start: DVec3, velocity: DVec3, acceleration: DVec3, h: f64, n: f64) -> DVec3 {
    start + velocity * (n * h) + acceleration * (h * h * n * (n + 1.0) / 2.0)
}

/// S1, S15: the flight follows the textbook recurrence in closed form, for any time step and number of substeps.
#[test]
#[cfg_attr(miri, ignore = "Miri flies a part of the way only")]
fn free_flight_is_the_discrete_closed_form() {
    let (start, velocity) = (Vec3::new(1.0, 2.0, -3.0), Vec3::new(4.0, 8.0, -2.0));
    for (dt, substeps) in [(1.0 / 60.0, 1), (1.0 / 60.0, 16), (1.0 / 32.0, 3), (1.0 / 240.0, 1)] {
        let mut body = loose(&[start], drape_solver::BodySettings { substeps, ..bare() });
        body.particles.set_velocity(0, velocity);
        let mut island = Island::of_body(body);
        run(&mut island, &gravity(dt), 1.0);
        let n = f64::from((1.0 / dt).round()) * f64::from(substeps);
        let h = f64::from(dt / substeps as f32);
        let expected = discrete(start.as_dvec3(), velocity.as_dvec3(), DVec3::NEG_Y * f64::from(G), h, n);
        let found = particles(&island).position(0).as_dvec3();
        let case = format!("free flight in m, {dt:.4} s / {substeps}");
        law_of_error(&case, (found - expected).length(), 3e-5);
        // Trap 1: `a dt^2 / 2` would halve gravity, and end metres away from this.
        let parabola = drape_solver::motion::ballistics::position_at(
            start.as_dvec3(),
            velocity.as_dvec3(),
            DVec3::NEG_Y * f64::from(G),
            n * h,
        );
        assert!((found - parabola).length() < 0.51 * f64::from(G) * h, "dt {dt} / {substeps}");
    }
}

/// S1, trap 2: two seconds of free fall from a height of 100 m at 960 Hz, where the textbook form in single
/// precision is metres wrong.
#[test]
#[cfg_attr(miri, ignore = "Miri flies a part of the way only")]
fn free_fall_in_small_steps_far_up_keeps_its_gravity() {
    let h = 1.0 / 960.0_f32;
    let mut island = Island::of_body(loose(&[Vec3::Y * 100.0], bare()));
    run(&mut island, &gravity(h), 2.0);
    let down = DVec3::NEG_Y * f64::from(G);
    let expected = discrete(DVec3::Y * 100.0, DVec3::ZERO, down, f64::from(h), 1920.0);
    let error = (particles(&island).position(0).y as f64 - expected.y).abs();
    assert!(error < 1e-3, "{error} m wrong");
}

/// S1: far from the centre of the world a body flies exactly as it does there.
#[test]
fn flight_is_as_fine_ten_kilometres_away() {
    let flight = |origin: Vec3| {
        let mut body = loose(&[Vec3::new(0.1, 0.2, 0.3)], bare());
        body.particles.set_velocity(0, Vec3::new(0.01, 0.0, 0.0));
        body.particles.translate(origin);
        let mut island = Island::of_body(body);
        run(&mut island, &gravity(1.0 / 960.0), 1.0);
        particles(&island).local_position(0)
    };
    assert_eq!(flight(Vec3::ZERO), flight(Vec3::new(10_240.0, 0.0, -5120.0)));
}

/// S3: there is no second copy of the positions to swap; `x*` is derived from the displacement.
#[test]
fn the_previous_position_is_where_the_particle_was_a_substep_ago() {
    let mut body = loose(&[Vec3::ZERO], bare());
    body.particles.set_velocity(0, Vec3::new(3.0, 4.0, 5.0));
    let mut island = Island::of_body(body);
    let mut before = particles(&island).position(0);
    run_with(&mut island, &gravity(FRAME), 0.5, |island, _| {
        let particles = particles(island);
        assert!((particles.previous_position(0) - before).length() < 1e-6);
        before = particles.position(0);
    });
}

/// S1: `a = f / m`; a force acts through one whole step and is then cleared.
#[test]
fn a_force_acts_for_one_step_and_gives_impulse_over_mass() {
    for substeps in [1, 4, 16] {
        let settings = drape_solver::BodySettings { substeps, ..bare() };
        let positions = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
        let mut island = Island::of_body(joined(&positions, &[0.5, 4.0, 0.0], &[], settings));
        let force = Vec3::new(3.0, -6.0, 1.0);
        for i in 0..3 {
            island.bodies[0].particles.add_force(i, force);
        }
        run(&mut island, &weightless(FRAME), FRAME);
        run(&mut island, &weightless(FRAME), 0.5);
        let particles = particles(&island);
        assert!((particles.velocity(0) - force * FRAME * 0.5).length() < 1e-6);
        assert!((particles.velocity(1) - force * FRAME * 4.0).length() < 1e-5);
        assert_eq!(particles.position(2), positions[2], "a pinned particle feels no force");
    }
}

/// S32: an impulse moves `x*`: the velocity changes by `impulse / mass` at once, the position does not.
#[test]
fn impulses_add_up_to_momentum() {
    let mut island = Island::of_body(joined(&[Vec3::ZERO, Vec3::X], &[0.25, 2.0], &[], bare()));
    let mut given = Vec3::ZERO;
    for (i, impulse) in [(0, Vec3::X), (1, Vec3::new(0.0, 2.0, -1.0)), (0, Vec3::NEG_Z)] {
        island.bodies[0].particles.apply_impulse(i, impulse);
        given += impulse;
        run(&mut island, &weightless(FRAME), 0.1);
    }
    assert!((momentum(&island) - given.as_dvec3()).length() < 1e-6 * f64::from(given.length()));
}

/// S1: a cloth in free flight keeps its energy.
#[test]
fn a_falling_cloth_keeps_its_energy() {
    let cloth = drape_solver::ClothBuilder::new(1.0, 1.0, 9, 9).build(bare()).expect("valid");
    let mut island = Island::of_body(cloth);
    let environment = gravity(1.0 / 240.0);
    let down = environment.gravity;
    run(&mut island, &environment, environment.dt);
    let energy = |island: &Island| {
        // Displacements are velocities half a step ago. So the recurrence keeps the energy with the potential in the
        // middle of the last step.
        let body = &island.bodies[0];
        let shift = measure::momentum(&body.particles).dot(down.as_dvec3()) * f64::from(environment.dt) / 2.0;
        measure::mechanical_energy(body, down) + shift
    };
    let before = energy(&island);
    run(&mut island, &environment, 2.0);
    let gained = energy(&island) - before;
    assert!(gained.abs() < 1e-3 * kinetic_energy(&island), "{gained} J gained");
}

/// S1: a pinned particle stays, to the last bit.
#[test]
fn pinned_particles_do_not_fall() {
    let positions = [Vec3::new(0.1, 0.7, 0.3), Vec3::ZERO];
    let mut island = Island::of_body(joined(&positions, &[0.0, 1.0], &[[0, 1]], bare()));
    run(&mut island, &gravity(FRAME), 2.0);
    assert_eq!(particles(&island).position(0), positions[0]);
    assert_eq!(particles(&island).velocity(0), Vec3::ZERO);
}

/// Accessors lose nothing: a particle built at rest is at rest.
#[test]
fn without_forces_nothing_moves() {
    let positions = [Vec3::new(0.1, 0.7, 0.3), Vec3::new(1.5, 0.0, 0.0)];
    let particles_at = Particles::new(Vec3::ZERO, &positions, &[1.0, 1.0]).expect("valid");
    let mut island = Island::of_body(joined(&positions, &[1.0, 1.0], &[[0, 1]], bare()));
    run(&mut island, &weightless(FRAME), 1.0);
    for i in 0..2 {
        assert_eq!(particles(&island).position(i), particles_at.position(i));
    }
}
