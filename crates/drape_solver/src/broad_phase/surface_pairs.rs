//! Pairs of stars of surfaces that could touch: boxes around the patches of each [surface](crate::state::surface).
//!
//! ```text
//!            root            at each search nodes get boxes from the leaves up, around positions and around
//!           /    \           normals. A patch in one piece whose normals all lean one way lies flat: it cannot meet
//!        patch   patch       itself (Volino and Magnenat-Thalmann 1994), and is passed over whole. So are near stars
//!                            within a neighbourhood that lies flat.
//! ```
//!
//! Design: `docs/design/self_contact.md`.

use fearless_simd::Simd;
use glam::{Vec3, Vec3A};

use crate::broad_phase::swept_box::{SweptBox, SweptBoxes};
use crate::constants::{LEAST_FLAT_COSINE, LEAST_SHARED_LEAF_PAIRS};
use crate::parallel::gather::{Gathered, Spare, gather};
use crate::parallel::workers::Workers;
use crate::simd::columns::LANES;
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::set_lanes;
use crate::state::surface::{Node, Surface};

/// A box around unit normals: least values, and greatest ones with their signs turned, so that all are minima.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Lean([f32; 8]);

impl Lean {
    pub const NOTHING: Self = Self([f32::INFINITY; 8]);
    /// All directions.
    pub const EVERY_WAY: Self = Self([f32::NEG_INFINITY; 8]);

    /// The box around one unit vector; nothing for a vector that is none.
    pub fn of(normal: Vec3) -> Self {
        if normal == Vec3::ZERO {
            return Self::NOTHING;
        }
        Self::between(normal.into(), normal.into())
    }

    /// The box from `low` to `high`.
    pub fn between(low: Vec3A, high: Vec3A) -> Self {
        Self([low.x, low.y, low.z, 0.0, -high.x, -high.y, -high.z, 0.0])
    }

    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(other.0) {
            *own = if other < *own { other } else { *own };
        }
    }

    /// Bound of how far directions in the box are from the nearest ones in another: the chord between the unit vectors.
    #[inline(always)]
    pub fn turned_out_of(&self, other: &Self) -> f32 {
        let mut sum = 0.0;
        for (own, other) in self.0.iter().zip(other.0) {
            let out = if *own < other { other - own } else { 0.0 };
            sum += out * out;
        }
        sum.sqrt()
    }

    /// True if all directions in the box lean to the same side.
    pub fn is_flat(&self) -> bool {
        let [x, y, z, _, u, v, w, _] = self.0;
        let (low, high) = (Vec3::new(x, y, z), -Vec3::new(u, v, w));
        let way = low + high;
        let least = (way * low).min(way * high);
        let least = least.x + least.y + least.z;
        least > 0.0 && least * least > LEAST_FLAT_COSINE * LEAST_FLAT_COSINE * way.length_squared()
    }
}

/// Boxes around the parts of sixteen stars: their centres, their edges, their faces, and all of these.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StarBoxes {
    pub centres: SweptBoxes,
    pub edges: SweptBoxes,
    pub faces: SweptBoxes,
    pub whole: SweptBoxes,
}

impl StarBoxes {
    pub const NOTHING: Self = Self {
        centres: SweptBoxes::NOTHING,
        edges: SweptBoxes::NOTHING,
        faces: SweptBoxes::NOTHING,
        whole: SweptBoxes::NOTHING,
    };
}

/// Pairs of stars, by their numbers in the island, of which some parts may touch.
#[derive(Clone, Debug, Default)]
pub(crate) struct StarPairs {
    /// The centre of the first and the faces of the second.
    pub corners: Vec<[u32; 2]>,
    pub edges: Vec<[u32; 2]>,
    /// The edges of the first and the faces of the second that may cross before anything moves, if they are asked for.
    pub crossings: Vec<[u32; 2]>,
}

impl StarPairs {
    pub fn clear(&mut self) {
        self.corners.clear();
        self.edges.clear();
        self.crossings.clear();
    }
}

impl Gathered for StarPairs {
    fn append(&mut self, later: &mut Self) {
        self.corners.append(&mut later.corners);
        self.edges.append(&mut later.edges);
        self.crossings.append(&mut later.crossings);
    }
}

