//! The surfaces of an island, placed in space: their stars in rows and boxes.
//!
//! Design: `docs/design/self_contact.md`.

use std::sync::{Arc, Weak};

use glam::{Vec3, Vec4};

use crate::broad_phase::surface_pairs::{Lean, PlacedSurface, PlacedTree, StarBoxes, StarPairs};
use crate::constants::REST_SHARE;
use crate::contact::cloth_contact::has_triangles;
use crate::contact::surface::pair::Pair;
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::contact::surface::rows::{CORNERS, PlaceStars, Row};
use crate::geometry::nearest_triangle::weighted;
use crate::simd::columns::LANES;
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::surface::{EDGES, NONE, Star};
use crate::state::topology::Topology;

/// The surfaces of an island.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlacedSurfaces {
    bodies: Vec<PlacedBody>,
    /// The stars of all bodies, with the numbers of their particles in the island.
    pub stars: Vec<Star>,
    pub rows: Vec<Row>,
    /// The body of each star.
    body: Vec<u32>,
    /// Places of all particles at rest, by number; and the greatest distance of each star's corners from its centre.
    rest: Vec<Vec3>,
    sizes: Vec<f32>,
    /// Sharpness of each star's edges, from 0 for a flat one to 1.
    sharpness: Vec<[f32; EDGES]>,
    leaf_pairs: Vec<[u32; 2]>,
    /// How far each star is from where its pairs expect it.
    offs: Vec<Off>,
}

/// The surface of one body.
#[derive(Clone, Debug, Default)]
struct PlacedBody {
    topology: Weak<Topology>,
    /// Its index in the island, and its first particle and leaf there.
    place: usize,
    first: u32,
    first_leaf: u32,
    tree: PlacedTree,
}

/// How far a star's corners are from where its pairs expect them, in metres.
#[derive(Clone, Copy, Debug, Default)]
struct Off {
    /// From where its row expects them.
    deviation: f32,
    /// The deviations when its row was written anew without its pairs.
    drift: f32,
    /// True if its pairs are looked for.
    is_stale: bool,
}

/// Cosines between the normals of two faces from which on the edge between them counts as flat, and as sharp: 15 and 45
/// degrees.
const FLAT: f32 = 0.966;
const SHARP: f32 = 0.707;

impl PlacedSurfaces {
    /// Fits everything to these bodies.
    pub fn fit(&mut self, bodies: &[Body], points: &Points) {
        let on = || bodies.iter().enumerate().filter(|(_, body)| has_triangles(body));
        let is_known = |known: &PlacedBody, (place, body): (usize, &Body)| {
            known.place == place
                && known.first == points.first[place]
                && core::ptr::eq(known.topology.as_ptr(), Arc::as_ptr(&body.topology))
        };
        if on().count() == self.bodies.len()
            && self.bodies.iter().zip(on()).all(|(known, body)| is_known(known, body))
        {
            return;
        }
        let Self { bodies: known, stars, rest, sizes, rows, body: of, sharpness, .. } = self;
        known.resize_with(on().count(), PlacedBody::default);
        stars.clear();
        of.clear();
        rest.clear();
        rest.resize(points.start.len(), Vec3::ZERO);
        for (known, (place, body)) in known.iter_mut().zip(on()) {
            let topology = &body.topology;
            let first = points.first[place];
            known.topology = Arc::downgrade(topology);
            (known.place, known.first, known.first_leaf) = (place, first, (stars.len() / LANES) as u32);
            for (index, slot) in topology.layout.slots().enumerate() {
                rest[first as usize + slot] = topology.rest.get(index).copied().unwrap_or_default();
            }
            let surface = topology.surface();
            stars.extend(surface.stars.iter().map(|star| star.map(|slot| slot + first)));
            of.resize(stars.len(), place as u32);
            let leaves = surface.stars.len() / LANES;
            known.tree.stars.resize(leaves, StarBoxes::NOTHING);
            known.tree.active.resize(leaves, u16::MAX);
        }
        sizes.clear();
        sizes.extend(stars.iter().map(|star| {
            let centre = rest[star.centre as usize];
            let ways = (1..CORNERS).map(|corner| rest[star.corner(corner) as usize].distance_squared(centre));
            ways.fold(0.0, f32::max).sqrt()
        }));
        rows.resize(stars.len(), Row::NOTHING);
        sharpness.resize(stars.len(), [0.0; EDGES]);
    }

    /// Shortens the distance of a pair that is near at rest: parts of one body keep [`REST_SHARE`] of their distance there at
    /// most, so that sticks which are a little shorter do not work against contacts.
    pub fn note_rest(&self, pair: &mut Pair) {
        pair.knows_rest = true;
        let stars = pair.stars.map(|star| star as usize);
        if self.body[stars[0]] != self.body[stars[1]] {
            return;
        }
        let [a, b] = stars.map(|star| self.rest[self.stars[star].centre as usize]);
        let reach = pair.distance / REST_SHARE + stars.iter().map(|&star| self.sizes[star]).sum::<f32>();
        if a.distance_squared(b) < reach * reach {
            let corners = pair.ids.map(|id| self.rest[id as usize]);
            let at_rest = weighted(pair.kind.nearest(corners), corners).length();
            pair.distance = pair.distance.min(REST_SHARE * at_rest);
        }
    }

