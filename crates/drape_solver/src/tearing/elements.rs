//! The faces of a body as elements that may separate: each whole face, and each part of a divided one.
//!
//! Points on an edge are numbered by the weight of its particle with the higher index, so that the faces beside it name the same point by
//! the same number.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use glam::{DVec3, Vec3};

use crate::state::face_part::{FacePart, Marks, beside_edge, integral};
use crate::state::topology::Topology;

/// The three corners of a whole face.
const WHOLE: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

/// Whole faces and parts of faces. The first part of a face has the face's index, the others come behind all faces.
pub(crate) struct Elements {
    /// The particles of each element.
    pub corners: Vec<[u32; 3]>,
    /// The face of each element.
    faces: Vec<u32>,
    /// The polygons of those that are no whole face.
    parts: Vec<Option<Box<[Vec3]>>>,
    /// Cuts that have not divided their elements, of those that have any.
    marks: Vec<Option<Box<Marks>>>,
}

impl Elements {
    pub fn of(topology: &Topology) -> Self {
        let count = topology.faces.len();
        let mut elements = Self {
            corners: topology.faces.clone(),
            faces: (0..count as u32).collect(),
            parts: vec![None; count],
            marks: vec![None; count],
        };
        for part in &topology.parts {
            let face = part.face as usize;
            let element = match &mut elements.parts[face] {
                first @ None => {
                    *first = Some(part.corners.clone());
                    face
                }
                Some(_) => elements.push(face, part.corners.clone()),
            };
            elements.marks[element] = Some(part.marks.clone().into());
        }
        elements
    }

    /// Adds a part of the face of an element, and returns its number.
    fn push(&mut self, element: usize, polygon: Box<[Vec3]>) -> usize {
        self.corners.push(self.corners[element]);
        self.faces.push(self.faces[element]);
        self.parts.push(Some(polygon));
        self.marks.push(None);
        self.corners.len() - 1
    }

    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// The face of an element.
    pub fn face(&self, element: usize) -> u32 {
        self.faces[element]
    }

    /// The polygon of an element, by the weights of its particles.
    pub fn polygon(&self, element: usize) -> &[Vec3] {
        self.parts[element].as_deref().unwrap_or(&WHOLE)
    }

    /// The polygon of an element that is no whole face.
    fn part(&self, element: usize) -> Option<&[Vec3]> {
        self.parts[element].as_deref()
    }

    /// True if it is a whole face without cuts.
    pub fn is_whole(&self, element: usize) -> bool {
        self.parts[element].is_none() && self.marks[element].is_none()
    }

    /// An element as a part of face `face`, without the open stretches that are not shared with others; none if it is whole.
    pub fn face_part(
        &self,
        element: usize,
        face: u32,
        is_shared: impl Fn([Vec3; 2]) -> bool,
    ) -> Option<FacePart> {
        let mut marks = self.marks[element].as_deref().cloned().unwrap_or_default();
        marks.open.retain(|&side| is_shared(side));
        let is_part = self.part(element).is_some_and(|part| part != WHOLE) || marks != Marks::default();
        is_part.then(|| FacePart { face, corners: self.polygon(element).into(), marks })
    }

    /// The open stretches of edges, by element.
    pub fn open(&self) -> impl Iterator<Item = (usize, &[[Vec3; 2]])> {
        let marks = self.marks.iter().enumerate();
        marks.filter_map(|(element, marks)| Some((element, &*marks.as_ref()?.open)))
    }

    /// Cuts that have not divided an element.
    pub fn marks(&mut self, element: usize) -> &mut Marks {
        self.marks[element].get_or_insert_default()
    }

    /// Divides an element, and returns the number of the other part. Both keep the marks of its edges.
    pub fn divide(&mut self, element: usize, [kept, other]: [Vec<Vec3>; 2]) -> usize {
        self.parts[element] = Some(kept.into());
        let part = self.push(element, other.into());
        let open = self.marks(element).open.clone();
        self.marks(part).open = open;
        part
    }

    /// True if two elements hang together at the edge from `p` to `q`: the same stretch of it bounds both, and is not open.
    pub fn hang_together(&self, elements: [usize; 2], p: u32, q: u32) -> bool {
        let [Some(a), Some(b)] = elements.map(|element| self.on_edge_of(element, p, q)) else { return false };
        let [low, high] = [a[0].max(b[0]), a[1].min(b[1])];
        let mut open = Vec::new();
        for element in elements {
            let sides = self.marks[element].iter().flat_map(|marks| &marks.open);
            open.extend(self.stretches(element, [p, q], sides.copied()));
        }
        open.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut reached = low;
        for [from, to] in open {
            if from > reached {
                break;
            }
            reached = reached.max(to);
        }
        reached < high
    }

