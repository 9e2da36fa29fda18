//! Untangling of layers that cross, with an edge through a face.
//!
//! The layers do not show on which side of each other they belong. But the line along which they cross must become
//! shorter until it is gone (Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection
//! contour minimization"). The line enters the triangle of the edge at the edge, along the direction `R`, which lies in
//! both planes:
//!
//! ```text
//!        \   |E           the edge (E) is moved against the face (unit normal N) along
//!     ----\--x----> R
//!          \ |              G = R - 2 (E . R) / (E . N) N
//!           \|
//! ```
//!
//! An edge inside a cloth has two triangles, whose moves cancel where the cloth is flat. So the rim of the cloth goes
//! back, and so do the tips of parts that have poked through.
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

use crate::contact::effective_mass::effective_inverse_mass;
use crate::contact::surface::points::Points;
use crate::contact::surface::rows::{
    CENTRE, CENTRES, COLUMNS, Columns, EDGE, EDGES_TOO, FACE, FACE_SCALE, FACES_ONLY, Row, SHARPNESS, gather,
    vector,
};
use crate::simd::columns::LANES;
use crate::simd::isa::Kernel;
use crate::simd::lanes::{first_lanes, load, set_lanes};
use crate::state::star::{EDGES, FACES, NONE, Star};

/// An edge through a face: the numbers of their particles, and of the third corners of the edge's own faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub edge: [u32; 2],
    pub face: [u32; 3],
    sides: [u32; 2],
}

impl Crossing {
    /// The particles at the crossing.
    pub fn corners(&self) -> [u32; 5] {
        let ([a, b], [c, d, e]) = (self.edge, self.face);
        [a, b, c, d, e]
    }

    /// Moves the edge by about `way` (metres) against the face for each of its own faces, in position only.
    pub fn move_apart(&self, points: &mut Points, way: f32) {
        for side in self.sides.into_iter().filter(|&side| side != NONE) {
            let Some((weights, direction)) = self.direction(points, side) else { continue };
            let corners = self.corners();
            let masses = points.inverse_masses(corners);
            let total = effective_inverse_mass(weights, masses);
            if total == 0.0 {
                continue;
            }
            for k in 0..5 {
                let share = direction * (way * weights[k] * masses[k] / total);
                points.shift_by(corners[k] as usize, share);
            }
        }
    }

    /// Weights of the corners at the place of the crossing, and the direction in which the edge moves against the face,
    /// about as long as 1; none if the two cross no more.
    fn direction(&self, points: &Points, side: u32) -> Option<([f32; 5], Vec3)> {
        let face = points.ends(self.face);
        let [p, q, third] = points.ends([self.edge[0], self.edge[1], side]);
        let normal = (face[1] - face[0]).cross(face[2] - face[0]).normalize_or_zero();
        let heights = [p, q].map(|end| normal.dot(end - face[0]));
        if heights[0] * heights[1] >= 0.0 {
            return None;
        }
        let along = heights[0] / (heights[0] - heights[1]);
        let edge = q - p;
        let [u, v, w] = inside(face, normal, p + edge * along)?;
        let line = edge.cross(third - p).cross(normal).normalize_or_zero();
        // From the edge into its triangle.
        let inward = (third - p) - edge * ((third - p).dot(edge) / edge.length_squared());
        let line = if line.dot(inward) < 0.0 { -line } else { line };
        let direction = edge.normalize_or_zero();
        let steep = direction.dot(normal);
        let share = if steep == 0.0 { 0.0 } else { (2.0 * direction.dot(line) / steep).clamp(-2.0, 2.0) };
        Some(([1.0 - along, along, -u, -v, -w], line - normal * share))
    }
}

/// Weights of a point in the plane of a triangle, if it lies inside.
fn inside([a, b, c]: [Vec3; 3], normal: Vec3, point: Vec3) -> Option<[f32; 3]> {
    let area = |p: Vec3, q: Vec3| normal.dot((p - point).cross(q - point));
    let areas = [area(b, c), area(c, a), area(a, b)];
    let sum: f32 = areas.iter().sum();
    (sum > 0.0 && areas.iter().all(|&area| area >= 0.0)).then(|| areas.map(|area| area / sum))
}

/// Lists the edges of first stars that pass through faces of second ones at the start, sixteen pairs at a time.
pub(crate) struct FindCrossings<'a> {
    pub rows: &'a [Row],
    pub stars: &'a [Star],
    pub pairs: &'a [[u32; 2]],
    pub found: &'a mut Vec<Crossing>,
}

impl Kernel for FindCrossings<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { rows, stars, pairs, found } = self;
        let mut columns: [Columns; 2] = [[[0.0; LANES]; COLUMNS]; 2];
        for pairs in pairs.chunks(LANES) {
            gather(simd, rows, pairs, 0, EDGES_TOO, &mut columns[0]);
            gather(simd, rows, pairs, 1, CENTRES, &mut columns[1]);
            gather(simd, rows, pairs, 1, FACES_ONLY, &mut columns[1]);
            for (i, k) in (0..EDGES).flat_map(|i| (0..FACES).map(move |k| (i, k))) {
                for lane in set_lanes(crossing_lanes(simd, &columns, i, k) & first_lanes(pairs.len())) {
                    let [p, q] = pairs[lane].map(|star| &stars[star as usize]);
                    let crossing = Crossing { edge: p.edge(i), face: q.face(k), sides: p.sides[i] };
                    if crossing.edge.iter().all(|end| !crossing.face.contains(end)) {
                        found.push(crossing);
                    }
                }
            }
        }
    }
}

