//! Balls against cloth: by vertex, edge and face, two-way, with [friction](crate::state::friction).
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
//!
//! Design: `docs/design/ball_cloth.md`.

use glam::Vec3;

use crate::broad_phase::ball_search::{BallAndBody, BallSearch, Corners};
use crate::constants::{PASSING_SLACK, TETHERLESS_REACH};
use crate::contact::ball_cloth_query::BallClothContact;
use crate::contact::ccd::Passage;
use crate::contact::depenetration::{InitialOverlap, PushOutRate};
use crate::contact::event::{BallProjection, Other, Touch, add_impulse, begin, is_known};
use crate::contact::hit_substeps::is_near_bounds;
use crate::contact::impact_zone::BallAndFace;
use crate::geometry::nearest_triangle::{on_segment, on_triangle, weighted};
use crate::simd::isa::Isa;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::particles::Particles;
use crate::state::substep::Substep;

/// The contacts of an island's balls with its cloths and ropes.
#[derive(Clone, Debug, Default)]
pub(crate) struct BallClothContacts {
    pub pairs: Vec<BallCloth>,
    search: BallSearch,
    /// Positions of the particles that a ball touches, kept while tethers are projected.
    touched: Vec<(usize, Vec3)>,
}

impl BallClothContacts {
    /// Drops the contacts of a body that was taken out of the island.
    pub fn forget(&mut self, body: usize) {
        self.pairs.retain(|contact| contact.body != body);
        self.forget_search();
    }

    /// Makes the next round test every pair.
    pub fn forget_search(&mut self) {
        self.search.forget(self.pairs.len());
    }
}

/// A ball and a face, or a segment, that may touch in this step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BallCloth {
    pub ball: usize,
    pub body: usize,
    pub element: FaceOrLink,
    /// Ball and element at the start of the substep.
    pub start: BallAndFace,
    depth: f32,
    overlap: InitialOverlap,
    normal: Vec3,
    weights: [f32; 3],
}

impl BallCloth {
    /// If the last substep pushed it: the slots of the element's corners (a segment repeats its last one), the weights
    /// of the contact point, and the penetration depth in metres.
    pub(crate) fn pushed(&self) -> Option<([usize; 3], [f32; 3], f32)> {
        (self.depth > 0.0).then(|| (self.element.corners(), self.weights, self.depth))
    }
}

/// A face, or a segment of a body that has no faces, by the slots of its corners.
#[derive(Clone, Copy, Debug)]
pub(crate) enum FaceOrLink {
    Face([u32; 3]),
    Link([u32; 2]),
}

impl FaceOrLink {
    /// Slots of the corners; a segment repeats its last one, with a weight of zero.
    pub fn corners(self) -> [usize; 3] {
        match self {
            Self::Face(corners) => corners.map(|i| i as usize),
            Self::Link([a, b]) => [a as usize, b as usize, b as usize],
        }
    }

    /// Weights of the midpoint.
    pub fn middle(self) -> [f32; 3] {
        match self {
            Self::Face(_) => [1.0 / 3.0; 3],
            Self::Link(_) => [0.5, 0.5, 0.0],
        }
    }

    /// Weights of the point nearest to `point`.
    pub fn nearest(self, corners: [Vec3; 3], point: Vec3) -> [f32; 3] {
        match self {
            Self::Face(_) => on_triangle(corners, point),
            Self::Link(_) => on_segment([corners[0], corners[1]], point),
        }
    }
}

