//! Sides of faces that an obstacle may touch, each once.
//!
//! Design: `docs/design/obstacles.md`.

/// A side of a face, by the slots of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct FaceSide {
    /// The lower slot first.
    pub ends: [u32; 2],
    /// Index of the first face that has it.
    pub face: usize,
}

/// The sides of some faces.
#[derive(Clone, Debug, Default)]
pub(crate) struct FaceSides {
    sides: Vec<FaceSide>,
}

impl FaceSides {
    /// Forgets all sides, and makes room for `most`.
    pub fn begin(&mut self, most: usize) {
        self.sides.clear();
        self.sides.reserve(most);
    }

    /// Notes the three sides of a face with these slots.
    pub fn note(&mut self, [a, b, c]: [u32; 3], face: usize) {
        let side = |a: u32, b: u32| FaceSide { ends: [a.min(b), a.max(b)], face };
        self.sides.extend([side(a, b), side(b, c), side(c, a)]);
    }

    /// All sides, those that faces share once, in the order of their slots.
    pub fn once(&mut self) -> &[FaceSide] {
        self.sides.sort_unstable();
        self.sides.dedup_by_key(|side| side.ends);
        &self.sides
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_side_between_two_faces_is_listed_once_with_the_first_of_them() {
        let mut sides = FaceSides::default();
        sides.begin(6);
        sides.note([2, 1, 3], 7);
        sides.note([0, 1, 2], 4);
        let found: Vec<_> = sides.once().iter().map(|side| (side.ends, side.face)).collect();
        assert_eq!(found, [([0, 1], 4), ([0, 2], 4), ([1, 2], 4), ([1, 3], 7), ([2, 3], 7)]);
    }
}