/// The search for pairs of stars.
#[derive(Clone, Debug, Default)]
pub(crate) struct StarPairSearch {
    pub found: StarPairs,
    /// True if it looks for edges and faces that may cross, too.
    pub has_crossings: bool,
    spare: Spare<StarPairs>,
}

/// Boxes of the leaves and nodes of one body.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlacedTree {
    /// The boxes of each leaf's stars.
    pub stars: Vec<StarBoxes>,
    pub leaves: Vec<PlacedLeaf>,
    /// For each slot, the lean of all faces around it.
    pub leans: Vec<Lean>,
    /// The same for the ways before these; every way where there were none.
    pub leans_before: Vec<Lean>,
    /// For each leaf, a bit mask of the stars whose pairs are looked for; pairs of two others are left out.
    pub active: Vec<u16>,
    /// Metres by which the boxes of edges, at least, and of faces are wider than what they hold.
    pub growth: [f32; 2],
    nodes: Vec<PlacedNode>,
    /// For each star, true if the stars around it lie flat.
    is_flat: Vec<bool>,
    /// Leans of wider and wider neighbourhoods.
    wider: [Vec<Lean>; 2],
}

/// A leaf as a whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedLeaf {
    pub bounds: SweptBox,
    /// The bounds of the stars whose pairs are looked for.
    pub active: SweptBox,
    /// The lean of its stars' faces.
    pub lean: Lean,
}

#[derive(Clone, Copy, Debug)]
struct PlacedNode {
    bounds: SweptBox,
    /// The bounds of the stars whose pairs are looked for; nothing if there is none.
    active: SweptBox,
    lean: Lean,
    is_flat: bool,
    is_active: bool,
}

impl PlacedNode {
    const NOTHING: Self = Self {
        bounds: SweptBox::NOTHING,
        active: SweptBox::NOTHING,
        lean: Lean::NOTHING,
        is_flat: false,
        is_active: false,
    };

    /// True if the pairs of a star of one are looked for that may touch something of the other.
    fn may_pair(&self, other: &Self) -> bool {
        self.bounds.meets(&other.bounds)
            && (self.active.meets(&other.bounds) || self.bounds.meets(&other.active))
    }
}

/// A body's surface and the boxes of its patches.
#[derive(Clone, Copy)]
pub(crate) struct PlacedSurface<'a> {
    pub surface: &'a Surface,
    pub at: &'a PlacedTree,
    /// Number of the body's first leaf in the island.
    pub first_leaf: u32,
}

impl PlacedTree {
    /// Puts boxes around all leaves and nodes, from those of the stars.
    pub fn refit_from_stars(&mut self, surface: &Surface) {
        let Self { stars, leaves, leans, active, .. } = self;
        leaves.clear();
        let all = stars.iter().zip(&*active).zip(surface.stars.chunks_exact(LANES));
        leaves.extend(all.map(|((boxes, &active), stars)| {
            let mut lean = Lean::NOTHING;
            stars.iter().for_each(|star| lean.add(&leans[star.centre as usize]));
            let bounds = boxes.whole.of(u16::MAX);
            let active = if active == u16::MAX { bounds } else { boxes.whole.of(active) };
            PlacedLeaf { bounds, active, lean }
        }));
        self.refit(surface);
    }

    /// Puts boxes around all nodes, from those of the leaves as a whole.
    pub fn refit_from_leaves(&mut self, surface: &Surface) {
        let Self { leaves, .. } = self;
        // What does not hang together may meet itself, flat or not.
        for node in surface.nodes.iter().filter(|node| node.right == 0 && !node.is_connected) {
            leaves[leaf(node) as usize].lean = Lean::EVERY_WAY;
        }
        self.refit(surface);
    }

