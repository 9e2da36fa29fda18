//! A contact of two parts of surfaces: its push and its friction.
//!
//! The nearest points of the two are weighted means of corners, `sum a_i x_i` and `sum b_i x_i`, and one formula serves
//! corners on faces and edges on edges:
//!
//! ```text
//!   corner on face          edge on edge           C = n . (sum a_i x_i - sum b_i x_i) - distance
//!        o                    o                    if C < 0:  l = -C / sum w_i (a_i or b_i)^2
//!        | n               o--|--o                            x_i += w_i l a_i n   or   x_i -= w_i l b_i n
//!     /--+--\                 o
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use glam::{Vec3, Vec4};

use crate::contact::effective_mass::effective_inverse_mass;
use crate::contact::surface::pair::{Kind, Pair};
use crate::contact::surface::points::Points;
use crate::geometry::nearest_triangle::weighted;
use crate::state::body::Body;

/// Two parts that touch or may pass each other in a substep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    pub pair: Pair,
    /// Weights of the nearest points and the unit vector between them: at the start, and from the first push on there.
    pub weights: [f32; 4],
    pub normal: Vec3,
    is_followed: bool,
    /// Distance at the start, in metres.
    pub at_start: f32,
    /// Depth that motion made, summed over the projections, in metres.
    pub depth: f32,
}

/// Distance from which on two parts are not near each other, in distances that they keep.
const FAR: f32 = 1.5;

/// Way along the nearest points, of the length of the distance between them, whose direction still counts as that of the
/// start: at most 72 degrees off.
const LEAST_COSINE: f32 = 0.3;

impl Contact {
    /// True if the two were near each other at the start, or come near in free flight: what sticks alone draw together from
    /// farther away has other layers between.
    pub fn is_in_reach(&self, flights: &[Vec4]) -> bool {
        let Pair { ids, distance, .. } = self.pair;
        let height =
            || weighted(self.weights, ids.map(|id| flights[id as usize].truncate())).dot(self.normal);
        self.at_start < FAR * distance || height() < FAR * distance
    }

    /// Moves the two apart to the distance that they had at the start, or that they keep if that is less; what is to become velocity
    /// by `relaxation` times as much. Only the sum of a substep's pushes is a push: what others have moved apart since is given back.
    pub fn push(&mut self, points: &mut Points, relaxation: f32) {
        let goal = self.at_start.min(self.pair.distance);
        if !self.is_followed {
            if self.height(points) >= goal {
                return;
            }
            self.follow(points);
        }
        let way = goal - self.height(points);
        if way <= 0.0 && self.depth == 0.0 {
            return;
        }
        // No more becomes velocity than stops the two, so a push adds no energy. What is left of the way was made in position only.
        let apart = weighted(self.weights, points.motions(self.pair.ids)).dot(self.normal);
        let stop = if way > 0.0 { way.min((-apart).max(0.0)) } else { way.max(-apart.max(0.0)) };
        let moving = (relaxation * stop).max(-self.depth);
        if self.move_apart(points, moving, (way - stop).max(0.0)) {
            self.depth += moving;
        }
    }

    /// Moves the two apart by `way` metres more than they were at the start, but not beyond the distance that they keep: in
    /// position only.
    pub fn recover(&self, points: &mut Points, way: f32) {
        let depth = (self.at_start + way).min(self.pair.distance) - self.height(points);
        if depth > 0.0 {
            self.move_apart(points, 0.0, depth);
        }
    }

    /// Moves the two apart by ways in metres of which the first becomes velocity; false if both are pinned.
    fn move_apart(&self, points: &mut Points, moving: f32, shift: f32) -> bool {
        let ids = self.pair.ids;
        let masses = points.inverse_masses(ids);
        let total = effective_inverse_mass(self.weights, masses);
        if total == 0.0 {
            return false;
        }
        let [moving, shift] = [moving, shift].map(|part| self.normal * (part / total));
        for k in 0..4 {
            let share = self.weights[k] * masses[k];
            points.move_by(ids[k] as usize, moving * share);
            points.shift_by(ids[k] as usize, shift * share);
        }
        true
    }

    /// Height of the nearest point of the first above that of the second, in metres.
    fn height(&self, points: &Points) -> f32 {
        // All four numbers of a place at once.
        let ends = self.pair.ids.map(|id| points.end[id as usize]);
        weighted(self.weights, ends).truncate().dot(self.normal)
    }

    /// Takes the nearest points and the normal from where the two are now, before the first push.
    fn follow(&mut self, points: &Points) {
        let Pair { ids, kind, .. } = self.pair;
        let now = points.ends(ids);
        let nearest = kind.nearest(now);
        let way = weighted(nearest, now);
        let length = way.length();
        // A direction that has turned away shows that the two have passed: the start's one leads back.
        if way.dot(self.normal) > LEAST_COSINE * length {
            (self.weights, self.normal) = (nearest, way / length);
        }
        self.is_followed = true;
    }

