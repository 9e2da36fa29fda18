//! Balls against balls.
//!
//! Design: `docs/design/contacts.md`.

use glam::Vec3;

use crate::contact::depenetration::{InitialOverlap, PushOutRate};
use crate::contact::event::{BallProjection, Other, Touch, add_impulse, record};
use crate::contact::restitution::Impact;
use crate::state::ball::{Ball, SURFACE_INVERSE_MASS};
use crate::state::combine_rule::CombineRule;
use crate::state::substep::Substep;

/// Two balls that may touch in this step; `a < b`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallPair {
    a: usize,
    b: usize,
    depth: f32,
    overlap: InitialOverlap,
    impact: Impact,
    /// Unit vector from `b` to `a`.
    normal: Vec3,
}

/// Lists the pairs that can meet within `dt` seconds.
pub(crate) fn detect(pairs: &mut Vec<BallPair>, balls: &[Ball], dt: f32, gravity: f32) {
    pairs.clear();
    for (b, second) in balls.iter().enumerate() {
        for (a, first) in balls[..b].iter().enumerate() {
            let reach = first.reach(dt, gravity) + second.reach(dt, gravity);
            let is_near = first.position.distance_squared(second.position) < reach * reach;
            if is_near && first.layers.interact(second.layers) {
                pairs.push(BallPair {
                    a,
                    b,
                    depth: 0.0,
                    overlap: InitialOverlap::default(),
                    impact: Impact::default(),
                    normal: Vec3::ZERO,
                });
            }
        }
    }
}

/// Forgets the last substep's depths.
pub(crate) fn begin_substep(pairs: &mut [BallPair]) {
    for pair in pairs {
        pair.depth = 0.0;
        pair.overlap = InitialOverlap::default();
        pair.impact = Impact::default();
    }
}

/// Moves overlapping balls apart, each by its share of inverse mass.
pub(crate) fn project(
    pairs: &mut [BallPair],
    balls: &mut [Ball],
    touches: &mut Vec<Touch>,
    substep: Substep,
) {
    let rate = PushOutRate::of(substep);
    for pair in pairs {
        let Ok([a, b]) = balls.get_disjoint_mut([pair.a, pair.b]) else {
            continue;
        };
        let apart = a.position - b.position;
        let distance = apart.length();
        let depth = a.material.radius + b.material.radius - distance;
        if depth <= 0.0 {
            continue;
        }
        // Coincident centres have no direction of their own: one ball goes up.
        pair.normal = if distance > 0.0 { apart / distance } else { Vec3::Y };
        let travel = a.travel() - b.travel();
        let gap_change = travel.dot(pair.normal);
        let at_start = || a.material.radius + b.material.radius - (apart - travel).length();
        let push = pair.overlap.split(depth, gap_change, at_start, rate);
        pair.depth += push.with_velocity;
        let weight = a.inverse_mass + b.inverse_mass;
        let (contact, position_only) =
            (pair.normal * (push.with_velocity / weight), pair.normal * (push.position_only / weight));
        let sides = [(pair.a, pair.b, &*a, 1.0), (pair.b, pair.a, &*b, -1.0)];
        for (ball_index, other, ball, sign) in sides {
            let normal = pair.normal * sign;
            let projection = BallProjection {
                ball: ball_index,
                other: Other::Ball(other),
                gap: -depth,
                gap_change,
                ball_position: ball.position,
                ball_travel: ball.travel(),
                point: ball.position - normal * ball.material.radius,
                normal,
            };
            let impulse = push.with_velocity / (weight * substep.duration);
            record(touches, &projection, impulse, substep.index, substep.duration);
            pair.impact.note(gap_change, projection.fraction());
        }
        a.project(contact * a.inverse_mass, position_only * a.inverse_mass);
        b.project(contact * -b.inverse_mass, position_only * -b.inverse_mass);
    }
}

/// Moves balls that met in this substep apart again, as fast as their restitution says.
pub(crate) fn rebound(pairs: &mut [BallPair], balls: &mut [Ball], touches: &mut [Touch], substep: Substep) {
    for pair in pairs {
        let Ok([a, b]) = balls.get_disjoint_mut([pair.a, pair.b]) else {
            continue;
        };
        let rule = CombineRule::default();
        let restitution = rule.combine(a.material.restitution, b.material.restitution);
        let Some(rebound) = pair.impact.rebound(restitution, substep.duration) else {
            continue;
        };
        let weight = a.inverse_mass + b.inverse_mass;
        let change = rebound.displacement - (a.displacement - b.displacement).dot(pair.normal);
        if change <= 0.0 {
            // Other contacts have already moved them apart faster than this, and no contact pulls.
            continue;
        }
        pair.depth += change;
        for (ball, other, sign) in [(pair.a, pair.b, 1.0), (pair.b, pair.a, -1.0)] {
            add_impulse(touches, ball, Other::Ball(other), change / (weight * substep.duration));
            let ball = &mut balls[ball];
            let share = pair.normal * (sign * ball.inverse_mass / weight);
            ball.displacement += share * change;
            ball.position += share * rebound.position;
        }
    }
}

/// Friction between the surfaces, which also turns the balls.
pub(crate) fn apply_friction(pairs: &[BallPair], balls: &mut [Ball]) {
    for pair in pairs {
        let Ok([a, b]) = balls.get_disjoint_mut([pair.a, pair.b]) else {
            continue;
        };
        if pair.depth == 0.0 {
            continue;
        }
        let (arm_a, arm_b) = (pair.normal * -a.material.radius, pair.normal * b.material.radius);
        let slip = a.surface_travel(arm_a) - b.surface_travel(arm_b);
        let friction = a.material.surface_friction().with(b.material.surface_friction());
        let taken = friction.scaled(SURFACE_INVERSE_MASS).slip_taken(slip, pair.normal, pair.depth);
        let push = taken / (SURFACE_INVERSE_MASS * (a.inverse_mass + b.inverse_mass));
        a.push_surface(arm_a, -push);
        b.push_surface(arm_b, push);
    }
}
