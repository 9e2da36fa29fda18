//! The surfaces of an island, placed in space: their stars in rows and boxes.
//!
//! Design: `docs/design/self_contact.md`.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use crate::broad_phase::surface_pairs::{StarBoxes, StarPairSearch, StarPairs};
use crate::constants::{BLUNT_EDGES, REST_SHARE};
use crate::contact::surface::leaves::{FlyingLeaves, Turning};
use crate::contact::surface::pair::Pair;
use crate::contact::surface::placed_body::{MOST_TURN, Off, PlacedBody, StarColumns, for_each_body};
use crate::contact::surface::points::Points;
use crate::contact::surface::reach::Reach;
use crate::contact::surface::rows::{PlaceBoxes, PlaceRows, Row};
use crate::geometry::nearest_triangle::weighted;
use crate::parallel::workers::Workers;
use crate::simd::columns::LANES;
use crate::simd::isa::Isa;
use crate::state::body::Body;
use crate::state::star::{CORNERS, EDGES, NONE, Star};

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
    /// True for each leaf of the island with a star of which a pair was found.
    is_paired: Vec<bool>,
    /// The least height of each star's faces at both ends of the way, or the length of its links, in metres.
    heights: Vec<f32>,
    /// Distance of each point from its expected place in metres, and how far each star has left its way.
    deviations: Vec<f32>,
    offs: Vec<Off>,
}

/// The way that a list expects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way<'a> {
    /// Places of all points when it was made, and at the end of the last substep for which it holds.
    pub starts: &'a [Vec4],
    pub targets: &'a [Vec4],
    /// The part of the way that has passed.
    pub fraction: f32,
}

impl Way<'_> {
    /// The expected place of this point.
    pub fn expected(&self, point: u32) -> Vec3 {
        let (start, target) = (self.starts[point as usize], self.targets[point as usize]);
        (start + (target - start) * self.fraction).truncate()
    }
}

/// Height in metres below which a face has no direction.
const LEAST_HEIGHT: f32 = 1e-6;

/// Cosines between the normals of two faces from which on the edge between them counts as flat, and as sharp: 15 and 45
/// degrees.
const FLAT: f32 = 0.966;
const SHARP: f32 = 0.707;

