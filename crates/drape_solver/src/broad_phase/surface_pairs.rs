//! Pairs of elements of surfaces that could touch: boxes around the patches of a [surface tree](crate::state::surface_tree).
//!
//! ```text
//!            root            at each search nodes get boxes from the leaves up, around positions and around
//!           /    \           normals. A patch in one piece whose normals all lean one way lies flat: it cannot meet
//!        patch   patch       itself (Volino and Magnenat-Thalmann 1994), and is passed over whole.
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

use crate::constants::LEAST_FLAT_COSINE;
use crate::state::surface_tree::{Bounds, SurfaceElement, SurfaceTree};

/// Boxes around the elements and patches of a body.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlacedTree {
    elements: Vec<Bounds>,
    nodes: Vec<(Bounds, Bounds)>,
}

/// A body's tree and the boxes of its patches.
#[derive(Clone, Copy)]
pub(crate) struct PlacedSurface<'a> {
    pub tree: &'a SurfaceTree,
    pub at: &'a PlacedTree,
}

impl SurfaceTree {
    /// Puts boxes around the patches. `corners` returns the places of an element's corners, now and at the start of the
    /// substep.
    pub fn place(&self, at: &mut PlacedTree, corners: impl Fn(&SurfaceElement) -> [[Vec3; 3]; 2]) {
        at.elements.clear();
        at.nodes.clear();
        at.nodes.resize(self.nodes.len(), (Bounds::NOTHING, Bounds::NOTHING));
        at.elements.extend(self.elements.iter().map(|element| {
            let [now, start] = corners(element);
            Bounds::of(&now).and(Bounds::of(&start))
        }));
        for (place, node) in self.nodes.iter().enumerate().rev() {
            at.nodes[place] = if node.right == 0 {
                let range = node.first as usize..(node.first + node.count) as usize;
                let boxes = at.elements[range.clone()].iter();
                let lean = self.elements[range].iter().map(|element| lean(element, corners(element)[1]));
                (
                    boxes.fold(Bounds::NOTHING, |all, &b| all.and(b)),
                    lean.fold(Bounds::NOTHING, |all, n| all.and(Bounds { low: n, high: n })),
                )
            } else {
                let ((a, n), (b, m)) = (at.nodes[place + 1], at.nodes[node.right as usize]);
                (a.and(b), n.and(m))
            };
        }
    }
}

/// The unit normal of a face, or the direction of a link: a rope whose links all lean one way cannot meet itself either.
fn lean(element: &SurfaceElement, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let way = if element.is_face() { (b - a).cross(c - a) } else { b - a };
    way.normalize_or_zero()
}

/// True if all directions in the box lean to the same side.
fn is_flat(lean: &Bounds) -> bool {
    let way = lean.low + lean.high;
    let least = (way * lean.low).min(way * lean.high);
    least.x + least.y + least.z > LEAST_FLAT_COSINE * way.length()
}

impl PlacedSurface<'_> {
    /// Calls `visit` for any two elements of the body whose boxes, wider by `margin`, overlap, but not within flat
    /// patches.
    pub fn own_pairs(&self, margin: f32, visit: &mut impl FnMut(usize, usize)) {
        if !self.tree.nodes.is_empty() {
            self.pairs_within(0, margin, visit);
        }
    }

    fn pairs_within(&self, place: usize, margin: f32, visit: &mut impl FnMut(usize, usize)) {
        let node = &self.tree.nodes[place];
        if node.is_connected && is_flat(&self.at.nodes[place].1) {
            return;
        }
        if node.right == 0 {
            for a in node.first..node.first + node.count {
                for b in a + 1..node.first + node.count {
                    visit(a as usize, b as usize);
                }
            }
            return;
        }
        let right = node.right as usize;
        self.pairs_within(place + 1, margin, visit);
        self.pairs_within(right, margin, visit);
        self.pairs_between(place + 1, self, right, margin, visit);
    }

    /// Calls `visit` for any element of this body and any of another whose boxes, wider by `margin`, overlap.
    pub fn pairs_with(&self, other: &PlacedSurface, margin: f32, visit: &mut impl FnMut(usize, usize)) {
        if !self.tree.nodes.is_empty() && !other.tree.nodes.is_empty() {
            self.pairs_between(0, other, 0, margin, visit);
        }
    }

    fn pairs_between(
        &self,
        here: usize,
        other: &PlacedSurface,
        there: usize,
        margin: f32,
        visit: &mut impl FnMut(usize, usize),
    ) {
        if !self.at.nodes[here].0.grown(margin).meets(&other.at.nodes[there].0) {
            return;
        }
        let (a, b) = (&self.tree.nodes[here], &other.tree.nodes[there]);
        if a.right == 0 && b.right == 0 {
            for p in a.first..a.first + a.count {
                let own = self.at.elements[p as usize].grown(margin);
                for q in b.first..b.first + b.count {
                    if own.meets(&other.at.elements[q as usize]) {
                        visit(p as usize, q as usize);
                    }
                }
            }
        } else if b.right == 0 || (a.right != 0 && a.count >= b.count) {
            self.pairs_between(here + 1, other, there, margin, visit);
            self.pairs_between(a.right as usize, other, there, margin, visit);
        } else {
            self.pairs_between(here, other, there + 1, margin, visit);
            self.pairs_between(here, other, b.right as usize, margin, visit);
        }
    }
}
