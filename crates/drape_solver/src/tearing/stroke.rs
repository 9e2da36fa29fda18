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

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::state::face_part::{Entry, beside_edge, integral};
use crate::tearing::blade::{Blade, Crossing, End};
use crate::tearing::elements::Elements;
use crate::tearing::split::Cracks;

/// The triangles that a blade has swept.
pub(crate) struct Stroke {
    triangles: Vec<Blade>,
    /// Boxes around them, from the least to the greatest corner.
    bounds: Vec<[Vec3; 2]>,
    /// Metres from the end of the last stroke within which this one goes on.
    reach: f64,
    snap: f64,
}

impl Stroke {
    /// The stroke that has swept these `triangles` (world, metres), through cloth with edges of this length.
    pub fn new(triangles: &[[Vec3; 3]], longest_edge: f32) -> Self {
        let margin = (SNAP * longest_edge).min(MOST_SNAP);
        let (snap, reach) = (f64::from(margin), f64::from(REACH * longest_edge));
        let wide = |&triangle: &[Vec3; 3]| {
            let [low, high] = bounds(triangle);
            [low - margin, high + margin]
        };
        let blade = |triangle: &[Vec3; 3]| Blade { corners: triangle.map(Vec3::as_dvec3), snap };
        Self {
            triangles: triangles.iter().map(blade).collect(),
            bounds: triangles.iter().map(wide).collect(),
            reach,
            snap,
        }
    }

    /// Divides the elements that the blade passes through, and notes around which particles the body may separate. Particles are at
    /// these `places` in the world.
    pub fn divide(
        &self,
        elements: &mut Elements,
        places: &[Vec3],
        rest: impl Fn(u32) -> Vec3 + Copy,
        cracks: &mut Cracks,
    ) {
        let at = |particle: u32| places[particle as usize];
        let mut cut = Cut { stroke: self, elements, at, rest, cracks, points: EdgePoints::default() };
        // The sides of the box around the whole blade beyond which each particle is.
        let [low, high] = (self.bounds.iter())
            .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[a, b], [p, q]| [a.min(*p), b.max(*q)]);
        let sides = |place: &Vec3| place.cmplt(low).bitmask() | place.cmpgt(high).bitmask() << 3;
        let beyond: Vec<u32> = places.iter().map(sides).collect();
        for element in 0..cut.elements.len() {
            let corners = cut.elements.corners[element];
            if corners.iter().fold(u32::MAX, |all, &corner| all & beyond[corner as usize]) != 0 {
                continue;
            }
            let [from, to] = bounds(corners.map(at));
            let meets = |&triangle: &usize| {
                let [low, high] = self.bounds[triangle];
                let is_near = from.cmple(high).all() && to.cmpge(low).all();
                is_near && !self.triangles[triangle].is_beside(corners.map(at))
            };
            let near: Vec<usize> = (0..self.triangles.len()).filter(meets).collect();
            if !near.is_empty() {
                cut.meet(element, near);
            }
        }
        cut.points.insert_into(cut.elements);
    }
}

/// Least and greatest corner of the box around a triangle.
fn bounds([a, b, c]: [Vec3; 3]) -> [Vec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The way of a blade through an element, from triangle to triangle.
struct Way {
    ends: [End; 2],
    triangles: Vec<usize>,
}

impl Way {
    /// The crossings at its ends, if it goes right through.
    fn through(&self) -> Option<[Crossing; 2]> {
        match self.ends {
            [End::Crossing(begin), End::Crossing(end)] => Some([begin, end]),
            _ => None,
        }
    }
}

/// Joins ways that end in the same place, within `snap` metres, the nearest first. A way that is there twice counts once.
fn joined(all: impl Iterator<Item = Way>, snap: f64) -> Vec<Way> {
    let mut ways: Vec<Way> = Vec::new();
    for way in all {
        let is_twin = |known: &&mut Way| {
            let [[a, b], [p, q]] = [known.ends, way.ends];
            let meet = |one: End, other: End| one.place().distance(other.place()) <= snap;
            meet(a, p) && meet(b, q) || meet(a, q) && meet(b, p)
        };
        match ways.iter_mut().find(is_twin) {
            Some(twin) => twin.triangles.extend(way.triangles),
            None => ways.push(way),
        }
    }
    loop {
        let mut nearest: Option<(f64, [(usize, usize); 2])> = None;
        for (i, way) in ways.iter().enumerate() {
            for (j, other) in ways[i + 1..].iter().enumerate() {
                for (of_way, of_other) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    if let (End::Tip(_, p), End::Tip(_, q)) = (way.ends[of_way], other.ends[of_other]) {
                        let distance = p.distance(q);
                        if distance <= snap && nearest.is_none_or(|(least, _)| distance < least) {
                            nearest = Some((distance, [(i, of_way), (i + 1 + j, of_other)]));
                        }
                    }
                }
            }
        }
        let Some((_, [(i, of_way), (j, of_other)])) = nearest else { return ways };
        let other = ways.swap_remove(j);
        ways[i].ends[of_way] = other.ends[1 - of_other];
        ways[i].triangles.extend(other.triangles);
    }
}

