//! The leaves of a [surface](super::surface), each as a whole: its corners and its faces, each once, and the leaves near it.
//!
//! ```text
//!     +---+---+---+---+
//!     | n | n | n | n |      a leaf, the leaves around it, which share corners with it,
//!     +---+---+---+---+      and those near it: around it or around one of these
//!     | a | a | a | n |
//!     +---+---+---+---+
//!     | a | * | a | n |
//!     +---+---+---+---+
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use core::ops::Range;

use glam::Vec3;

use crate::simd::columns::LANES;
use crate::state::star::{CORNERS, Star};

/// The leaves of a surface, in the order of its stars.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceLeaves {
    leaves: Vec<Leaf>,
    corners: Vec<u32>,
    faces: Vec<LeafFace>,
    near: Vec<u32>,
    /// True if the surface has no faces, but links.
    pub are_links: bool,
}

/// Where a leaf's lists begin and end.
#[derive(Clone, Debug)]
struct Leaf {
    corners: Range<usize>,
    faces: Range<usize>,
    near: Range<usize>,
}

/// A face, or a link, of a leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeafFace {
    /// Places of its corners in the list of the leaf's, the one opposite the longest side first; the last one of a link twice.
    pub corners: [u8; 3],
    /// One over the length at rest of the product of two sides, in 1/m², or of the link, in 1/m; 0 where that has none.
    pub scale: f32,
}

impl SurfaceLeaves {
    /// The leaves of these stars. `rest` are the places of all slots at rest, in metres.
    pub fn new(stars: &[Star], rest: &[Vec3]) -> Self {
        let are_links = stars.iter().all(|star| star.face_count == 0);
        let mut all = Self { are_links, ..Self::default() };
        let (leaf_stars, _) = stars.as_chunks::<LANES>();
        for stars in leaf_stars {
            all.push(stars, rest);
        }
        let around = all.around();
        for (leaf, own) in all.leaves.iter_mut().zip(&around) {
            let near = sorted(own.iter().flat_map(|&other| &around[other as usize]).copied());
            leaf.near = all.near.len()..all.near.len() + near.len();
            all.near.extend(near);
        }
        all
    }

    /// Adds the leaf of these stars, with its corners and faces.
    fn push(&mut self, stars: &[Star; LANES], rest: &[Vec3]) {
        let real = || stars.iter().filter(|star| !star.is_nothing());
        let corners = sorted(real().flat_map(|star| (0..CORNERS).map(|k| star.corner(k))));
        let place = |slot: u32| corners.binary_search(&slot).unwrap_or_default() as u8;
        let at = |slot: u32| rest[slot as usize];
        let inverse = |length: f32| if length > 0.0 { length.recip() } else { 0.0 };
        let first_face = self.faces.len();
        for star in real() {
            for k in 0..star.face_count as usize {
                let [a, b, c] = from_widest(star.face(k), at);
                let area = (at(b) - at(a)).cross(at(c) - at(a)).length();
                self.faces.push(LeafFace { corners: [a, b, c].map(place), scale: inverse(area) });
            }
            for k in 0..if self.are_links { star.edge_count as usize } else { 0 } {
                let [a, b] = star.edge(k);
                let length = at(a).distance(at(b));
                self.faces.push(LeafFace { corners: [a, b, b].map(place), scale: inverse(length) });
            }
        }
        let first = self.corners.len();
        self.corners.extend(corners);
        self.leaves.push(Leaf {
            corners: first..self.corners.len(),
            faces: first_face..self.faces.len(),
            near: 0..0,
        });
    }

    /// For each leaf those that share corners with it, itself too, ascending.
    fn around(&self) -> Vec<Vec<u32>> {
        let corners = |(number, leaf): (u32, &Leaf)| {
            self.corners[leaf.corners.clone()].iter().map(move |&slot| (slot, number))
        };
        let mut leaves_of_slots: Vec<(u32, u32)> = (0..).zip(&self.leaves).flat_map(corners).collect();
        leaves_of_slots.sort_unstable();
        let mut around = vec![Vec::new(); self.leaves.len()];
        for of_slot in leaves_of_slots.chunk_by(|a, b| a.0 == b.0) {
            of_slot.iter().for_each(|a| around[a.1 as usize].extend(of_slot.iter().map(|b| b.1)));
        }
        around.into_iter().map(|all| sorted(all.into_iter())).collect()
    }

    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Slots of the corners of a leaf's stars, at most [`MOST_CORNERS`].
    pub fn corners(&self, leaf: usize) -> &[u32] {
        &self.corners[self.leaves[leaf].corners.clone()]
    }

    /// The faces that a leaf's stars own, or their links.
    pub fn faces(&self, leaf: usize) -> &[LeafFace] {
        &self.faces[self.leaves[leaf].faces.clone()]
    }

