//! Bodies that fall through air reach the speed at which drag carries their weight.

use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    BallMaterial, Body, BodySettings, Environment, Island, Particles, StickKind, StickMaterial,
    TopologyBuilder, Wind,
};

use crate::common::*;

const STEPS: [(f32, u32); 5] = [(1.0 / 30.0, 1), (FRAME, 1), (FRAME, 4), (FRAME, 16), (1.0 / 240.0, 2)];

/// S2: drag in proportion to the speed ends the fall at `g / c`, for every step and number of substeps.
#[test]
fn linear_drag_ends_at_gravity_over_drag() {
    let expected = f64::from(G) / 2.0;
    for (dt, substeps) in STEPS {
        let settings = BodySettings { drag: 2.0, substeps, ..bare() };
        let mut island = Island::of_body(loose(&[Vec3::ZERO], settings));
        island.balls.push(ball(BallMaterial { drag: 2.0, ..smooth(0.1, 1.0) }, Vec3::X * 9.0, Vec3::ZERO));
        run(&mut island, &gravity(dt), 8.0);
        let case = format!("{dt:.4} s / {substeps}");
        let found = -particles(&island).velocity(0).y;
        law(&format!("linear drag, particle, {case}"), found.into(), expected, 4e-5);
        law(&format!("linear drag, ball, {case}"), (-island.balls[0].velocity().y).into(), expected, 4e-5);
    }
}

/// A level plate: one face with equal masses at its corners.
fn plate(mass: f32, velocity: Vec3) -> Body {
    let corners = [Vec3::ZERO, Vec3::X * 0.6, Vec3::Z * 0.8];
    let particles = Particles::new(Vec3::ZERO, &corners, &[3.0 / mass; 3]).expect("valid");
    let mut builder = TopologyBuilder::new(&corners);
    builder.family(StickMaterial::rigid(StickKind::Structural), [[0, 1], [1, 2], [2, 0]]).expect("valid");
    builder.faces([[0, 1, 2]]).expect("valid");
    let mut body = Body::new(particles, Arc::new(builder.build().expect("valid")), bare());
    (0..3).for_each(|i| body.particles.set_velocity(i, velocity));
    body
}

/// Drag of moving air, `1/2 rho c A v^2`, ends a plate's fall at `v = sqrt(2 m g / (rho c A))`; before that its speed is
/// `v tanh(g t / v)` (Newton's Principia, book 2, proposition 9). The plate falls in an updraft, and starts at its speed.
#[test]
fn quadratic_drag_ends_at_the_root_of_twice_the_weight() {
    for mass in [0.05_f32, 0.2, 1.0] {
        let updraft = Vec3::Y * 3.0;
        let mut island = Island::of_body(plate(mass, updraft));
        let wind = Wind::new(updraft);
        let strength = wind.air_density * wind.drag_coefficient * 0.24;
        let terminal = f64::from(2.0 * mass * G / strength).sqrt();
        let environment = Environment { wind, ..gravity(1.0 / 480.0) };
        let speed = |island: &Island| {
            let body = particles(island);
            f64::from(updraft.y) - measure::momentum(body).y / measure::mass(body)
        };
        let time = terminal / f64::from(G);
        run(&mut island, &environment, time as f32);
        let on_the_way = terminal * 1.0_f64.tanh();
        law(&format!("quadratic drag on the way, {mass} kg"), speed(&island), on_the_way, 3e-3);
        run(&mut island, &environment, 8.0 * time as f32);
        law(&format!("quadratic drag at the end, {mass} kg"), speed(&island), terminal, 8e-6);
    }
}