    /// Puts boxes around all nodes, from those of the leaves.
    fn refit(&mut self, surface: &Surface) {
        let Self { leaves, active, nodes, .. } = self;
        nodes.clear();
        nodes.resize(surface.nodes.len(), PlacedNode::NOTHING);
        for (place, node) in surface.nodes.iter().enumerate().rev() {
            let (PlacedLeaf { bounds, active, lean }, is_active) = if node.right == 0 {
                let leaf = node.first as usize / LANES;
                (leaves[leaf], active[leaf] != 0)
            } else {
                let [a, b] = [place + 1, node.right as usize].map(|child| &nodes[child]);
                let mut lean = a.lean;
                lean.add(&b.lean);
                let (bounds, active) = (a.bounds.and(&b.bounds), a.active.and(&b.active));
                (PlacedLeaf { bounds, active, lean }, a.is_active || b.is_active)
            };
            let is_flat = node.is_connected && lean.is_flat();
            nodes[place] = PlacedNode { bounds, active, lean, is_flat, is_active };
        }
    }

    /// Finds the stars around which all faces lie flat.
    pub fn find_flat(&mut self, surface: &Surface) {
        let Self { leans, wider: [one, two], is_flat, .. } = self;
        widen(leans, one, surface);
        widen(one, two, surface);
        is_flat.clear();
        is_flat.extend(surface.stars.iter().map(|star| two[star.centre as usize].is_flat()));
    }
}

/// Adds to the lean of each slot those at the other ends of its edges.
fn widen(leans: &[Lean], wider: &mut Vec<Lean>, surface: &Surface) {
    wider.clear();
    wider.extend(leans.iter().zip(0..).map(|(lean, slot)| {
        let mut all = *lean;
        surface.around_slot(slot).iter().for_each(|&other| all.add(&leans[other as usize]));
        all
    }));
}

impl PlacedSurface<'_> {
    /// Appends pairs of leaves of the body that may touch, but not within flat patches.
    pub fn own_pairs(&self, found: &mut Vec<[u32; 2]>) {
        if !self.surface.nodes.is_empty() {
            self.pairs_within(0, found);
        }
    }

    fn pairs_within(&self, place: usize, found: &mut Vec<[u32; 2]>) {
        let placed = &self.at.nodes[place];
        if placed.is_flat || !placed.is_active {
            return;
        }
        let node = &self.surface.nodes[place];
        if node.right == 0 {
            found.push([leaf(node); 2]);
            return;
        }
        let right = node.right as usize;
        self.pairs_within(place + 1, found);
        self.pairs_within(right, found);
        self.pairs_between(place + 1, self, right, found);
    }

    /// True if two leaves that may touch are near each other in the surface and lie flat together. What lies between them is
    /// near both and is looked at as well.
    pub fn is_flat_pair(&self, leaves: [u32; 2]) -> bool {
        self.surface.leaves.are_near(leaves) && {
            let [mut lean, other] = leaves.map(|leaf| self.at.leaves[leaf as usize].lean);
            lean.add(&other);
            lean.is_flat()
        }
    }

    /// Appends pairs of a leaf of this body and one of another that may touch.
    pub fn pairs_with(&self, other: &PlacedSurface, found: &mut Vec<[u32; 2]>) {
        if !self.surface.nodes.is_empty() && !other.surface.nodes.is_empty() {
            self.pairs_between(0, other, 0, found);
        }
    }

    fn pairs_between(&self, here: usize, other: &PlacedSurface, there: usize, found: &mut Vec<[u32; 2]>) {
        let (p, q) = (&self.at.nodes[here], &other.at.nodes[there]);
        if !p.may_pair(q) {
            return;
        }
        let (a, b) = (&self.surface.nodes[here], &other.surface.nodes[there]);
        if a.right == 0 && b.right == 0 {
            found.push([leaf(a), leaf(b)]);
        } else if b.right == 0 || (a.right != 0 && a.count >= b.count) {
            self.pairs_between(here + 1, other, there, found);
            self.pairs_between(a.right as usize, other, there, found);
        } else {
            self.pairs_between(here, other, there + 1, found);
            self.pairs_between(here, other, b.right as usize, found);
        }
    }

    /// Bit mask of those among the stars `of` a leaf that lie with a star in a flat neighbourhood.
    #[inline(always)]
    fn flat_neighbours(&self, star: u32, leaf: u32, of: u16) -> u16 {
        let near = self.surface.near_star(star as usize);
        let Some(&(_, mask)) = near.iter().find(|(other, _)| *other == leaf) else { return 0 };
        if self.at.is_flat[star as usize] {
            return mask;
        }
        set_lanes(mask & of).fold(0, |flat, lane| {
            let is_flat = self.are_flat([star, leaf * LANES as u32 + lane as u32]);
            flat | (u16::from(is_flat) << lane)
        })
    }

    /// True if all faces lie flat around two near stars, and around what is between them.
    fn are_flat(&self, stars: [u32; 2]) -> bool {
        let [a, b] = stars.map(|star| self.surface.stars[star as usize].centre as usize);
        let (leans, around) = (&self.at.leans, &self.at.wider[0]);
        [[a, b], [b, a]].into_iter().any(|[a, b]| {
            let mut all = around[a];
            all.add(&leans[b]);
            all.is_flat()
        })
    }

    /// Appends the pairs of stars of some pairs of leaves of this body and `other`.
    pub fn star_pairs(
        &self,
        other: &PlacedSurface,
        leaves: &mut [[u32; 2]],
        isa: Isa,
        workers: &Workers,
        search: &mut StarPairSearch,
    ) {
        let StarPairSearch { found, has_crossings, spare } = search;
        let (is_one, has_crossings) = (core::ptr::eq(self.at, other.at), *has_crossings);
        gather(leaves, LEAST_SHARED_LEAF_PAIRS, workers, spare, found, &|leaves, found| {
            isa.run(FindStarPairs { own: self, other, is_one, has_crossings, leaves, found });
        });
    }
}

