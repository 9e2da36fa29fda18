//! Strokes of blades: divide the faces that they cross along themselves.
//!
//! ```text
//!   o-----o-----o         o-----o-----o
//!   |   / |   / |         |   / |   / |
//!   - - - - - - - blade   ------------- the cut: each face has a part on either side
//!   | /   | /   |         | /   | /   |
//!   o-----o-----o         o-----o-----o
//! ```
//!
//! A part that the blade enters and leaves is divided by the straight line between the two points, so that parts stay convex. A blade that
//! passes close to a corner goes through it: there are no slivers.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec3, Vec3};

use crate::state::face_part::{Entry, integral};
use crate::tearing::elements::{Elements, sides};
use crate::tearing::split::Cracks;

/// The triangles that a blade has swept.
pub(crate) struct Stroke<'a> {
    triangles: &'a [[Vec3; 3]],
    /// Metres from the blade within which it goes through a corner.
    snap: f32,
    /// Metres from the end of the last stroke within which this one goes on.
    reach: f32,
}

/// One of these triangles.
struct Blade {
    corners: [DVec3; 3],
    snap: f64,
}

/// A point at which the blade crosses the outline of a polygon.
#[derive(Clone, Copy)]
struct Crossing {
    /// The corner, or the corner before it.
    corner: usize,
    is_corner: bool,
    weights: Vec3,
    place: DVec3,
}

impl Crossing {
    /// A point of the outline; none if it lies on none of its sides.
    fn on_outline(
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
    fn on_edge(&self, elements: &Elements, element: usize) -> Option<([u32; 2], [f32; 2])> {
        let from = elements.polygon(element)[self.corner];
        let (edge, [_, high]) =
            elements.on_edge(element, [from, self.weights]).filter(|_| !self.is_corner)?;
        let low = elements.corners[element].iter().position(|&corner| corner == edge[0])?;
        Some((edge, [self.weights[low], high]))
    }
}

impl<'a> Stroke<'a> {
    /// The stroke that has swept these `triangles` (world, metres), through cloth with edges of this length.
    pub fn new(triangles: &'a [[Vec3; 3]], longest_edge: f32) -> Self {
        let snap = (SNAP * longest_edge).min(MOST_SNAP);
        Self { triangles, snap, reach: REACH * longest_edge }
    }

    /// Divides the elements that the blade passes through, and notes where the body may separate.
    pub fn divide(
        &self,
        elements: &mut Elements,
        at: impl Fn(u32) -> Vec3 + Copy,
        rest: impl Fn(u32) -> Vec3 + Copy,
        cracks: &mut Cracks,
    ) {
        let (points, entries) = (EdgePoints::default(), BTreeMap::new());
        let [snap, reach] = [self.snap, self.reach].map(f64::from);
        let mut cut = Cut { elements, at, rest, cracks, points, entries, snap, reach };
        for &triangle in self.triangles {
            let blade = Blade { corners: triangle.map(Vec3::as_dvec3), snap };
            let (low, high) = bounds(triangle);
            let (low, high) = (low - self.snap, high + self.snap);
            for element in 0..cut.elements.len() {
                let (from, to) = bounds(cut.elements.corners[element].map(at));
                if from.cmple(high).all() && to.cmpge(low).all() {
                    cut.meet(&blade, element);
                }
            }
        }
        cut.go_on();
        cut.points.insert_into(cut.elements);
    }
}

/// A stroke in progress.
struct Cut<'a, At, Rest> {
    elements: &'a mut Elements,
    /// Places of particles in the world, and at rest.
    at: At,
    rest: Rest,
    cracks: &'a mut Cracks,
    points: EdgePoints,
    /// Where it has come into elements that it has not left.
    entries: BTreeMap<usize, Entry>,
    /// Metres within which it goes through a corner, and goes on where the last one has ended.
    snap: f64,
    reach: f64,
}

