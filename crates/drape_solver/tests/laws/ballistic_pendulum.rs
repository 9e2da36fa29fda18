//! A ball that stays in a hanging box lifts it: momentum is kept, and the remaining energy gives the height.

use std::sync::Arc;

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::{
    BallMaterial, Body, BodySettings, Island, Particles, StickKind, StickMaterial, TopologyBuilder,
};

use crate::common::*;

/// Half the side of the box in metres.
const HALF: f32 = 0.2;
/// Length in metres of the four strings that hold the box.
const STRING: f32 = 1.5;

/// A cube of `mass` kg that is open towards +Z, with its middle at the origin and a string at each upper corner, so that it
/// swings without rotating.
fn hanging_box(mass: f32) -> Body {
    let corner = |i: u32| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| HALF * (2.0 * bit as f32 - 1.0)));
    let mut positions: Vec<Vec3> = (0..8).map(corner).collect();
    let upper = [2, 3, 6, 7];
    positions.extend(upper.map(|i| corner(i) + Vec3::Y * STRING));
    let inverse_masses: Vec<f32> = (0..12).map(|i| if i < 8 { 8.0 / mass } else { 0.0 }).collect();
    let pairs = (0..8).flat_map(|b| (0..b).map(move |a| [a, b]));
    let strings = upper.into_iter().zip(8..).map(|(corner, pin)| [corner, pin]);
    let squares = [[0, 1, 3, 2], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let faces = squares.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let rigid = StickMaterial::rigid(StickKind::Structural);
    let mut builder = TopologyBuilder::new(&positions);
    builder
        .family(rigid, pairs)
        .and_then(|builder| builder.family(rigid, strings))
        .and_then(|builder| builder.faces(faces))
        .expect("valid sticks");
    let settings = BodySettings { substeps: 32, iterations: 8, friction: 1.0, thickness: 0.005, ..bare() };
    let particles = Particles::new(Vec3::ZERO, &positions, &inverse_masses).expect("valid particles");
    Body::new(particles, Arc::new(builder.build().expect("valid topology")), settings)
}

/// Robins 1742: a ball of m kg and v m/s that stays in a hanging mass of M kg gives both the speed `V = m v / (m + M)`, and
/// they rise by `V^2 / 2g`.
#[test]
fn a_ball_lifts_the_box_that_catches_it() {
    for (ball_mass, box_mass, speed) in [(1.0, 1.0, 4.0), (0.5, 2.0, 8.0)] {
        let mut island = Island::of_body(hanging_box(box_mass));
        let material =
            BallMaterial { radius: 0.17, mass: ball_mass, friction: 1.0, ..BallMaterial::default() };
        // The ball starts in the middle of the floor, flies a little, and hits the back wall.
        let at = Vec3::new(0.0, 0.175 - HALF, 0.0);
        island.balls.push(ball(material, at, Vec3::NEG_Z * speed));
        let middle =
            |island: &Island| particles(island).positions().take(8).map(Vec3::as_dvec3).sum::<DVec3>() / 8.0;
        let start = middle(&island).y;
        let mut highest = 0.0_f64;
        run_with(&mut island, &gravity(FRAME), 0.8, |island, index| {
            let height = middle(island).y - start;
            highest = highest.max(height);
            let inside = island.balls[0].position().as_dvec3() - middle(island);
            assert!(inside.abs().max_element() < f64::from(HALF), "it fell out: {inside} at step {index}");
        });
        let both = ball_mass * speed / (ball_mass + box_mass);
        let case = format!("{ball_mass} kg into {box_mass} kg at {speed} m/s");
        let expected = f64::from(both * both / (2.0 * G));
        law(&format!("ballistic pendulum's rise in m, {case}"), highest, expected, 6e-3);
    }
}