fn leaf(node: &Node) -> u32 {
    node.first / LANES as u32
}

struct FindStarPairs<'a> {
    own: &'a PlacedSurface<'a>,
    other: &'a PlacedSurface<'a>,
    is_one: bool,
    has_crossings: bool,
    leaves: &'a [[u32; 2]],
    found: &'a mut StarPairs,
}

impl Kernel for FindStarPairs<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { own, other, is_one, has_crossings, leaves, found } = self;
        // A hair less, so that rounding hides no crossing.
        let less = |edges: &PlacedTree, faces: &PlacedTree| 0.99 * (edges.growth[0] + faces.growth[1]);
        let (less, less_back) = (less(own.at, other.at), less(other.at, own.at));
        for &[a, b] in leaves {
            let (x, y) = (&own.at.stars[a as usize], &other.at.stars[b as usize]);
            let of_b = &other.at.leaves[b as usize];
            let (active, active_there) = (own.at.active[a as usize], other.at.active[b as usize]);
            let mut from = x.whole.meets(simd, &of_b.bounds);
            let to = y.whole.meets(simd, &own.at.leaves[a as usize].bounds);
            if active != u16::MAX {
                from &= active | x.whole.meets(simd, &of_b.active);
            }
            if to == 0 {
                continue;
            }
            for lane in set_lanes(from) {
                let star = a * LANES as u32 + lane as u32;
                let mut hits = to & y.whole.meets_lane(simd, &x.whole, lane);
                if active & (1 << lane) == 0 {
                    hits &= active_there;
                }
                if is_one && hits != 0 {
                    if a == b {
                        hits &= u16::MAX.checked_shl(lane as u32 + 1).unwrap_or(0);
                    }
                    hits &= !own.flat_neighbours(star, b, hits);
                }
                if hits == 0 {
                    continue;
                }
                let star = own.first_leaf * LANES as u32 + star;
                let first = (other.first_leaf + b) * LANES as u32;
                let own_first = |hits: u16| set_lanes(hits).map(move |k| [star, first + k as u32]);
                let other_first = |hits: u16| set_lanes(hits).map(move |k| [first + k as u32, star]);
                found.corners.extend(own_first(hits & y.faces.meets_lane(simd, &x.centres, lane)));
                found.corners.extend(other_first(hits & y.centres.meets_lane(simd, &x.faces, lane)));
                found.edges.extend(own_first(hits & y.edges.meets_lane(simd, &x.edges, lane)));
                if has_crossings {
                    let crossing = y.faces.overlaps_lane(simd, &x.edges, lane, less);
                    found.crossings.extend(own_first(hits & crossing));
                    let crossing = y.edges.overlaps_lane(simd, &x.faces, lane, less_back);
                    found.crossings.extend(other_first(hits & crossing));
                }
            }
        }
    }
}
