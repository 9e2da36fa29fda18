//! The range of a shot.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::motion::ballistics;
use drape_solver::{Ball, BodySettings, Island};

use crate::common::*;

const SPEED: f64 = 20.0;

/// The range in metres of a body at `place`: the distance from its start when it is back at the same height.
fn range(island: &mut Island, dt: f32, place: impl Fn(&Island) -> DVec3) -> f64 {
    let (mut last, mut landed) = (DVec3::ZERO, None);
    run_with(island, &gravity(dt), 5.0, |island, _| {
        let now = place(island);
        if landed.is_none() && now.y <= 0.0 {
            landed = Some(last.lerp(now, last.y / (last.y - now.y)));
        }
        last = now;
    });
    landed.expect("it comes down").length()
}

/// The range on level ground is `v^2 sin(2a) / g` (Galilei 1638). A launched ball has it for every time step; a particle with
/// a given velocity loses half a substep's gravity more.
#[test]
fn the_range_of_a_shot_is_galileis() {
    let dt = 1.0 / 240.0;
    for degrees in [15.0_f64, 45.0, 70.0] {
        let angle = degrees.to_radians();
        let expected = SPEED * SPEED * (2.0 * angle).sin() / f64::from(G);
        let velocity = (ballistics::direction(angle, 0.0) * SPEED).as_vec3();
        let shot = Ball::launch(smooth(0.1, 1.0), Vec3::ZERO, velocity, Vec3::NEG_Y * G, dt);
        let mut island = Island::of_ball(shot.expect("valid"));
        let found = range(&mut island, dt, |island| island.balls[0].position().as_dvec3());
        law(&format!("range of a ball at {degrees} degrees"), found, expected, 2.6e-5);

        let mut body = loose(&[Vec3::ZERO], BodySettings { substeps: 16, ..bare() });
        body.particles.set_velocity(0, velocity);
        let found = range(&mut Island::of_body(body), dt, |island| particles(island).position(0).as_dvec3());
        law(&format!("range of a particle at {degrees} degrees"), found, expected, 4e-4);
    }
}