    /// Makes a point of the edge opposite to corner `beside` a corner of the element, if its outline runs through that point.
    pub fn insert(&mut self, element: usize, beside: usize, point: Vec3) {
        let polygon = self.polygon(element);
        let along = (beside + 1) % 3;
        let Some(after) = sides(polygon).position(|ends| {
            let [a, b] = ends.map(|end| end[along]);
            ends.iter().all(|end| end[beside] == 0.0) && a.min(b) < point[along] && point[along] < a.max(b)
        }) else {
            return;
        };
        let mut polygon = polygon.to_vec();
        polygon.insert(after + 1, point);
        self.parts[element] = Some(polygon.into());
    }

    /// The particles at the ends of the edge of the face on which both points lie, the lower index first, and each point's weight of the
    /// higher one; none unless they lie on one.
    pub fn on_edge(&self, element: usize, points: [Vec3; 2]) -> Option<([u32; 2], [f32; 2])> {
        let edge = edge_by(self.corners[element], points)?;
        let high = self.corners[element].iter().position(|&corner| corner == edge[1])?;
        Some((edge, points.map(|point| point[high])))
    }

    /// The ends of the edge of the face on which both points lie, that with the lower index first; none unless they lie on one.
    pub fn edge_of(&self, points: [Vec3; 2], element: usize) -> Option<[Vec3; 2]> {
        let corners = self.corners[element];
        let ends = edge_by(corners, points)?;
        let [low, high] = ends.map(|end| corners.iter().position(|&corner| corner == end));
        Some([WHOLE[low?], WHOLE[high?]])
    }

    /// The part of the edge from `p` to `q` at which the element ends, as weights of the one with the higher index; none if it does not
    /// reach that edge.
    pub fn on_edge_of(&self, element: usize, p: u32, q: u32) -> Option<[f32; 2]> {
        let edge = [p.min(q), p.max(q)];
        let Some(polygon) = self.part(element) else {
            return edge.iter().all(|end| self.corners[element].contains(end)).then_some([0.0, 1.0]);
        };
        let own = self.stretches(element, edge, sides(polygon));
        own.reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
    }

    /// Those of the `sides` that lie on an edge, as weights of its end with the higher index.
    fn stretches(
        &self,
        element: usize,
        [p, q]: [u32; 2],
        sides: impl Iterator<Item = [Vec3; 2]>,
    ) -> impl Iterator<Item = [f32; 2]> {
        let sides = sides.filter_map(move |side| self.on_edge(element, side));
        let own = sides.filter(move |(edge, _)| *edge == [p.min(q), p.max(q)]);
        own.map(|(_, [a, b])| [a.min(b), a.max(b)])
    }

    /// True if the element has the place of particle `corner` itself, not only its weight.
    pub fn reaches(&self, element: usize, corner: u32) -> bool {
        let place = self.corners[element].iter().position(|&other| other == corner);
        place.is_some_and(|place| self.polygon(element).contains(&WHOLE[place]))
    }

    /// The integral of a particle's weight over an element, in thirds of the face's area: 1 for a whole face.
    pub fn weight(&self, element: usize, particle: u32) -> f32 {
        let Some(polygon) = self.part(element) else { return 1.0 };
        let place = self.corners[element].iter().position(|&corner| corner == particle);
        3.0 * place.map_or(0.0, |place| integral(polygon)[place])
    }

    /// A corner of a polygon in the world or at rest: the same bits for the elements at both sides of an edge.
    pub fn place(&self, element: usize, point: Vec3, at: impl Fn(u32) -> Vec3) -> DVec3 {
        let mut corners = [0, 1, 2].map(|corner| (self.corners[element][corner], point[corner]));
        corners.sort_unstable_by_key(|&(particle, _)| particle);
        let weighted = corners.iter().filter(|&&(_, weight)| weight != 0.0);
        weighted.map(|&(particle, weight)| at(particle).as_dvec3() * f64::from(weight)).sum()
    }
}

/// The edge of a face with these `corners` on which both points lie, the lower index first; none unless they lie on one.
pub(crate) fn edge_by(corners: [u32; 3], points: [Vec3; 2]) -> Option<[u32; 2]> {
    let beside = beside_edge(&points)?;
    let [a, b] = [corners[(beside + 1) % 3], corners[(beside + 2) % 3]];
    Some([a.min(b), a.max(b)])
}

/// The sides of a polygon; side `i` begins at its corner `i`.
pub(crate) fn sides(polygon: &[Vec3]) -> impl Iterator<Item = [Vec3; 2]> + '_ {
    (0..polygon.len()).map(|i| [polygon[i], polygon[(i + 1) % polygon.len()]])
}
