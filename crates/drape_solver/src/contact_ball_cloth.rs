//! Balls against cloth: by vertex, edge and face, two-way.
//!
//! The nearest point of a triangle to the ball's centre has barycentric weights `b_i`: one of them is 1 at a
//! vertex, two are above 0 on an edge, three on the face. The same formula then serves all three:
//!
//! ```text
//!        c   ball, radius R           C = n . (c - sum b_i x_i) - (R + t)
//!        |                            if C < 0:  l = -C / (w_c + sum b_i^2 w_i)
//!        | n                              c   += w_c l n
//!   x1---+------x2                        x_i -= w_i b_i l n
//!     \  p  ./
//!      x3'                            momentum is kept exactly: the pushes sum to zero
//! ```
//!
//! Contact with vertices alone would let a ball slip between them when R < spacing / sqrt(2).

use glam::Vec3;

use crate::friction::{combined, slip_taken};
use crate::island::Island;
use crate::nearest::{on_segment, on_triangle};
use crate::overlap::{Overlap, Pace};
use crate::touch::{Other, Projection, record};

/// A ball and a face, or a segment, that may touch in this step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallCloth {
    ball: usize,
    body: usize,
    element: Element,
    depth: f32,
    overlap: Overlap,
    normal: Vec3,
    weights: [f32; 3],
}

impl BallCloth {
    /// The body, by index in the island.
    pub(crate) fn body(&self) -> usize {
        self.body
    }
}

/// A face, or a segment of a body that has no faces.
#[derive(Clone, Copy, Debug)]
enum Element {
    Face([u32; 3]),
    Segment([u32; 2]),
}

impl Element {
    /// Its corners; a segment has its last one twice, with a weight of zero.
    fn corners(self) -> [usize; 3] {
        match self {
            Self::Face(corners) => corners.map(|i| i as usize),
            Self::Segment([a, b]) => [a as usize, b as usize, b as usize],
        }
    }

    /// Weights of the point nearest to `point`.
    fn nearest(self, corners: [Vec3; 3], point: Vec3) -> [f32; 3] {
        match self {
            Self::Face(_) => on_triangle(corners, point),
            Self::Segment(_) => on_segment([corners[0], corners[1]], point),
        }
    }
}

/// Lists the faces and segments that each ball can meet within `dt` seconds, if no particle moves faster
/// than `speed` (m/s).
pub(crate) fn detect(island: &mut Island, dt: f32, gravity: f32, speed: f32) {
    let Island { bodies, balls, context, .. } = island;
    context.ball_cloth.clear();
    for (body_index, body) in bodies.iter().enumerate() {
        let topology = &body.topology;
        let (low, high) = body.particles.bounds();
        for (ball_index, ball) in balls.iter().enumerate() {
            // The ball's own reach, the cloth's, and from any point of a face to its nearest corner.
            let reach =
                ball.reach(dt, gravity) + speed * dt + body.settings.thickness + topology.longest_edge;
            if !(ball.position - reach).cmple(high).all() || !(ball.position + reach).cmpge(low).all() {
                continue;
            }
            let centre = ball.position - body.particles.origin;
            let near = |p: Vec3| p.distance_squared(centre) < reach * reach;
            context.marks.clear();
            context.marks.extend(body.particles.position.iter().map(near));
            let marked = |i: &u32| context.marks[*i as usize];
            let faces = topology.faces.iter().filter(|face| face.iter().any(marked));
            let segments = topology.segments.iter().filter(|ends| ends.iter().any(marked));
            let elements = faces.map(|&f| Element::Face(f)).chain(segments.map(|&s| Element::Segment(s)));
            context.ball_cloth.extend(elements.map(|element| BallCloth {
                ball: ball_index,
                body: body_index,
                element,
                depth: 0.0,
                overlap: Overlap::default(),
                normal: Vec3::ZERO,
                weights: [0.0; 3],
            }));
        }
    }
}

/// Forgets the last substep's depths.
pub(crate) fn begin_substep(island: &mut Island) {
    for contact in &mut island.context.ball_cloth {
        contact.depth = 0.0;
        contact.overlap = Overlap::default();
    }
}

