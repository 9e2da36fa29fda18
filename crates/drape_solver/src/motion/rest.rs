//! Time at rest of bodies and balls, and new origins for bodies that have travelled.
//!
//! Design: `docs/design/rest_and_islands.md`.

use crate::constants::{RECENTRE_DISTANCE, REST_SPEED};
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::measure::mean_square_speed;
use crate::state::particles::Particles;

/// Counts the time for which the body's kinetic energy has stayed below the threshold of rest. One step above it
/// restarts the count: a curtain at its turning point is slow for a moment only. An edit or a force restarts it too: a
/// body that was just woken has had no time to gain speed.
///
/// What lies on itself is judged by the mean square of its ways in the step, in m², if that is given: contacts of layers leave
/// a speed of some centimetres a second that moves nothing, as in each substep they hold up what it is about to lower.
pub(crate) fn account_body(body: &mut Body, dt: f32, mean_square_way: Option<f32>) {
    let by_ways = mean_square_way.map(|squared| squared / (dt * dt));
    let squared = by_ways.unwrap_or_else(|| mean_square_speed(&body.particles));
    let still = !body.particles.disturbed && squared < REST_SPEED * REST_SPEED;
    body.context.still_for = if still { body.context.still_for + dt } else { 0.0 };
}

/// The same for a ball, whose spin counts as the speed of its surface.
pub(crate) fn account_ball(ball: &mut Ball, dt: f32) {
    let surface = ball.spin.length_squared() * ball.material.radius * ball.material.radius;
    let still = !ball.disturbed && ball.velocity().length_squared() + surface < REST_SPEED * REST_SPEED;
    ball.still_for = if still { ball.still_for + dt } else { 0.0 };
}

/// Gives particles that travelled far a new local origin, on whole metres so that little is rounded.
pub(crate) fn recentre(particles: &mut Particles) {
    let (low, high) = particles.bounds();
    let middle = (low + high) * 0.5;
    let away = (middle - particles.origin).abs().max_element();
    if away > RECENTRE_DISTANCE && away.is_finite() {
        particles.recentre(middle.round());
    }
}