impl<At: Fn(u32) -> Vec3 + Copy, Rest: Fn(u32) -> Vec3 + Copy> Cut<'_, At, Rest> {
    /// Divides an element by a triangle of the blade, if that passes through, or has done so together with others.
    fn meet(&mut self, blade: &Blade, element: usize) {
        let crossings = blade.crossings(self.elements, element, self.at);
        match crossings[..] {
            [] => {
                // It may go on inside the element.
                let known = self.entries.get(&element).copied().or(self.elements.entry(element));
                let Some(entry) = known else { return };
                if let [p, q] = blade.tips(self.elements, element, self.at)[..] {
                    let [from_p, from_q] = [p, q].map(|tip| self.distance(element, tip, entry.tip));
                    if from_p.min(from_q) <= self.reach {
                        let tip = if from_p < from_q { q } else { p };
                        self.entries.insert(element, Entry { tip, ..entry });
                    }
                }
            }
            [end] => {
                let Some(&tip) = blade.tips(self.elements, element, self.at).first() else { return };
                let begun = self.entries.get(&element).filter(|entry| {
                    self.distance(element, entry.tip, tip) <= blade.snap && entry.from != end.weights
                });
                match begun.and_then(|entry| self.crossing_at(element, entry.from)) {
                    Some(begin) => self.divide(element, [begin, end]),
                    None => drop(self.entries.insert(element, Entry { from: end.weights, tip })),
                }
            }
            ref crossings => self.divide(element, farthest(crossings)),
        }
    }

    /// Goes on where a stroke has ended before.
    fn go_on(&mut self) {
        for (element, entry) in core::mem::take(&mut self.entries) {
            let last = self.elements.entry(element).filter(|last| {
                last.from != entry.from && self.distance(element, last.tip, entry.tip) <= self.reach
            });
            let ends = last.map(|last| [last.from, entry.from].map(|from| self.crossing_at(element, from)));
            if let Some([Some(begin), Some(end)]) = ends {
                self.divide(element, [begin, end]);
            } else if !self.is_at_corner(element, &entry) {
                self.elements.enter(element, entry);
                self.cracks.are_entered = true;
            }
        }
    }

    /// True if the blade has got no farther than to a corner of an element.
    fn is_at_corner(&self, element: usize, entry: &Entry) -> bool {
        let is_corner = self.elements.polygon(element).contains(&entry.from);
        is_corner && self.distance(element, entry.from, entry.tip) <= self.snap
    }

    /// Metres between two points of an element.
    fn distance(&self, element: usize, p: Vec3, q: Vec3) -> f64 {
        let [p, q] = [p, q].map(|point| self.elements.place(element, point, self.at));
        p.distance(q)
    }

    fn crossing_at(&self, element: usize, from: Vec3) -> Option<Crossing> {
        Crossing::on_outline(self.elements, element, from, self.at)
    }

    /// Divides an element from one point of its outline to another.
    fn divide(&mut self, element: usize, ends: [Crossing; 2]) {
        let Self { elements, rest, cracks, points, entries, .. } = self;
        let line = ends.map(|end| elements.place(element, end.weights, *rest).as_vec3());
        let arcs = arcs(elements.polygon(element), ends);
        let corners = elements.corners[element];
        for end in ends {
            if let Some((edge, weights)) = end.on_edge(elements, element) {
                cracks.crossed.insert(edge);
                points.add(edge, weights);
            }
        }
        entries.remove(&element);
        if arcs.iter().all(|arc| integral(arc).element_sum() > LEAST_SHARE) {
            elements.divide(element, arcs);
        } else {
            // It parts the element from the one beside it: it goes along a side, or has left by that at which it came in.
            let along = arcs.iter().filter(|arc| edge_of(arc).is_some());
            for side in along.flat_map(|arc| arc.windows(2)) {
                cracks.add_side(elements.on_edge(element, [side[0], side[1]]));
            }
        }
        cracks.lines.push(line);
        cracks.particles.extend(corners);
    }
}

/// Least and greatest corner of the box around a triangle.
fn bounds([a, b, c]: [Vec3; 3]) -> (Vec3, Vec3) {
    (a.min(b).min(c), a.max(b).max(c))
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

impl Blade {
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
            heights.iter().map(|&(height, is_inside)| is_inside && is_close(height)).collect();
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
            let is_inside = sides(outline).all(|[from, to]| from.cross(to).dot(weights) >= 0.0);
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
        let (_, is_inside) = above(&self.corners, from.lerp(to, part))?;
        is_inside.then_some(part as f32)
    }
}