    /// True if a leaf is around the other, or if there is one between them that is around both.
    pub fn are_near(&self, [leaf, other]: [u32; 2]) -> bool {
        self.near[self.leaves[leaf as usize].near.clone()].binary_search(&other).is_ok()
    }
}

/// Corners of a leaf at most.
pub(crate) const MOST_CORNERS: usize = LANES * CORNERS;

/// The corners of a face, turned so that the one opposite the longest side comes first.
fn from_widest([a, b, c]: [u32; 3], at: impl Fn(u32) -> Vec3) -> [u32; 3] {
    let length = |p: u32, q: u32| at(p).distance_squared(at(q));
    let sides = [length(b, c), length(c, a), length(a, b)];
    let longest = (1..3).fold(0, |longest, k| if sides[k] > sides[longest] { k } else { longest });
    [[a, b, c], [b, c, a], [c, a, b]][longest]
}

fn sorted(values: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut all: Vec<u32> = values.collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build::cloth::ClothBuilder;
    use crate::build::rope::RopeBuilder;
    use crate::state::settings::BodySettings;
    use crate::state::topology::Topology;

    fn topologies() -> Vec<Topology> {
        let settings = BodySettings::default();
        let cloth = ClothBuilder::new(1.0, 1.3, 12, 21).build(settings).expect("valid");
        let rope = RopeBuilder::new(Vec3::ZERO, Vec3::X * 3.0, 70).build(settings).expect("valid");
        vec![(*cloth.topology).clone(), (*rope.topology).clone()]
    }

    /// Turned so that the least corner comes first: the winding shows.
    fn turned(mut face: [u32; 3]) -> [u32; 3] {
        let least = (0..3).fold(0, |least, k| if face[k] < face[least] { k } else { least });
        face.rotate_left(least);
        face
    }

    /// The grid's squares are 1/11 m x 1.3/20 m, the rope's links 3/69 m long.
    #[test]
    fn each_face_and_each_link_belongs_to_one_leaf() {
        let areas = [1.0 / 11.0 * 1.3 / 20.0, 3.0 / 69.0];
        for (topology, area) in topologies().into_iter().zip(areas) {
            let leaves = &topology.surface().leaves;
            let slot = |index: u32| topology.layout.slot(index as usize) as u32;
            let mut found = Vec::new();
            for leaf in 0..leaves.len() {
                for face in leaves.faces(leaf) {
                    found.push(turned(face.corners.map(|corner| leaves.corners(leaf)[usize::from(corner)])));
                    assert!((face.scale * area - 1.0).abs() < 1e-4, "{face:?}");
                }
            }
            let links = topology.segments.iter().map(|&[a, b]| [a, b, b]);
            let faces = topology.faces.iter().copied();
            let mut expected: Vec<[u32; 3]> = faces.chain(links).map(|face| turned(face.map(slot))).collect();
            if leaves.are_links {
                // A link may be listed from either end.
                let ends = |&[a, b, c]: &[u32; 3]| [a.min(c), b.max(a), b.max(a)];
                found = found.iter().map(ends).collect();
                expected = expected.iter().map(ends).collect();
            }
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn the_first_corner_of_a_face_is_opposite_its_longest_side() {
        let [cloth, _] = topologies().try_into().expect("two");
        let leaves = &cloth.surface().leaves;
        let mut rest = vec![Vec3::ZERO; cloth.layout.cells() * LANES];
        cloth.layout.slots().enumerate().for_each(|(index, slot)| rest[slot] = cloth.rest[index]);
        for leaf in 0..leaves.len() {
            for face in leaves.faces(leaf) {
                let [a, b, c] =
                    face.corners.map(|corner| rest[leaves.corners(leaf)[usize::from(corner)] as usize]);
                assert!(b.distance(c) >= a.distance(b).max(a.distance(c)), "{face:?}");
            }
        }
    }

    #[test]
    fn near_are_leaves_with_one_between_them_that_shares_corners_with_both() {
        for topology in topologies() {
            let leaves = &topology.surface().leaves;
            let share =
                |a: usize, b: usize| leaves.corners(a).iter().any(|slot| leaves.corners(b).contains(slot));
            let all = || 0..leaves.len();
            for (a, b) in all().flat_map(|a| all().map(move |b| (a, b))) {
                let is_near = all().any(|c| share(a, c) && share(c, b));
                assert_eq!(leaves.are_near([a as u32, b as u32]), is_near, "{a} {b}");
            }
            let far = all()
                .flat_map(|a| all().map(move |b| [a as u32, b as u32]))
                .filter(|&pair| !leaves.are_near(pair));
            assert!(far.count() > 0, "some are far from each other");
        }
    }
}