/// A stroke in progress.
struct Cut<'a, At, Rest> {
    stroke: &'a Stroke,
    elements: &'a mut Elements,
    /// Places of particles in the world, and at rest.
    at: At,
    rest: Rest,
    cracks: &'a mut Cracks,
    points: EdgePoints,
}

impl<At: Fn(u32) -> Vec3 + Copy, Rest: Fn(u32) -> Vec3 + Copy> Cut<'_, At, Rest> {
    /// Divides an element wherever some of the triangles go right through it together.
    fn meet(&mut self, element: usize, mut triangles: Vec<usize>) {
        loop {
            let ways = triangles.iter().filter_map(|&triangle| {
                let ends = self.stroke.triangles[triangle].way(self.elements, element, self.at)?;
                Some(Way { ends, triangles: vec![triangle] })
            });
            let mut ways = joined(ways, self.stroke.snap);
            let (ends, used) = match ways.iter().position(|way| way.through().is_some()) {
                Some(place) => {
                    let way = ways.swap_remove(place);
                    (way.through(), way.triangles)
                }
                None => self.go_on(element, ways),
            };
            let Some(ends) = ends else { return };
            triangles.retain(|triangle| !used.contains(triangle));
            for part in self.divide(element, ends) {
                self.meet(part, triangles.clone());
            }
        }
    }

    /// Goes on where a stroke has ended before: gives the ends of the first way that leads through the element, and the triangles
    /// that it has used. Otherwise notes where this stroke ends.
    fn go_on(&mut self, element: usize, ways: Vec<Way>) -> (Option<[Crossing; 2]>, Vec<usize>) {
        let before = self.elements.marks(element).entries.clone();
        let mut entries = before.clone();
        for Way { ends, triangles } in ways {
            let near = |tip: Vec3, entry: &Entry| {
                Some(self.distance(element, entry.tip, tip)).filter(|&gap| gap <= self.stroke.reach)
            };
            let nearest = |tip: Vec3, but: Option<Vec3>| {
                let known = entries.iter().enumerate().filter(|(_, entry)| Some(entry.from) != but);
                let gaps = known.filter_map(|(place, entry)| Some((near(tip, entry)?, place)));
                gaps.min_by(|p, q| p.0.total_cmp(&q.0))
            };
            match ends {
                [End::Crossing(end), End::Tip(tip, _)] | [End::Tip(tip, _), End::Crossing(end)] => {
                    let begun = nearest(tip, Some(end.weights)).and_then(|(gap, place)| {
                        let from = entries[place].from;
                        let begin = Crossing::on_outline(self.elements, element, from, self.at)?;
                        // Two blades that come in side by side are not one that turns back.
                        let turns_back = beside_edge(&[begin.weights, end.weights]).is_some();
                        (!turns_back || gap <= self.stroke.snap).then_some((place, begin))
                    });
                    if let Some((place, begin)) = begun {
                        entries.remove(place);
                        self.elements.marks(element).entries = entries;
                        return (Some([begin, end]), triangles);
                    }
                    let entry = Entry { from: end.weights, tip };
                    let is_touch = self.distance(element, entry.from, tip) <= self.stroke.snap;
                    if !is_touch && !entries.contains(&entry) {
                        entries.retain(|known| known.from != entry.from);
                        entries.push(entry);
                    }
                }
                [End::Tip(p, _), End::Tip(q, _)] => {
                    let [from_p, from_q] = [p, q].map(|tip| nearest(tip, None));
                    let next = match (from_p, from_q) {
                        (Some((p_gap, place)), Some((q_gap, _))) if p_gap <= q_gap => Some((place, q)),
                        (Some((_, place)), None) => Some((place, q)),
                        (_, Some((_, place))) => Some((place, p)),
                        (None, None) => None,
                    };
                    if let Some((place, tip)) = next {
                        entries[place].tip = tip;
                    }
                }
                [End::Crossing(_), End::Crossing(_)] => {}
            }
        }
        self.cracks.has_changed |= entries != before;
        self.elements.marks(element).entries = entries;
        (None, Vec::new())
    }

    /// Metres between two points of an element.
    fn distance(&self, element: usize, p: Vec3, q: Vec3) -> f64 {
        let [p, q] = [p, q].map(|point| self.elements.place(element, point, self.at));
        p.distance(q)
    }

    /// Divides an element from one point of its outline to another, and returns the numbers of the other parts; none if the blade only
    /// goes along a side.
    fn divide(&mut self, element: usize, mut ends: [Crossing; 2]) -> Vec<usize> {
        let Self { elements, rest, cracks, points, .. } = self;
        ends.iter_mut().for_each(|end| points.snap(elements, element, end));
        let arcs = arcs(elements.polygon(element), ends);
        let is_divided = arcs.iter().all(|arc| integral(arc).element_sum() > LEAST_AREA);
        let mut has_changed = is_divided;
        if !is_divided {
            // The blade goes along a side, or leaves by the side at which it came in: it parts the element from the one beside it.
            let along = arcs.iter().filter(|arc| beside_edge(arc).is_some());
            let open = &mut elements.marks(element).open;
            for side in along.flat_map(|arc| arc.windows(2)).map(|side| [side[0], side[1]]) {
                if !open.contains(&side) {
                    open.push(side);
                    has_changed = true;
                }
            }
        }
        if has_changed {
            cracks.has_changed = true;
            cracks.lines.push(ends.map(|end| elements.place(element, end.weights, *rest).as_vec3()));
            cracks.particles.extend(elements.corners[element]);
            for end in ends {
                if let Some((edge, weights)) = end.on_edge(elements, element) {
                    cracks.crossed.insert(edge);
                    points.add(edge, weights);
                }
            }
        }
        if !is_divided {
            return Vec::new();
        }
        let entries = core::mem::take(&mut elements.marks(element).entries);
        let mut parts = vec![element, elements.divide(element, arcs)];
        let line = ends.map(|end| end.weights);
        entries.into_iter().for_each(|entry| self.keep(entry, &mut parts, line));
        parts.split_off(1)
    }

    /// Keeps an entry in that of the `parts` of a divided element in which it begins. If the line between them crosses its way, that part
    /// is divided, and the way goes on beyond the line.
    fn keep(&mut self, entry: Entry, parts: &mut Vec<usize>, line: [Vec3; 2]) {
        let Entry { from, tip } = entry;
        let on = |part: usize, point: Vec3| {
            Crossing::on_outline(self.elements, part, point, self.at).map(|crossing| (part, crossing))
        };
        let Some((own, begin)) = parts.iter().find_map(|&part| on(part, from)) else { return };
        let Some(across) = meeting([from, tip], line) else {
            self.elements.marks(own).entries.push(entry);
            return;
        };
        let end = on(own, across);
        let beyond = parts.iter().copied().filter(|&part| part != own).find_map(|part| on(part, across));
        if let Some((other, _)) = beyond {
            self.elements.marks(other).entries.push(Entry { from: across, tip });
        }
        if let Some((_, end)) = end {
            parts.extend(self.divide(own, [begin, end]));
        }
    }
}

