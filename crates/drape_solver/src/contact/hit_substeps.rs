//! The number of substeps that fast or heavy things need, so that none passes through a cloth.
//!
//! Design: `docs/design/ball_cloth.md`.

use glam::Vec3;

use crate::constants::{BALL_TRAVEL_PER_SUBSTEP, CONTACT_MARGIN, HIT_SUBSTEPS_KEPT, MAX_HIT_SUBSTEPS};
use crate::constraint::direct::grid_lines::stick_iterations;
use crate::state::ball::{Ball, BallMaterial};
use crate::state::body::Body;
use crate::state::particle_stats::MassStats;

/// Greatest approach of two bodies in a substep, in lengths of an edge.
const PATH_OF_SUBSTEP: f32 = 0.25;

/// The number of substeps for a ball that may meet a cloth on its `path` (metres) in a step; 0 if it meets none.
///
/// In a substep `h` sticks pull the patch of cloth in front of the ball, of mass `m`, back by `s`, and a projection
/// then gives the ball the momentum `m s / h`. N relaxations of sticks make N + 1 projections, which act as a spring of stiffness
/// `(N + 1) m / h^2`. A ball of mass `M` and speed `v` stretches it by `v h sqrt(M / ((N + 1) m))` before it stops. If
/// that is more than a part of its radius, the sticks pull the cloth past its middle, and the ball passes through.
///
/// The hit slows the ball, and the number would fall while the cloth is still stretched, so it falls only slowly. It
/// must not grow then, either: that would stiffen a stretched spring and make energy.
pub(crate) fn of_ball(ball: &Ball, bodies: &[Body], path: f32) -> f32 {
    let BallMaterial { radius, mass, .. } = ball.material;
    let mut wanted = 0.0_f32;
    for body in bodies.iter().filter(|body| body.layers.interact(ball.layers)) {
        let reach = radius + 2.0 * path + CONTACT_MARGIN;
        if !is_near_bounds(ball, reach, body.particles.bounds()) {
            continue;
        }
        let MassStats { free_count, free_mass, .. } = &body.particles.masses;
        if *free_count == 0 {
            continue;
        }
        // The longest side of a face is the diagonal of its square; a rope lies across the width of the ball.
        let side = body.topology.longest_edge.max(f32::MIN_POSITIVE);
        let covered = if body.topology.faces.is_empty() {
            2.0 * radius / side
        } else {
            // A sweep carries a pull to the next particles only, so only the rim of a large patch pulls.
            let across = core::f32::consts::SQRT_2 * radius / side;
            core::f32::consts::PI * (across * across).min(2.0 * across)
        };
        let patch = covered.max(1.0) * (free_mass / *free_count as f64) as f32;
        // Cloth with lines that is swept near a rigid body relaxes more often than this, and errs on the safe side.
        let relaxations = stick_iterations(&body.particles, &body.topology, &body.settings).len();
        let ratio = mass / (patch * (relaxations + 1) as f32);
        wanted = wanted.max(path / (radius * BALL_TRAVEL_PER_SUBSTEP) * ratio.sqrt());
        wanted = wanted.max(ball.hit_substeps * HIT_SUBSTEPS_KEPT);
    }
    wanted.min(MAX_HIT_SUBSTEPS)
}

/// The number of substeps for bodies that fly at each other. A corner that passes deep through another cloth shares its
/// velocity with many corners that have passed as well, and no order of projections separates them; shallow passages
/// are moved back.
pub(crate) fn of_bodies(bodies: &[Body], dt: f32) -> f32 {
    let mut wanted = 0.0_f32;
    for (place, a) in bodies.iter().enumerate().filter(|(_, body)| body.has_self_contact()) {
        for b in bodies[place + 1..].iter().filter(|body| body.has_self_contact()) {
            let [(low_a, high_a), (low_b, high_b)] = [a, b].map(|body| body.particles.bounds());
            let apart = a.settings.thickness + b.settings.thickness;
            let path = (a.particles.greatest_speed() + b.particles.greatest_speed()) * dt;
            let reach = path + apart;
            if !((low_a - reach).cmple(high_b) & (high_a + reach).cmpge(low_b)).all() {
                continue;
            }
            let edge = a.topology.longest_edge.min(b.topology.longest_edge);
            let most = apart.max(PATH_OF_SUBSTEP * edge);
            // The exact speed costs a pass over all particles, so it is computed only where it may matter.
            if path > most {
                let way = a.particles.mean_velocity() - b.particles.mean_velocity();
                wanted = wanted.max(way.length() * dt / most);
            }
        }
    }
    wanted
}

/// True if a ball is within `reach` (metres) of a box with these corners.
pub(crate) fn is_near_bounds(ball: &Ball, reach: f32, (low, high): (Vec3, Vec3)) -> bool {
    (ball.position - reach).cmple(high).all() && (ball.position + reach).cmpge(low).all()
}
