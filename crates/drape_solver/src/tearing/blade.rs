//! One triangle of a blade, and its way through a part of a face.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use glam::{DVec3, Vec3};

use crate::tearing::elements::{Elements, sides};

/// A triangle that a blade has swept.
pub(crate) struct Blade {
    pub corners: [DVec3; 3],
    /// Metres within which it goes through a corner.
    pub snap: f64,
}

/// An end of the way of a blade through an element.
#[derive(Clone, Copy)]
pub(crate) enum End {
    Crossing(Crossing),
    /// A point inside, by its weights and in the world.
    Tip(Vec3, DVec3),
}

impl End {
    /// Its place in the world.
    pub fn place(self) -> DVec3 {
        match self {
            Self::Crossing(crossing) => crossing.place,
            Self::Tip(_, place) => place,
        }
    }
}

/// A point at which the blade crosses the outline of a polygon.
#[derive(Clone, Copy)]
pub(crate) struct Crossing {
    /// The corner, or the corner before it.
    pub corner: usize,
    pub is_corner: bool,
    pub weights: Vec3,
    place: DVec3,
}

impl Crossing {
    /// A point of the outline; none if it lies on none of its sides.
    pub fn on_outline(
        elements: &Elements,
        element: usize,
        weights: Vec3,
        at: impl Fn(u32) -> Vec3,
    ) -> Option<Self> {
        let place = elements.place(element, weights, at);
        let polygon = elements.polygon(element);
        if let Some(corner) = polygon.iter().position(|&corner| corner == weights) {
            return Some(Self { corner, is_corner: true, weights, place });
        }
        let off = |[from, to]: [Vec3; 2]| {
            let along = ((weights - from).dot(to - from) / from.distance_squared(to)).clamp(0.0, 1.0);
            weights.distance(from.lerp(to, along))
        };
        let sides = sides(polygon).map(off).enumerate();
        let (corner, distance) = sides.min_by(|(_, p), (_, q)| p.total_cmp(q))?;
        (distance < OFF_OUTLINE).then_some(Self { corner, is_corner: false, weights, place })
    }

    /// The edge of the face that it divides, and the weights of its ends, the lower index first.
    pub fn on_edge(&self, elements: &Elements, element: usize) -> Option<([u32; 2], [f32; 2])> {
        let from = elements.polygon(element)[self.corner];
        let (edge, [_, high]) =
            elements.on_edge(element, [from, self.weights]).filter(|_| !self.is_corner)?;
        let low = elements.corners[element].iter().position(|&corner| corner == edge[0])?;
        Some((edge, [self.weights[low], high]))
    }
}

impl Blade {
    /// True if a face with these corners lies on one side of its plane, and it goes through none of them.
    pub fn is_beside(&self, corners: [Vec3; 3]) -> bool {
        let [p, q, r] = self.corners;
        let normal = (q - p).cross(r - p);
        let (heights, close) =
            (corners.map(|corner| (corner.as_dvec3() - p).dot(normal)), self.snap * normal.length());
        heights.iter().all(|&height| height > close) || heights.iter().all(|&height| height < -close)
    }

    /// The ends of its way through an element; none if it misses.
    pub fn way(
        &self,
        elements: &Elements,
        element: usize,
        at: impl Fn(u32) -> Vec3 + Copy,
    ) -> Option<[End; 2]> {
        let crossings = self.crossings(elements, element, at);
        if crossings.len() > 1 {
            return Some(farthest(&crossings).map(End::Crossing));
        }
        let tips = self.tips(elements, element, at);
        let mut tips = tips.into_iter().map(|tip| (tip, elements.place(element, tip, at)));
        let Some(&crossing) = crossings.first() else {
            let [(p, at_p), (q, at_q)] = [tips.next()?, tips.next()?];
            return Some([End::Tip(p, at_p), End::Tip(q, at_q)]);
        };
        // A triangle that ends at the outline has a tip there, within rounding, or none.
        let off = |(_, place): &(Vec3, DVec3)| place.distance_squared(crossing.place);
        let tip = tips.max_by(|p, q| off(p).total_cmp(&off(q))).unwrap_or((crossing.weights, crossing.place));
        Some([End::Crossing(crossing), End::Tip(tip.0, tip.1)])
    }