impl PlacedSurfaces {
    /// Fits everything to these bodies.
    pub fn fit(&mut self, bodies: &[Body], points: &Points) {
        let on = || bodies.iter().enumerate().filter(|(_, body)| body.has_self_contact());
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
        let Self { bodies: known, stars, rest, sizes, heights, rows, body: of, sharpness, .. } = self;
        known.resize_with(on().count(), PlacedBody::default);
        stars.clear();
        of.clear();
        rest.clear();
        rest.resize(points.len(), Vec3::ZERO);
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
        heights.resize(stars.len(), f32::INFINITY);
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

    /// Chooses the stars whose pairs are looked for: those with a corner that is more than `slack` metres off the way. True if
    /// there is one, or if a face has turned, so that a patch may lie flat no longer.
    pub fn find_stale(&mut self, points: &Points, way: Way, slack: f32) -> bool {
        let Self { stars, heights, deviations, offs, .. } = self;
        deviations.clear();
        deviations
            .extend(points.end.iter().zip(0..).map(|(end, id)| end.truncate().distance(way.expected(id))));
        let mut is_any = false;
        for ((star, off), &height) in stars.iter().zip(&mut *offs).zip(&*heights) {
            off.way = (0..CORNERS).fold(0.0, |most, k| deviations[star.corner(k) as usize].max(most));
            // Two corners that move to both sides turn a face by twice their way over its height.
            off.turn = 2.0 * off.way / height.max(LEAST_HEIGHT);
            if off.turn_before + off.turn > MOST_TURN {
                off.turn = turn(star, points, way);
            }
            off.is_stale = off.way_before + off.way > slack;
            is_any |= off.is_stale || off.turn_before + off.turn > MOST_TURN;
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
        self.bodies.iter_mut().for_each(|body| body.tree.leans.clear());
    }

    /// Puts boxes around the stars, for ways from the points' starts to `targets`. They are wider by their share of the reach,
    /// and faces lean as at both ends and at a part of the way `between`. Where they lean so much farther than before that a patch
    /// may lie flat no longer, pairs are looked for as well.
    pub fn place_boxes(
        &mut self,
        bodies: &[Body],
        points: &Points,
        targets: &[Vec4],
        between: f32,
        reach: Reach,
        isa: Isa,
        workers: &Workers,
    ) {
        let (placed, mut columns, stars, sharpness) = self.columns();
        for_each_body(placed, &mut columns, workers, &|body, StarColumns { heights, offs, .. }| {
            let of = &bodies[body.place];
            let (surface, thickness) = (of.topology.surface(), of.settings.thickness);
            body.tree.growth = [BLUNT_EDGES, 1.0].map(|part| part * thickness * reach.factor + reach.slack);
            body.tree.begin_leans(of.particles.inverse_mass.len());
            isa.run(PlaceBoxes {
                stars: body.flying([&points.start, targets], thickness, stars, sharpness),
                reach,
                between,
                has_faces: !of.topology.faces.is_empty(),
                heights,
                tree: &mut body.tree,
            });
            body.tree.choose_active(surface, offs);
            body.tree.refit_from_stars(surface);
            // Pairs that are not looked for stay as they were listed.
            for off in offs {
                off.way_before = if off.is_stale { 0.0 } else { off.way_before + off.way };
            }
        });
    }

    /// Writes the rows of the stars in all leaves of which these pairs were [found](Self::star_pairs).
    pub fn place_rows(
        &mut self,
        bodies: &[Body],
        points: &Points,
        targets: &[Vec4],
        found: &StarPairs,
        isa: Isa,
        workers: &Workers,
    ) {
        self.note_paired(found);
        let is_paired = core::mem::take(&mut self.is_paired);
        let (placed, mut columns, stars, sharpness) = self.columns();
        for_each_body(placed, &mut columns, workers, &|body, StarColumns { rows, .. }| {
            let thickness = bodies[body.place].settings.thickness;
            isa.run(PlaceRows {
                stars: body.flying([&points.start, targets], thickness, stars, sharpness),
                is_needed: &is_paired[body.leaves()],
                rows,
            });
        });
        self.is_paired = is_paired;
    }

    /// Notes the leaves of these pairs.
    fn note_paired(&mut self, found: &StarPairs) {
        let Self { is_paired, stars, .. } = self;
        is_paired.clear();
        is_paired.resize(stars.len() / LANES, false);
        for star in [&found.corners, &found.edges, &found.crossings].into_iter().flatten().flatten() {
            is_paired[*star as usize / LANES] = true;
        }
    }

    /// The bodies with the columns of all stars that change, and the stars with their sharpness.
    fn columns(&mut self) -> (&mut [PlacedBody], StarColumns<'_>, &[Star], &[[f32; EDGES]]) {
        let Self { bodies, stars, sharpness, heights, offs, rows, .. } = self;
        (bodies, StarColumns { heights, offs, rows }, stars, sharpness)
    }

    /// Bounds on turns of faces if no parts can touch in some `substeps`, by the leaves as a whole: all go the ways that are watched.
    pub fn turning_if_apart(
        &mut self,
        bodies: &[Body],
        substeps: u32,
        reach: Reach,
        isa: Isa,
    ) -> Option<Turning> {
        let Self { bodies: placed, leaf_pairs, .. } = self;
        let mut turning = Turning::default();
        for body in &mut *placed {
            let Body { particles, topology, settings, context, .. } = &bodies[body.place];
            let flying = FlyingLeaves {
                leaves: &topology.surface().leaves,
                starts: &context.watch.starts,
                ways: &context.watch.ways,
                origin: particles.origin - bodies[0].particles.origin,
                substeps: substeps as f32,
                growth: settings.thickness * reach.factor + reach.slack,
                placed: &mut body.tree.leaves,
            };
            turning = turning.or_more(isa.run(flying));
            body.tree.active.fill(u16::MAX);
            body.tree.refit_from_leaves(topology.surface());
        }
        leaf_pairs.clear();
        for (a, body) in placed.iter().enumerate() {
            let own = body.surface(bodies);
            own.own_pairs(leaf_pairs);
            leaf_pairs.retain(|&leaves| !own.is_flat_pair(leaves));
            for other in placed[a + 1..].iter().filter(|other| body.interacts(other, bodies)) {
                own.pairs_with(&other.surface(bodies), leaf_pairs);
            }
            if !leaf_pairs.is_empty() {
                return None;
            }
        }
        Some(turning)
    }

    /// Finds the pairs of stars that may touch, where one is looked at.
    pub fn star_pairs(&mut self, bodies: &[Body], isa: Isa, workers: &Workers, search: &mut StarPairSearch) {
        let Self { bodies: placed, leaf_pairs, .. } = self;
        search.found.clear();
        for a in 0..placed.len() {
            leaf_pairs.clear();
            placed[a].surface(bodies).own_pairs(leaf_pairs);
            if !leaf_pairs.is_empty() {
                let body = &mut placed[a];
                body.tree.find_flat(bodies[body.place].topology.surface());
                let own = placed[a].surface(bodies);
                own.star_pairs(&own, leaf_pairs, isa, workers, search);
            }
            for b in a + 1..placed.len() {
                if !placed[a].interacts(&placed[b], bodies) {
                    continue;
                }
                leaf_pairs.clear();
                let [own, other] = [a, b].map(|body| placed[body].surface(bodies));
                own.pairs_with(&other, leaf_pairs);
                own.star_pairs(&other, leaf_pairs, isa, workers, search);
            }
        }
    }
}

/// Angle in radians by which a face or a link of a star has turned out of its expected direction, to within some percent.
fn turn(star: &Star, points: &Points, way: Way) -> f32 {
    let mut least = 1.0_f32;
    let mut add = |expected: Vec3, now: Vec3| {
        least = least.min(expected.normalize_or_zero().dot(now.normalize_or_zero()));
    };
    let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
    for k in 0..star.face_count as usize {
        add(normal(star.face(k).map(|point| way.expected(point))), normal(points.ends(star.face(k))));
    }
    if star.is_link() {
        let link = |[a, b]: [Vec3; 2]| b - a;
        for k in 0..star.edge_count as usize {
            add(link(star.edge(k).map(|point| way.expected(point))), link(points.ends(star.edge(k))));
        }
    }
    (2.0 * (1.0 - least)).sqrt()
}