    /// Works out how sharp edges are, from where their faces are when a step begins.
    pub fn sharpen(&mut self, points: &Points) {
        for (star, sharpness) in self.stars.iter().zip(&mut self.sharpness) {
            for (k, sharpness) in sharpness.iter_mut().enumerate() {
                let [third, fourth] = star.sides[k];
                if third == NONE || fourth == NONE {
                    *sharpness = 1.0;
                    continue;
                }
                let [a, b, c, d] = points.starts([star.centre, star.ends[k], third, fourth]);
                let (m, n) = ((b - a).cross(c - a), (d - a).cross(b - a));
                let scale = (m.length_squared() * n.length_squared()).sqrt();
                let cosine = if scale > 0.0 { m.dot(n) / scale } else { 0.0 };
                *sharpness = ((FLAT - cosine) / (FLAT - SHARP)).clamp(0.0, 1.0);
            }
        }
    }

    /// Chooses the stars whose pairs are looked for: those with a corner that is more than `slack` metres from where the rows
    /// expect it, at this `fraction` of the way. True if there is one.
    pub fn find_stale(&mut self, points: &Points, fraction: f32, slack: f32) -> bool {
        let Self { bodies, stars, rows, offs, .. } = self;
        let mut is_any = false;
        for ((star, row), off) in stars.iter().zip(rows).zip(&mut *offs) {
            off.deviation = greatest_deviation(star, row, points, fraction);
            off.is_stale = off.drift + off.deviation > slack;
            is_any |= off.is_stale;
        }
        if is_any {
            for body in bodies {
                let first = body.first_leaf as usize * LANES;
                let leaves = offs[first..].chunks_exact(LANES);
                for (active, offs) in body.tree.active.iter_mut().zip(leaves) {
                    *active = (0..LANES).fold(0, |mask, k| mask | (u16::from(offs[k].is_stale) << k));
                }
            }
        }
        is_any
    }

    /// True if the pairs of one of these stars are looked for.
    pub fn is_looked_at(&self, stars: [u32; 2]) -> bool {
        stars.iter().any(|&star| self.offs[star as usize].is_stale)
    }

    /// Looks for the pairs of all stars.
    pub fn look_at_all(&mut self) {
        self.offs.clear();
        self.offs.resize(self.stars.len(), Off { is_stale: true, ..Off::default() });
        self.bodies.iter_mut().for_each(|body| body.tree.active.fill(u16::MAX));
    }

    /// Places the stars, for ways from the points' starts to `targets`. Boxes are wider by their share of the reach.
    pub fn place(&mut self, bodies: &[Body], points: &Points, targets: &[Vec4], reach: Reach, isa: Isa) {
        let Self { bodies: placed, stars, rows, sharpness, offs, .. } = self;
        for body in placed {
            let first = body.first_leaf as usize * LANES;
            let own = first..first + body.tree.stars.len() * LANES;
            let of = &bodies[body.place];
            let (surface, thickness) = (of.topology.surface(), of.settings.thickness);
            body.tree.leans.clear();
            body.tree.leans.resize(of.particles.inverse_mass.len(), Lean::NOTHING);
            isa.run(PlaceStars {
                stars: &stars[own.clone()],
                first: body.first,
                sharpness: &sharpness[own.clone()],
                places: [&points.start, targets],
                thickness,
                reach,
                has_faces: !of.topology.faces.is_empty(),
                rows: &mut rows[own],
                tree: &mut body.tree,
            });
            body.tree.refit(surface);
        }
        // Pairs that are not looked for stay as they were listed.
        for off in offs {
            off.drift = if off.is_stale { 0.0 } else { off.drift + off.deviation };
        }
    }

    /// Finds the pairs of stars that may touch, where one is looked at.
    pub fn star_pairs(&mut self, bodies: &[Body], isa: Isa, found: &mut StarPairs) {
        found.clear();
        let Self { bodies: placed, leaf_pairs, .. } = self;
        for a in 0..placed.len() {
            leaf_pairs.clear();
            placed[a].surface(bodies).own_pairs(leaf_pairs);
            if !leaf_pairs.is_empty() {
                let body = &mut placed[a];
                body.tree.find_flat(bodies[body.place].topology.surface());
                let own = placed[a].surface(bodies);
                own.star_pairs(&own, leaf_pairs, isa, found);
            }
            let layers = bodies[placed[a].place].layers;
            for b in a + 1..placed.len() {
                if layers.interact(bodies[placed[b].place].layers) {
                    leaf_pairs.clear();
                    let [own, other] = [a, b].map(|body| placed[body].surface(bodies));
                    own.pairs_with(&other, leaf_pairs);
                    own.star_pairs(&other, leaf_pairs, isa, found);
                }
            }
        }
    }
}

/// Greatest distance in metres of a star's corners from where its row expects them.
fn greatest_deviation(star: &Star, row: &Row, points: &Points, fraction: f32) -> f32 {
    let mut most = 0.0_f32;
    for corner in 0..CORNERS {
        let [start, end] = row.places(corner);
        let expected = start + (end - start) * fraction;
        most = most.max(points.end[star.corner(corner) as usize].truncate().distance_squared(expected));
    }
    most.sqrt()
}

impl PlacedBody {
    fn surface<'a>(&'a self, bodies: &'a [Body]) -> PlacedSurface<'a> {
        let surface = bodies[self.place].topology.surface();
        PlacedSurface { surface, at: &self.tree, first_leaf: self.first_leaf }
    }
}