    /// The points at which the blade crosses the outline of an element: two if it passes through, one if it ends inside.
    fn crossings(
        &self,
        elements: &Elements,
        element: usize,
        at: impl Fn(u32) -> Vec3 + Copy,
    ) -> Vec<Crossing> {
        let polygon = elements.polygon(element);
        let place = |point: Vec3| elements.place(element, point, at);
        let heights = polygon.iter().map(|&corner| above(&self.corners, place(corner)));
        let Some(heights) = heights.collect::<Option<Vec<_>>>() else { return Vec::new() };
        let is_close = |height: f64| height.abs() <= self.snap;
        if heights.iter().all(|&(height, _)| is_close(height)) {
            // The blade lies in the element.
            return Vec::new();
        }
        let touched: Vec<bool> =
            heights.iter().map(|&(height, inside)| inside >= -self.snap && is_close(height)).collect();
        let mut crossings = Vec::new();
        for (corner, [from, to]) in sides(polygon).enumerate() {
            if touched[corner] {
                crossings.push(Crossing { corner, is_corner: true, weights: from, place: place(from) });
            } else if !touched[(corner + 1) % polygon.len()] {
                // Along the whole edge, for the same bits in both faces.
                let ends = elements.edge_of([from, to], element).unwrap_or([from, to]);
                let Some(part) = self.crossing(ends.map(place)) else { continue };
                let weights = ends[0].lerp(ends[1], part);
                if (weights - from).dot(weights - to) < 0.0 {
                    crossings.push(Crossing { corner, is_corner: false, weights, place: place(weights) });
                }
            }
        }
        crossings
    }

    /// The points inside an element at which an edge of the blade goes through it.
    fn tips(&self, elements: &Elements, element: usize, at: impl Fn(u32) -> Vec3 + Copy) -> Vec<Vec3> {
        let [p, q, r] = self.corners;
        let corners = elements.corners[element].map(|corner| at(corner).as_dvec3());
        let outline = elements.polygon(element);
        let tip = |[from, to]: [DVec3; 2]| {
            let [before, after] = [above(&corners, from)?.0, above(&corners, to)?.0];
            if before * after > 0.0 || before == after {
                return None;
            }
            let weights = weights_at(&corners, from.lerp(to, before / (before - after))).as_vec3();
            let is_inside = sides(outline).all(|[from, to]| from.cross(to).dot(weights) >= -INSIDE);
            is_inside.then_some(weights)
        };
        [[p, q], [q, r], [r, p]].into_iter().filter_map(tip).collect()
    }

    /// The part (0 to 1) of the way between two places at which it crosses the blade.
    fn crossing(&self, [from, to]: [DVec3; 2]) -> Option<f32> {
        let (before, after) = (above(&self.corners, from)?.0, above(&self.corners, to)?.0);
        if before * after >= 0.0 {
            return None;
        }
        let part = before / (before - after);
        let (_, inside) = above(&self.corners, from.lerp(to, part))?;
        (inside >= -ROUNDING).then_some(part as f32)
    }
}

/// The height of a place above the plane of a triangle, and the distance of its foot from the nearest side, less than zero outside; in
/// metres. None if the triangle has no area.
fn above(triangle: &[DVec3; 3], place: DVec3) -> Option<(f64, f64)> {
    let [p, q, r] = *triangle;
    let normal = (q - p).cross(r - p);
    let double_area = normal.length();
    if double_area == 0.0 {
        return None;
    }
    let sides = DVec3::new(q.distance(r), r.distance(p), p.distance(q));
    let from_sides = weights_at(triangle, place) * double_area / sides;
    Some(((place - p).dot(normal) / double_area, from_sides.min_element()))
}

/// The weights of the corners of a triangle at the foot of a place.
pub(crate) fn weights_at(&[p, q, r]: &[DVec3; 3], place: DVec3) -> DVec3 {
    let normal = (q - p).cross(r - p);
    let weight =
        |from: DVec3, to: DVec3| (to - from).cross(place - from).dot(normal) / normal.length_squared();
    DVec3::new(weight(q, r), weight(r, p), weight(p, q))
}

/// The two crossings that are farthest apart. Where there are more, some lie within rounding of each other.
fn farthest(crossings: &[Crossing]) -> [Crossing; 2] {
    let mut best = [crossings[0], crossings[1]];
    for (i, &p) in crossings.iter().enumerate() {
        for &q in &crossings[i + 1..] {
            if p.place.distance_squared(q.place) > best[0].place.distance_squared(best[1].place) {
                best = [p, q];
            }
        }
    }
    best
}

/// The most by which a point inside may be outside by rounding, as a part of twice the area of the face.
const INSIDE: f32 = 1e-6;

/// The most by which weights of a point of an outline lie beside it, by rounding.
const OFF_OUTLINE: f32 = 1e-4;

/// Places within so many metres of a triangle of a blade are inside, so that neighbouring triangles leave no gap.
const ROUNDING: f64 = 1e-9;