/// Lists the faces and segments that each ball can meet within `dt` seconds, if no particle moves faster
/// than `speed` (m/s).
pub(crate) fn detect(
    contacts: &mut BallClothContacts,
    bodies: &[Body],
    balls: &[Ball],
    isa: Isa,
    [dt, gravity, speed]: [f32; 3],
) {
    let BallClothContacts { pairs, search, .. } = contacts;
    pairs.clear();
    search.clear();
    for (body_index, body) in bodies.iter().enumerate() {
        let topology = &body.topology;
        let bounds = body.particles.bounds();
        let layers = body.layers;
        for (ball_index, ball) in balls.iter().enumerate().filter(|(_, ball)| ball.layers.interact(layers)) {
            // The reach of the ball, that of the cloth, and the distance from any point of a face to its nearest
            // corner.
            let reach =
                ball.reach(dt, gravity) + speed * dt + body.settings.thickness + topology.longest_edge;
            if !is_near_bounds(ball, reach, bounds) {
                continue;
            }
            let centre = ball.position - body.particles.origin;
            let pair = BallAndBody { ball: ball_index, body: body_index };
            let listed = pairs.len();
            search.detect(pair, (centre, reach), (body, isa), listed, |corners| {
                pairs.push(BallCloth {
                    ball: ball_index,
                    body: body_index,
                    element: match corners {
                        Corners::Face(slots) => FaceOrLink::Face(slots),
                        Corners::Segment(slots) => FaceOrLink::Link(slots),
                    },
                    start: BallAndFace::default(),
                    depth: 0.0,
                    overlap: InitialOverlap::default(),
                    normal: Vec3::ZERO,
                    weights: [0.0; 3],
                });
            });
        }
    }
}

/// Forgets the last substep's depths.
pub(crate) fn begin_substep(contacts: &mut BallClothContacts) {
    for contact in &mut contacts.pairs {
        contact.depth = 0.0;
        contact.overlap = InitialOverlap::default();
    }
}

/// A ball and an element that overlap, now and at the start of the substep.
struct Overlapping {
    weights: [f32; 3],
    normal: Vec3,
    /// Metres between the surfaces; negative.
    gap: f32,
    gap_change: f32,
    point: Vec3,
    start: BallAndFace,
    apart: f32,
}

impl Overlapping {
    fn find(contact: &BallCloth, ball: &Ball, body: &Body) -> Option<Self> {
        let corners = contact.element.corners();
        let now = BallAndFace::of(contact, ball, body);
        let apart = ball.material.radius + body.settings.thickness;
        let travels = corners.map(|i| body.travel(i));
        let travel = ball.travel();
        // Stretched or not, an element lies within its longest side of its first corner.
        let sides = [now.corners[1], now.corners[2]].map(|corner| corner.distance_squared(now.corners[0]));
        let far = apart + sides[0].max(sides[1]).sqrt() + (travel - travels[0]).length();
        if now.corners[0].distance_squared(now.centre) > far * far {
            return None;
        }
        let [a, b, c] = now.corners;
        let start = BallAndFace {
            centre: now.centre - travel,
            corners: [a - travels[0], b - travels[1], c - travels[2]],
        };
        let weights = contact.element.nearest(now.corners, now.centre);
        let point = weighted(weights, now.corners);
        let offset = now.centre - point;
        let side = match contact.element {
            FaceOrLink::Face(_) => passed_side(&start, &now, PASSING_SLACK * ball.material.radius),
            FaceOrLink::Link(_) => None,
        };
        let (normal, distance) = if let Some(side) = side {
            let normal = face_normal(now.corners) * side;
            (normal, normal.dot(offset))
        } else {
            let distance_squared = offset.length_squared();
            if distance_squared >= apart * apart {
                return None;
            }
            let distance = distance_squared.sqrt();
            (if distance > 0.0 { offset / distance } else { face_normal(now.corners) }, distance)
        };
        let gap_change = (travel - weighted(weights, travels)).dot(normal);
        Some(Self { weights, normal, gap: distance - apart, gap_change, point, start, apart })
    }

    /// Overlap at the start of the substep in metres, negative if there was none.
    fn at_start(&self, element: FaceOrLink) -> f32 {
        let BallAndFace { centre, corners } = self.start;
        self.apart - centre.distance(weighted(element.nearest(corners, centre), corners))
    }

    fn projection(&self, contact: &BallCloth, ball: &Ball, body: &Body) -> BallProjection {
        BallProjection {
            ball: contact.ball,
            other: Other::Body(contact.body),
            gap: self.gap,
            gap_change: self.gap_change,
            ball_position: ball.position,
            ball_travel: ball.travel(),
            point: self.point + body.particles.origin,
            normal: self.normal,
        }
    }
}