    /// Friction: shortens the slip of this substep.
    pub fn apply_friction(&self, points: &mut Points, bodies: &[Body]) {
        if self.depth == 0.0 {
            return;
        }
        let Pair { ids, .. } = self.pair;
        let rough = |id: u32| bodies[points.body[id as usize] as usize].settings.surface_friction();
        let friction = rough(ids[0]).with(rough(ids[3]));
        let slip = weighted(self.weights, points.motions(ids));
        let masses = points.inverse_masses(ids);
        let total = effective_inverse_mass(self.weights, masses);
        let push = friction.slip_taken(slip, self.normal, self.depth) / total;
        for k in 0..4 {
            points.move_by(ids[k] as usize, -push * (self.weights[k] * masses[k]));
        }
    }

    /// The corners that are lowest in the first part and highest in the second, along the normal, and the gap between
    /// them in metres. As long as it is above zero, a plane lies between the two.
    pub fn gap(&self, points: &Points) -> ([u32; 2], f32) {
        let Pair { ids, kind, .. } = self.pair;
        let heights = points.ends(ids).map(|end| end.dot(self.normal));
        let first = kind.first_corners();
        let lowest = (1..first).fold(0, |low, k| if heights[k] < heights[low] { k } else { low });
        let highest = (first + 1..4).fold(first, |high, k| if heights[k] > heights[high] { k } else { high });
        // Differences of places are finer than differences of heights.
        let [low, high] = points.ends([ids[lowest], ids[highest]]);
        ([ids[lowest], ids[highest]], (low - high).dot(self.normal))
    }

    /// False if the gap is wider than the least for sure: a quick look, as nearly all pairs of a jam keep apart.
    pub fn may_pass(&self, points: &Points) -> bool {
        let [a, b, c, d] = self.pair.ids.map(|id| points.end[id as usize]);
        let normal = self.normal.extend(0.0);
        let ways = [b - a, c - a, d - a];
        let [b, c, d] = ways.map(|way| way.dot(normal));
        let gap = match self.pair.kind {
            Kind::CornerFace => -b.max(c).max(d),
            Kind::EdgeEdge => b.min(0.0) - c.max(d),
        };
        let size: Vec4 = ways.into_iter().map(Vec4::abs).sum();
        gap < self.least_gap() + ROUNDING * size.element_sum()
    }

    /// The gap that is left at least, in metres.
    pub fn least_gap(&self) -> f32 {
        (0.1 * self.at_start).max(0.002 * self.pair.distance).min(0.9 * self.at_start)
    }

    /// Particles of the two bodies that were pushed apart, if there are two: the corners of the greatest weights.
    pub fn pushed_bodies(&self, points: &Points) -> Option<([(usize, usize); 2], Vec3, f32)> {
        let Pair { ids, kind, .. } = self.pair;
        let heaviest = |range: core::ops::Range<usize>| {
            range.reduce(|a, b| if self.weights[b].abs() > self.weights[a].abs() { b } else { a })
        };
        let first = kind.first_corners();
        let ends = [heaviest(0..first)?, heaviest(first..4)?];
        let particles = ends.map(|k| {
            let body = points.body[ids[k] as usize];
            (body as usize, (ids[k] - points.first[body as usize]) as usize)
        });
        let are_two = particles[0].0 != particles[1].0;
        (self.depth > 0.0 && are_two).then_some((particles, self.normal, self.depth))
    }
}

/// Part of a size that heights may be off by rounding, at most.
const ROUNDING: f32 = 1e-6;

/// The contact of two parts whose nearest points at the start have these weights.
pub(crate) fn contact(pair: Pair, weights: [f32; 4], way: Vec3) -> Option<Contact> {
    let at_start = way.length();
    // Parts at a distance of zero have no direction: contacts around them move them apart.
    (at_start > LEAST_DISTANCE).then(|| Contact {
        pair,
        weights,
        normal: way / at_start,
        is_followed: false,
        at_start,
        depth: 0.0,
    })
}

/// Distance in metres below which the direction between two points is rounding.
const LEAST_DISTANCE: f32 = 1e-8;

impl Kind {
    /// Weights of the four corners, from those of the nearest points: of the sides of the face, or along the edges.
    pub fn weights(self, [s, t]: [f32; 2]) -> [f32; 4] {
        match self {
            Self::CornerFace => [1.0, s + t - 1.0, -s, -t],
            Self::EdgeEdge => [1.0 - s, s, t - 1.0, -t],
        }
    }
}