/// The height of a place above the plane of a triangle in metres, and true if it is above the triangle itself; none if that has no area.
fn above(triangle: &[DVec3; 3], place: DVec3) -> Option<(f64, bool)> {
    let [p, q, r] = *triangle;
    let normal = (q - p).cross(r - p);
    let length = normal.length();
    if length == 0.0 {
        return None;
    }
    let is_inside = weights_at(triangle, place).min_element() >= -ROUNDING;
    Some(((place - p).dot(normal) / length, is_inside))
}

/// The weights of the corners of a triangle at the foot of a place.
fn weights_at(&[p, q, r]: &[DVec3; 3], place: DVec3) -> DVec3 {
    let normal = (q - p).cross(r - p);
    let weight =
        |from: DVec3, to: DVec3| (to - from).cross(place - from).dot(normal) / normal.length_squared();
    DVec3::new(weight(q, r), weight(r, p), weight(p, q))
}

/// The two parts of a polygon at both sides of the line between two points of its outline.
fn arcs(polygon: &[Vec3], ends: [Crossing; 2]) -> [Vec<Vec3>; 2] {
    let mut ring = Vec::with_capacity(polygon.len() + 2);
    let mut places = [0; 2];
    for (corner, &point) in polygon.iter().enumerate() {
        ring.push(point);
        for (place, end) in places.iter_mut().zip(&ends).filter(|(_, end)| end.corner == corner) {
            ring.extend((!end.is_corner).then_some(end.weights));
            *place = ring.len() - 1;
        }
    }
    let [from, to] = [places[0].min(places[1]), places[0].max(places[1])];
    let start = polygon[ends[0].corner];
    if ends[0].corner == ends[1].corner && ring[from].distance(start) > ring[to].distance(start) {
        // Both are on one side, in the other order.
        ring.swap(from, to);
    }
    [ring[from..=to].to_vec(), [&ring[to..], &ring[..=from]].concat()]
}

/// The corner of the face opposite to the edge along which an arc lies; none unless it lies along one.
fn edge_of(arc: &[Vec3]) -> Option<usize> {
    (0..3).find(|&corner| arc.iter().all(|point| point[corner] == 0.0))
}

/// New points of edges: the weights of their ends, the lower index first.
#[derive(Default)]
struct EdgePoints(BTreeMap<[u32; 2], Vec<[f32; 2]>>);

impl EdgePoints {
    fn add(&mut self, edge: [u32; 2], weights: [f32; 2]) {
        let points = self.0.entry(edge).or_default();
        if !points.contains(&weights) {
            points.push(weights);
        }
    }

    /// Makes them corners of the elements on both sides of their edges, so that those that the stroke has not divided leave no gap.
    fn insert_into(self, elements: &mut Elements) {
        let ends: BTreeSet<u32> = self.0.keys().flatten().copied().collect();
        for element in 0..elements.len() {
            let corners = elements.corners[element];
            if corners.iter().filter(|corner| ends.contains(corner)).count() < 2 {
                continue;
            }
            for low in 0..3 {
                for high in (0..3).filter(|&high| corners[low] < corners[high]) {
                    for &[of_low, of_high] in self.0.get(&[corners[low], corners[high]]).into_iter().flatten()
                    {
                        let mut point = Vec3::ZERO;
                        (point[low], point[high]) = (of_low, of_high);
                        elements.insert(element, 3 - low - high, point);
                    }
                }
            }
        }
    }
}

/// Part of the longest edge within which a blade goes through a corner, and the most in metres.
const SNAP: f32 = 0.01;
const MOST_SNAP: f32 = 5e-4;

/// Part of the longest edge within which a stroke goes on from the last one: cloth moves between them.
const REACH: f32 = 0.5;

/// The most by which weights of a point of an outline lie beside it, by rounding.
const OFF_OUTLINE: f32 = 1e-4;

/// Parts of a face below this are lines.
const LEAST_SHARE: f32 = 1e-6;

/// Places outside of a triangle of a blade by this part of its height are inside, so that neighbouring triangles leave no gap.
const ROUNDING: f64 = 1e-9;