/// Finds overlaps right after integration and moves nothing: the same overlaps that the first projection of a substep
/// finds. Returns the number of faces and segments that were tested.
pub(crate) fn find_all(
    contacts: &mut BallClothContacts,
    bodies: &[Body],
    balls: &[Ball],
    isa: Isa,
    mut found: impl FnMut(BallClothContact),
) -> usize {
    let BallClothContacts { pairs, search, .. } = contacts;
    search.begin_round();
    let mut count = 0;
    while let Some(index) = search.next(balls, bodies, isa) {
        count += 1;
        let contact = &pairs[index];
        let (ball, body) = (&balls[contact.ball], &bodies[contact.body]);
        if let Some(overlapping) = Overlapping::find(contact, ball, body) {
            let Overlapping { weights, normal, gap, .. } = overlapping;
            let slots = contact.element.corners().map(|slot| slot as u32);
            let (ball, body) = (contact.ball, contact.body);
            found(BallClothContact { ball, body, slots, weights, normal, depth: -gap });
        }
    }
    count
}

/// The side (1 or -1, along the face's normal) that a ball's centre came from if it has passed through the face
/// between `start` and `now`. Sticks can pull a taut cloth past the middle of a fast ball within one sweep; then
/// the nearest way out is the wrong one.
fn passed_side(start: &BallAndFace, now: &BallAndFace, slack: f32) -> Option<f32> {
    let height = |placed: &BallAndFace| face_normal(placed.corners).dot(placed.centre - placed.corners[0]);
    let corners =
        |placed: &BallAndFace| [placed.centre, placed.corners[0], placed.corners[1], placed.corners[2]];
    let passage = Passage { start: corners(start), now: corners(now) };
    let ([centre, a, b, c], side) = passage.at_sign_change(height(start), height(now))?;
    // The way of the ball may lead through the triangle, or beside it.
    let nearest = weighted(on_triangle([a, b, c], centre), [a, b, c]);
    (nearest.distance_squared(centre) <= slack * slack).then_some(side)
}

/// Moves balls and cloth apart where they overlap.
pub(crate) fn project(
    contacts: &mut BallClothContacts,
    bodies: &mut [Body],
    balls: &mut [Ball],
    touches: &mut Vec<Touch>,
    substep: Substep,
) {
    let rate = PushOutRate::of(substep);
    let BallClothContacts { pairs, search, .. } = contacts;
    search.begin_round();
    while let Some(index) = search.next(balls, bodies, substep.isa) {
        let contact = &pairs[index];
        let (ball_index, body_index) = (contact.ball, contact.body);
        let (body, ball) = (&bodies[body_index], &balls[ball_index]);
        let Some(found) = Overlapping::find(contact, ball, body) else {
            continue;
        };
        if !is_known(touches, ball_index, Other::Body(body_index)) {
            // This is the first contact of the pair: the element that the ball reached first gives its time and place.
            let of_pair = |c: &&BallCloth| c.ball == ball_index && c.body == body_index;
            let all = pairs.iter().filter(of_pair).filter_map(|c| {
                Overlapping::find(c, ball, body).map(|found| found.projection(c, ball, body))
            });
            if let Some(first) = all.min_by(|p, q| p.fraction().total_cmp(&q.fraction())) {
                begin(touches, &first, substep.index, substep.duration);
            }
        }
        let contact = &mut pairs[index];
        let (body, ball) = (&mut bodies[body_index], &mut balls[ball_index]);
        let Overlapping { weights, normal, gap, gap_change, .. } = found;
        let element = contact.element;
        let push = contact.overlap.split(-gap, gap_change, || found.at_start(element), rate);
        let corners = element.corners();
        let total = ball.inverse_mass + inverse_mass_of_point(weights, corners, body);
        add_impulse(
            touches,
            ball_index,
            Other::Body(body_index),
            push.with_velocity / (total * substep.duration),
        );
        contact.normal = normal;
        contact.weights = weights;
        // Friction measures the normal push in terms of both sides' motion.
        contact.depth += push.with_velocity;
        let (contact_push, position_push) =
            (normal * (push.with_velocity / total), normal * (push.position_only / total));
        ball.project(contact_push * ball.inverse_mass, position_push * ball.inverse_mass);
        let heaviest_share =
            corners.into_iter().zip(weights).map(|(i, w)| w * body.particles.inverse_mass[i]);
        let nearer = ball.inverse_mass + heaviest_share.fold(0.0, f32::max);
        search.note_push((push.with_velocity + push.position_only) / total * nearer);
        for (corner, weight) in corners.into_iter().zip(weights) {
            let share = -weight * body.particles.inverse_mass[corner];
            // The displacement resolves finer steps than the position, so the push is added to both: the cloth must
            // gain the momentum that the ball loses.
            body.particles.displacement.add(corner, contact_push * share);
            body.particles.position.add(corner, (contact_push + position_push) * share);
            body.context.integrated.add(corner, (contact_push + position_push) * share);
        }
    }
}