/// The point of a way at which it crosses a line, both by weights; none if it ends before.
fn meeting(way: [Vec3; 2], line: [Vec3; 2]) -> Option<Vec3> {
    let [a, b, p, q] = [way[0], way[1], line[0], line[1]].map(Vec3::truncate);
    let height = |point: Vec2| (q - p).perp_dot(point - p);
    let (before, after) = (height(a), height(b));
    let is_across = before * after < 0.0 && before.abs() > f32::EPSILON;
    is_across.then(|| way[0].lerp(way[1], before / (before - after)))
}

/// The two parts of a polygon at both sides of the line between two points of its outline.
fn arcs(polygon: &[Vec3], ends: [Crossing; 2]) -> [Vec<Vec3>; 2] {
    let mut ring = Vec::with_capacity(polygon.len() + 2);
    let mut places = [0; 2];
    for (corner, &point) in polygon.iter().enumerate() {
        let own = ring.len();
        ring.push(point);
        for (place, end) in places.iter_mut().zip(&ends).filter(|(_, end)| end.corner == corner) {
            ring.extend((!end.is_corner).then_some(end.weights));
            *place = if end.is_corner { own } else { ring.len() - 1 };
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

    /// Moves a crossing to a point that another triangle has made within rounding of it.
    fn snap(&self, elements: &Elements, element: usize, crossing: &mut Crossing) {
        let Some((edge, [_, high])) = crossing.on_edge(elements, element) else { return };
        let known = self.0.get(&edge).into_iter().flatten();
        if let Some(&[of_low, of_high]) = known.into_iter().find(|known| (known[1] - high).abs() < SAME_POINT)
        {
            let place = |end: u32| elements.corners[element].iter().position(|&corner| corner == end);
            if let (Some(low), Some(high)) = (place(edge[0]), place(edge[1])) {
                (crossing.weights[low], crossing.weights[high]) = (of_low, of_high);
            }
        }
    }

    /// Makes them corners of the elements on both sides of their edges, so that those that the stroke has not divided leave no gap.
    fn insert_into(self, elements: &mut Elements) {
        let count = self.0.keys().map(|edge| edge[1] as usize + 1).max().unwrap_or(0);
        let mut is_end = vec![false; count];
        self.0.keys().flatten().for_each(|&end| is_end[end as usize] = true);
        for element in 0..elements.len() {
            let corners = elements.corners[element];
            if corners.iter().filter(|&&corner| is_end.get(corner as usize) == Some(&true)).count() < 2 {
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

/// Weights of one point of an edge that two triangles of a blade find differ by less.
const SAME_POINT: f32 = 1e-5;

/// Parts of a face with less of its area are lines.
const LEAST_AREA: f32 = 1e-6;