/// Bit mask of the lanes in which edge `i` of the first star passes through face `k` of the second.
#[inline(always)]
fn crossing_lanes<S: Simd>(simd: S, [a, b]: &[Columns; 2], i: usize, k: usize) -> u16 {
    let zero = f32x16::splat(simd, 0.0);
    let from = vector(simd, a, CENTRE[0]).minus(vector(simd, b, CENTRE[0]));
    let edge = vector(simd, a, EDGE[0] + 3 * i);
    let (u, v) = (vector(simd, b, FACE[0] + 6 * k), vector(simd, b, FACE[0] + 6 * k + 3));
    let scale = load(simd, &b[FACE_SCALE + 4 * k + 3]);
    let normal = u.cross(v);
    let (first, second) = (normal.dot(from), normal.dot(from.plus(edge)));
    let is_there = load(simd, &a[SHARPNESS + i]).simd_ge(zero) & scale.simd_gt(zero);
    let hits = (first * second).simd_lt(zero) & is_there;
    if hits.to_bitmask() == 0 {
        return 0;
    }
    let at = from.plus(edge.times(first / (first - second)));
    let (uu, uv, vv, pu, pv) = (u.dot(u), u.dot(v), v.dot(v), at.dot(u), at.dot(v));
    let (s, t) = ((vv * pu - uv * pv) * scale, (uu * pv - uv * pu) * scale);
    let is_inside = s.simd_ge(zero) & t.simd_ge(zero) & (s + t).simd_le(f32x16::splat(simd, 1.0));
    (hits & is_inside).to_bitmask() as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::contact::surface::list::PairList;
    use crate::contact::surface::placed::PlacedSurfaces;
    use crate::parallel::workers::Workers;
    use crate::state::body::Body;
    use crate::state::settings::{BodySettings, SelfContact};
    use crate::state::substep::Substep;

    /// Two sheets, the second turned upright and pushed this far through the first; and what crosses.
    fn crossed(depth: f32) -> (Points, Vec<Crossing>) {
        let settings = BodySettings { self_contact: SelfContact::On, ..BodySettings::default() };
        let sheet = || ClothBuilder::new(0.2, 0.2, 9, 9).build(settings).expect("valid");
        let mut bodies: Vec<Body> = vec![sheet(), sheet()];
        for (k, body) in bodies.iter_mut().enumerate() {
            body.particles.arrange(&body.topology.layout);
            for i in 0..body.particles.len() {
                let (x, y) = ((i % 9) as f32 * 0.025, (i / 9) as f32 * 0.025);
                let place = if k == 0 { Vec3::new(x, y, 0.0) } else { Vec3::new(0.11, y + 0.007, x - depth) };
                body.particles.set_position(i, place);
            }
        }
        let mut points = Points::default();
        points.begin_substep(&bodies);
        points.read_starts(&bodies);
        points.read(&bodies, |body| &body.particles.position);
        points.flight = points.start.clone();
        let mut surfaces = PlacedSurfaces::default();
        surfaces.fit(&bodies, &points);
        let mut found = Vec::new();
        let substep = Substep { count: 1, duration: 0.002, ..Substep::default() };
        let workers = Workers::default();
        PairList::default().make(&mut surfaces, &points, &bodies, substep, 0.01, Some(&mut found), &workers);
        (points, found)
    }

    #[test]
    fn sheets_that_cross_are_found_and_those_that_only_touch_are_not() {
        assert!(crossed(-0.01).1.is_empty());
        let (points, found) = crossed(0.03);
        // Both sheets have 8 cells along the line in which they cross.
        assert!(found.len() > 16, "{}", found.len());
        for crossing in &found {
            let face = points.starts(crossing.face);
            let normal = (face[1] - face[0]).cross(face[2] - face[0]);
            let sides = points.starts(crossing.edge).map(|end| normal.dot(end - face[0]));
            assert!(sides[0] * sides[1] < 0.0, "{crossing:?}");
        }
    }

    /// The two are moved against each other, and get no velocity.
    #[test]
    fn crossings_are_led_apart_in_position_only() {
        let (mut points, found) = crossed(0.03);
        found.iter().for_each(|crossing| crossing.move_apart(&mut points, 0.001));
        let ways = || (0..points.start.len()).map(|id| points.way(id));
        assert!(ways().map(Vec3::length).fold(0.0, f32::max) > 1e-3);
        assert!(points.motion.iter().all(|motion| *motion == Vec3::ZERO));
        let momentum: Vec3 = ways()
            .zip(&points.inverse_mass)
            .filter(|(_, inverse_mass)| **inverse_mass > 0.0)
            .map(|(way, inverse_mass)| way / *inverse_mass)
            .sum();
        assert!(momentum.length() < 1e-6, "{momentum}");
    }
}
