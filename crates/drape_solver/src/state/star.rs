//! Stars: the parts of a surface, particle by particle.
//!
//! A particle with up to three of its edges and two of its faces. Each corner, edge and face belongs to one
//! star, so pairs of stars cover each pair of a corner and a face, and each pair of edges, once (the representative
//! triangles of Curtis et al. 2008, with the particle in place of the triangle).
//!
//! ```text
//!        3 o---o 2        centre 0; edges 0-1, 0-2, 0-3; faces 0-1-2, 0-2-3: in a grid of triangles each particle
//!          | / |          has as much, but along the rim
//!        0 o---o 1
//! ```
//!
//! Links of a rope are edges without faces; a particle without either is a star of its centre alone. A particle with
//! more edges or faces than a star holds has several stars, of which the first tests the centre.
//!
//! Design: `docs/design/self_contact.md`.

/// No particle.
pub(crate) const NONE: u32 = u32::MAX;

/// Edges and faces that a star holds.
pub(crate) const EDGES: usize = 3;
pub(crate) const FACES: usize = 2;

/// The corners of a star: its centre, other ends of its edges, other corners of its faces.
pub(crate) const CORNERS: usize = 1 + EDGES + 2 * FACES;

/// A particle with some of its edges and faces, by slots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Star {
    pub centre: u32,
    /// The other ends of its edges; the centre where there is none.
    pub ends: [u32; EDGES],
    /// The other corners of its faces; the centre where there is none.
    pub faces: [[u32; 2]; FACES],
    /// Third corners of the faces beside each edge, or [`NONE`].
    pub sides: [[u32; 2]; EDGES],
    pub edge_count: u8,
    pub face_count: u8,
    /// True if this star tests its centre against faces.
    pub has_centre: bool,
}

impl Star {
    pub fn of(centre: u32, has_centre: bool) -> Self {
        Self {
            centre,
            ends: [centre; EDGES],
            faces: [[centre; 2]; FACES],
            sides: [[NONE; 2]; EDGES],
            edge_count: 0,
            face_count: 0,
            has_centre,
        }
    }

    /// True if it only fills up a leaf.
    pub fn is_nothing(&self) -> bool {
        !self.has_centre && self.edge_count == 0 && self.face_count == 0
    }

    /// True if its edges are the links of a rope.
    pub fn is_link(&self) -> bool {
        self.edge_count > 0 && self.sides[0] == [NONE; 2]
    }

    /// The same with slots replaced.
    pub fn map(&self, mut to: impl FnMut(u32) -> u32) -> Self {
        let mut side = |slot: u32| if slot == NONE { NONE } else { to(slot) };
        let sides = self.sides.map(|sides| sides.map(&mut side));
        Self {
            centre: to(self.centre),
            ends: self.ends.map(&mut to),
            faces: self.faces.map(|face| face.map(&mut to)),
            sides,
            ..*self
        }
    }

    /// The corner of this number: the centre, the other ends of the edges, the other corners of the faces.
    pub fn corner(&self, corner: usize) -> u32 {
        match corner {
            0 => self.centre,
            1..=EDGES => self.ends[corner - 1],
            _ => self.faces.as_flattened()[corner - 1 - EDGES],
        }
    }

    /// The corners of face `k`.
    pub fn face(&self, k: usize) -> [u32; 3] {
        [self.centre, self.faces[k][0], self.faces[k][1]]
    }

    /// The ends of edge `k`.
    pub fn edge(&self, k: usize) -> [u32; 2] {
        [self.centre, self.ends[k]]
    }
}
