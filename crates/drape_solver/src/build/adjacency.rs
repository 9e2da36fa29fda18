//! The faces of a body, or the links of a rope, around each particle.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_3};

use glam::Vec3;

use crate::state::topology::Topology;

/// The elements of a body: its faces, or its links if it has no faces. Looks them up by the particles at their corners.
pub(crate) struct Adjacency<'a> {
    topology: &'a Topology,
    faces: &'a [[u32; 3]],
    /// Index into `around` of each particle's first element; one entry more at the end.
    first: Vec<u32>,
    /// Elements, particle by particle.
    around: Vec<u32>,
}

/// The index of the first element of each of `count` particles, and one more at the end, in the elements by their corners.
pub(crate) fn by_corner<const N: usize>(
    elements: impl ExactSizeIterator<Item = [u32; N]> + Clone,
    count: usize,
) -> (Vec<u32>, Vec<u32>) {
    let mut first = vec![0; count + 1];
    elements.clone().flatten().for_each(|corner| first[corner as usize + 1] += 1);
    for particle in 0..count {
        first[particle + 1] += first[particle];
    }
    let mut next = first.clone();
    let mut around = vec![0; N * elements.len()];
    for (element, corners) in (0..).zip(elements) {
        for corner in corners {
            around[next[corner as usize] as usize] = element;
            next[corner as usize] += 1;
        }
    }
    (first, around)
}

impl<'a> Adjacency<'a> {
    pub fn new(topology: &'a Topology) -> Self {
        Self::of(topology, &topology.faces)
    }

    /// That of a topology with these faces in place of its own.
    pub fn of(topology: &'a Topology, faces: &'a [[u32; 3]]) -> Self {
        let count = topology.particle_count();
        let (first, around) = if faces.is_empty() {
            by_corner(topology.segments.iter().copied(), count)
        } else {
            by_corner(faces.iter().copied(), count)
        };
        Self { topology, faces, first, around }
    }

    pub fn topology(&self) -> &'a Topology {
        self.topology
    }

    /// True if the elements are faces, false if they are links.
    pub fn has_faces(&self) -> bool {
        !self.faces.is_empty()
    }

    /// The particles of face or link `element`.
    #[inline]
    pub fn corners(&self, element: usize) -> &'a [u32] {
        if self.has_faces() { &self.faces[element] } else { &self.topology.segments[element] }
    }

    /// The faces or links at a particle, in order.
    #[inline]
    pub fn around(&self, particle: u32) -> impl Iterator<Item = usize> + Clone + '_ {
        let own = self.first[particle as usize] as usize..self.first[particle as usize + 1] as usize;
        self.around[own].iter().map(|&element| element as usize)
    }

    /// Area of a face in square metres, or length of a link in metres, at rest.
    pub fn size(&self, element: usize) -> f32 {
        let rest = |corner: u32| self.topology.rest[corner as usize];
        match *self.corners(element) {
            [a, b, c] => 0.5 * (rest(b) - rest(a)).cross(rest(c) - rest(a)).length(),
            [a, b] => rest(a).distance(rest(b)),
            _ => 0.0,
        }
    }

    /// The faces around a particle in order, if they make one fan.
    pub fn fan(&self, particle: u32) -> Option<Fan> {
        if !self.has_faces() {
            return None;
        }
        // The side opposite to the particle in each face, in the face's sense.
        let sides: Vec<[u32; 2]> = self
            .around(particle)
            .filter_map(|face| match *self.corners(face) {
                [a, b, c] if a == particle => Some([b, c]),
                [a, b, c] if b == particle => Some([c, a]),
                [a, b, c] if c == particle => Some([a, b]),
                _ => None,
            })
            .collect();
        let begins = |spoke: u32| sides.iter().find(|side| side[0] == spoke);
        let rim = sides.iter().find(|side| sides.iter().all(|other| other[1] != side[0]));
        let start = rim.or(sides.first())?[0];
        let (mut spokes, mut angles) = (vec![start], vec![0.0]);
        let (mut spoke, mut angle) = (start, 0.0);
        let centre = self.topology.rest[particle as usize];
        while let Some(&[from, to]) = begins(spoke) {
            let [p, q] = [from, to].map(|end| self.topology.rest[end as usize] - centre);
            angle += angle_between(p, q);
            spokes.push(to);
            angles.push(angle);
            spoke = to;
            if to == start || spokes.len() > sides.len() {
                break;
            }
        }
        (spokes.len() == sides.len() + 1).then_some(Fan { spokes, angles })
    }
}

/// The angle between two directions in radians.
fn angle_between(p: Vec3, q: Vec3) -> f32 {
    libm::atan2f(p.cross(q).length(), p.dot(q))
}

/// The faces around a particle at rest, laid out flat.
///
/// ```text
///      s2   s1        spokes lead from the particle to the other corners; the fan is closed
///        \  /         if its last spoke is the first again, and open at the rim of the
///   s3 ---o--- s0     cloth and at the end of a tear
/// ```
pub(crate) struct Fan {
    spokes: Vec<u32>,
    /// The angle from the first spoke to each spoke in radians.
    angles: Vec<f32>,
}

impl Fan {
    pub fn is_closed(&self) -> bool {
        self.spokes.first() == self.spokes.last()
    }

    /// The spokes along which the fan splits under a pull at spoke `pulled`: those most nearly at right angles to the pull.
    /// One spoke of an open fan, two of a closed one; none if the fan cannot split.
    pub fn cracks(&self, pulled: u32) -> Option<Vec<u32>> {
        let last = self.spokes.len() - 1;
        let pulled = self.spokes.iter().position(|&spoke| spoke == pulled)?;
        let inner = if self.is_closed() { 0..last } else { 1..last };
        let total = self.angles[last];
        // The spoke nearest to the angle `target` the shorter way round, and its distance in radians.
        let nearest = |target: f32| {
            let distance = |&spoke: &usize| {
                let distance = (self.angles[spoke] - target).abs();
                if self.is_closed() { distance.min((total - distance).abs()) } else { distance }
            };
            let others = inner.clone().filter(|&spoke| spoke != pulled);
            others.map(|spoke| (distance(&spoke), spoke)).min_by(|p, q| p.0.total_cmp(&q.0))
        };
        let angle = self.angles[pulled];
        if self.is_closed() {
            let quarter = 0.25 * total;
            let [(_, left), (_, right)] =
                [nearest((angle + quarter) % total)?, nearest((angle + 3.0 * quarter) % total)?];
            return (left != right).then(|| vec![self.spokes[left], self.spokes[right]]);
        }
        let (distance, spoke) = [angle + FRAC_PI_2, angle - FRAC_PI_2]
            .into_iter()
            .filter_map(nearest)
            .min_by(|p, q| p.0.total_cmp(&q.0))?;
        (distance < FRAC_PI_3).then(|| vec![self.spokes[spoke]])
    }
}