/// Keeps the positions of the particles that a ball touches in this substep.
///
/// Tethers must not move them: a tether takes a particle back in one projection, perhaps through the middle of the
/// ball. The particles around keep their tethers, and sticks hold these particles to them.
pub(crate) fn note_touched(
    contacts: &mut BallClothContacts,
    balls: &[Ball],
    body: usize,
    particles: &Particles,
) {
    let BallClothContacts { pairs, touched, .. } = contacts;
    touched.clear();
    for contact in pairs.iter().filter(|contact| contact.body == body) {
        let ball = &balls[contact.ball];
        let near = TETHERLESS_REACH * ball.material.radius;
        let centre = ball.position - particles.origin;
        let places = contact.element.corners().map(|i| (i, particles.position.get(i)));
        let is_near = |&(_, p): &(usize, Vec3)| p.distance_squared(centre) < near * near;
        touched.extend(places.into_iter().filter(is_near));
    }
}

/// Puts these particles back.
pub(crate) fn put_back(contacts: &BallClothContacts, particles: &mut Particles) {
    for &(i, position) in &contacts.touched {
        particles.position.set(i, position);
    }
}

/// Inverse mass of the point of an element with these `weights`, in 1/kg.
fn inverse_mass_of_point(weights: [f32; 3], corners: [usize; 3], body: &Body) -> f32 {
    let mut sum = 0.0;
    for (corner, weight) in corners.into_iter().zip(weights) {
        sum += weight * weight * body.particles.inverse_mass[corner];
    }
    sum
}

/// Friction between the ball's surface and the cloth, which also spins the ball.
pub(crate) fn apply_friction(contacts: &BallClothContacts, bodies: &mut [Body], balls: &mut [Ball]) {
    for contact in &contacts.pairs {
        if contact.depth == 0.0 {
            continue;
        }
        let (body, ball) = (&mut bodies[contact.body], &mut balls[contact.ball]);
        let corners = contact.element.corners();
        // The arm ends in the middle of the cloth: both pushes act on one point there, which keeps angular momentum.
        let arm = contact.normal * -(ball.material.radius + body.settings.thickness);
        let cloth_travel = weighted(contact.weights, corners.map(|i| body.particles.displacement.get(i)));
        let slip = ball.surface_travel(arm) - cloth_travel;
        let inverse_mass_of_point = inverse_mass_of_point(contact.weights, corners, body);
        // With w_p for the point of the cloth, the pair's inverse mass is w + w_p along the normal and about 3.5 w +
        // w_p along the surface. Coulomb's limit on the push, mu * depth / (w + w_p), becomes a limit on the slip.
        let across = ball.surface_inverse_mass(arm) + inverse_mass_of_point;
        let along = ball.inverse_mass + inverse_mass_of_point;
        let friction = ball.material.surface_friction().with(body.settings.surface_friction());
        let taken = friction.scaled(across / along).slip_taken(slip, contact.normal, contact.depth);
        let push = taken / across;
        ball.push_surface(arm, -push);
        for (corner, weight) in corners.into_iter().zip(contact.weights) {
            let shift = push * (weight * body.particles.inverse_mass[corner]);
            body.particles.position.add(corner, shift);
            body.particles.displacement.add(corner, shift);
        }
    }
}

fn face_normal([p, q, r]: [Vec3; 3]) -> Vec3 {
    (q - p).cross(r - p).try_normalize().unwrap_or(Vec3::Y)
}
