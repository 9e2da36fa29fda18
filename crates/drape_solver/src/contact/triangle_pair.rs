//! Two triangles or links that may touch: which of their corners and edges are tested, and how these overlap.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::constants::NEIGHBOURS_AT_REST;
use crate::contact::ccd::{Passage, edges_passed, face_passed};
use crate::contact::cloth_contact::{Corner, Penetration};
use crate::geometry::nearest_segments::between_segments;
use crate::geometry::nearest_triangle::{on_triangle, weighted};
use crate::state::body::Body;
use crate::state::surface_tree::SurfaceElement;

/// Two elements, and the parts of them that are tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Pair {
    pub bodies: [u32; 2],
    pub elements: [u32; 2],
    /// One bit for each tested part: corners of the first on the face of the second (0 to 2), corners of the second on
    /// the face of the first (3 to 5), edge `j` on edge `k` (6 + 3 j + k). Bit 15 is set if the two may cross.
    pub parts: u16,
}

pub(crate) const MAY_CROSS: u16 = 1 << 15;

/// The parts that touch: the first corner and the face of the others, or the edge of the first two and that of the last
/// two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    CornerFace,
    EdgeEdge,
}

impl Pair {
    fn elements<'a>(&self, bodies: &'a [Body]) -> [&'a SurfaceElement; 2] {
        [0, 1].map(|k| {
            let tree = bodies[self.bodies[k] as usize].topology.surface_tree();
            &tree.elements[self.elements[k] as usize]
        })
    }

    pub fn corners(&self, bodies: &[Body]) -> [[Corner; 3]; 2] {
        let [a, b] = self.elements(bodies);
        [corners_of(a, self.bodies[0]), corners_of(b, self.bodies[1])]
    }

    /// The distance that the two keep, in metres.
    pub fn apart(&self, bodies: &[Body]) -> f32 {
        self.bodies.iter().map(|&body| bodies[body as usize].settings.thickness).sum()
    }

    pub fn for_each_part(&self, bodies: &[Body], mut visit: impl FnMut(Kind, [Corner; 4])) {
        let [a, b] = self.corners(bodies);
        for k in 0..3 {
            if self.parts & (1 << k) != 0 {
                visit(Kind::CornerFace, [a[k], b[0], b[1], b[2]]);
            }
            if self.parts & (8 << k) != 0 {
                visit(Kind::CornerFace, [b[k], a[0], a[1], a[2]]);
            }
        }
        for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
            if self.parts & edge_part(j, k) != 0 {
                let ([p, q], [r, s]) = (SurfaceElement::edge(j), SurfaceElement::edge(k));
                visit(Kind::EdgeEdge, [a[p], a[q], b[r], b[s]]);
            }
        }
    }
}

impl Kind {
    /// Weights of the two nearest points.
    pub fn nearest(self, [a, b, c, d]: [Vec3; 4]) -> [f32; 4] {
        match self {
            Self::CornerFace => {
                let [u, v, w] = on_triangle([b, c, d], a);
                [1.0, -u, -v, -w]
            }
            Self::EdgeEdge => {
                let [s, t] = between_segments([a, b], [c, d]);
                [1.0 - s, s, t - 1.0, -t]
            }
        }
    }

    /// The penetration of the two, if they overlap.
    pub fn penetration(self, passage: Passage, apart: f32) -> Option<Penetration<4>> {
        let slack = CRACK_SLACK * apart;
        let passed = match self {
            Self::CornerFace => face_passed(&passage, slack),
            Self::EdgeEdge => edges_passed(&passage, slack),
        };
        let Passage { start, now } = passage;
        let overlap = |weights, normal: Vec3, height: f32| Penetration {
            weights,
            normal,
            depth: apart - height,
            outward: height - weighted(weights, start).dot(normal),
            at_start: apart - weighted(self.nearest(start), start).length(),
        };
        if let Some((weights, normal)) = passed {
            let height = weighted(weights, now).dot(normal);
            return (height < apart).then(|| overlap(weights, normal, height));
        }
        let weights = self.nearest(now);
        let way = weighted(weights, now);
        let distance_squared = way.length_squared();
        // Parts at a distance of zero have no direction: contacts around them move them apart.
        if distance_squared >= apart * apart || distance_squared == 0.0 {
            return None;
        }
        let distance = distance_squared.sqrt();
        Some(overlap(weights, way / distance, distance))
    }
}

/// A way that leads past a triangle or an edge at most this far beside it passes through it, in distances that contacts
/// keep. This closes the cracks between triangles.
const CRACK_SLACK: f32 = 0.1;

fn corners_of(element: &SurfaceElement, body: u32) -> [Corner; 3] {
    element.slots.map(|slot| Corner { body, slot })
}

fn edge_part(j: usize, k: usize) -> u16 {
    1 << (6 + 3 * j + k)
}

/// The parts that are tested of two elements that are not neighbours at rest.
pub(crate) fn all_parts([a, b]: [&SurfaceElement; 2]) -> u16 {
    let mut parts = 0;
    if b.is_face() {
        parts |= u16::from(a.corners);
    }
    if a.is_face() {
        parts |= u16::from(b.corners) << 3;
    }
    for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
        if a.edges & (1 << j) != 0 && b.edges & (1 << k) != 0 {
            parts |= edge_part(j, k);
        }
    }
    // Two links cannot cross.
    if a.is_face() || b.is_face() { parts | MAY_CROSS } else { parts }
}

/// The same for two elements of one body, without parts that share a corner or are near at rest.
pub(crate) fn own_parts(body: &Body, elements: [usize; 2]) -> u16 {
    let topology = &body.topology;
    let [a, b] = elements.map(|place| &topology.surface_tree().elements[place]);
    let mut parts = all_parts([a, b]);
    let shares = |p: &[usize], q: &[usize]| p.iter().any(|&i| q.iter().any(|&j| a.slots[i] == b.slots[j]));
    if shares(&[0, 1, 2], &[0, 1, 2]) {
        parts &= !MAY_CROSS;
    }
    let near = 2.0 * body.settings.thickness * NEIGHBOURS_AT_REST;
    let rest = |element: &SurfaceElement| {
        element.indices.map(|index| topology.rest.get(index as usize).copied().unwrap_or_default())
    };
    let (p, q) = (rest(a), rest(b));
    let is_near = |kind: Kind, corners: [Vec3; 4]| {
        weighted(kind.nearest(corners), corners).length_squared() < near * near
    };
    for k in 0..3 {
        let on_b = || shares(&[k], &[0, 1, 2]) || is_near(Kind::CornerFace, [p[k], q[0], q[1], q[2]]);
        let on_a = || shares(&[0, 1, 2], &[k]) || is_near(Kind::CornerFace, [q[k], p[0], p[1], p[2]]);
        if parts & (1 << k) != 0 && on_b() {
            parts &= !(1 << k);
        }
        if parts & (8 << k) != 0 && on_a() {
            parts &= !(8 << k);
        }
    }
    for (j, k) in (0..3).flat_map(|j| (0..3).map(move |k| (j, k))) {
        let (own, other) = (SurfaceElement::edge(j), SurfaceElement::edge(k));
        let corners = [p[own[0]], p[own[1]], q[other[0]], q[other[1]]];
        if parts & edge_part(j, k) != 0 && (shares(&own, &other) || is_near(Kind::EdgeEdge, corners)) {
            parts &= !edge_part(j, k);
        }
    }
    parts
}