/// Moves balls and cloth apart where they overlap.
pub(crate) fn project(island: &mut Island) {
    let Island { bodies, balls, touches, context } = island;
    let pace = Pace::of(context);
    for contact in &mut context.ball_cloth {
        let (body, ball) = (&mut bodies[contact.body], &mut balls[contact.ball]);
        let centre = ball.position - body.particles.origin;
        let corners = contact.element.corners();
        let positions = corners.map(|i| body.particles.position.get(i));
        let apart = ball.material.radius + body.settings.thickness;
        // Stretched or not, an element lies within its longest side of its first corner.
        let [side, other] = [positions[1], positions[2]].map(|corner| corner.distance_squared(positions[0]));
        let far = apart + side.max(other).sqrt();
        if positions[0].distance_squared(centre) > far * far {
            continue;
        }
        let weights = contact.element.nearest(positions, centre);
        let point = weighted(weights, positions);
        let offset = centre - point;
        let distance_squared = offset.length_squared();
        if distance_squared >= apart * apart {
            continue;
        }
        let distance = distance_squared.sqrt();
        let normal = if distance > 0.0 { offset / distance } else { face_normal(positions) };
        let gap = distance - apart;
        let w = corners.map(|i| body.particles.inverse_mass[i]);
        let felt =
            weights[0] * weights[0] * w[0] + weights[1] * weights[1] * w[1] + weights[2] * weights[2] * w[2];
        let travel = ball.travel();
        let point_travel = weighted(weights, corners.map(|i| body.travel(i)));
        let gap_change = (travel - point_travel).dot(normal);
        let push = contact.overlap.split(-gap, gap_change, pace);
        let weight = ball.inverse_mass + felt;
        let projection = Projection {
            ball: contact.ball,
            other: Other::Body(contact.body),
            gap,
            gap_change,
            ball_position: ball.position,
            ball_travel: travel,
            point: point + body.particles.origin,
            normal,
            impulse: push.fresh / (weight * context.substep),
        };
        record(touches, &projection, context.substep_index, context.substep);
        contact.normal = normal;
        contact.weights = weights;
        // Friction measures the normal push in terms of both sides' motion.
        contact.depth += push.fresh;
        let (fresh, old) = (normal * (push.fresh / weight), normal * (push.old / weight));
        ball.project(fresh * ball.inverse_mass, old * ball.inverse_mass);
        for (corner, weight) in corners.into_iter().zip(weights) {
            let share = -weight * body.particles.inverse_mass[corner];
            body.particles.position.add(corner, (fresh + old) * share);
            body.context.integrated.add(corner, old * share);
        }
    }
}

/// Friction between the ball's surface and the cloth, which also spins the ball.
pub(crate) fn apply_friction(island: &mut Island) {
    let Island { bodies, balls, context, .. } = island;
    for contact in &context.ball_cloth {
        if contact.depth == 0.0 {
            continue;
        }
        let (body, ball) = (&mut bodies[contact.body], &mut balls[contact.ball]);
        let corners = contact.element.corners();
        // To the middle of the cloth: there the two pushes act on one point, and keep the angular momentum.
        let arm = contact.normal * -(ball.material.radius + body.settings.thickness);
        let cloth_travel = weighted(contact.weights, corners.map(|i| body.particles.displacement.get(i)));
        let slip = ball.surface_travel(arm) - cloth_travel;
        let mut felt = 0.0;
        for (corner, weight) in corners.into_iter().zip(contact.weights) {
            felt += weight * weight * body.particles.inverse_mass[corner];
        }
        // Along the normal the pair has the inverse mass w + felt, along the surface about 3.5 w + felt: Coulomb's
        // limit on the push, mu * depth / (w + felt), is turned into one on the slip.
        let across = ball.surface_inverse_mass(arm) + felt;
        let along = ball.inverse_mass + felt;
        let coefficient = combined(ball.material.friction, body.settings.friction);
        let taken = slip_taken(slip, contact.normal, coefficient * across / along, contact.depth);
        let push = taken / across;
        ball.push_surface(arm, -push);
        for (corner, weight) in corners.into_iter().zip(contact.weights) {
            let shift = push * (weight * body.particles.inverse_mass[corner]);
            body.particles.position.add(corner, shift);
            body.particles.displacement.add(corner, shift);
        }
    }
}

fn weighted(weights: [f32; 3], vectors: [Vec3; 3]) -> Vec3 {
    vectors[0] * weights[0] + vectors[1] * weights[1] + vectors[2] * weights[2]
}

fn face_normal([p, q, r]: [Vec3; 3]) -> Vec3 {
    (q - p).cross(r - p).try_normalize().unwrap_or(Vec3::Y)
}
