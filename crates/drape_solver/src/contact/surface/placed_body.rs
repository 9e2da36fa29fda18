//! The surface of one body, placed in space, and what is kept for each of its stars.
//!
//! Design: `docs/design/self_contact.md`.

use core::ops::Range;
use std::sync::Weak;

use glam::Vec4;

use crate::broad_phase::surface_pairs::{Lean, PlacedSurface, PlacedTree};
use crate::constants::LEAST_SHARED_STARS;
use crate::contact::surface::rows::{FlyingStars, Row};
use crate::parallel::for_each::balanced_cut;
use crate::parallel::workers::Workers;
use crate::simd::columns::LANES;
use crate::simd::lanes::set_lanes;
use crate::state::body::Body;
use crate::state::star::{EDGES, Star};
use crate::state::surface::Surface;
use crate::state::topology::Topology;

/// Angle in radians by which faces may turn before a patch that lay flat counts as bent: with that of
/// [`LEAST_FLAT_COSINE`](crate::constants::LEAST_FLAT_COSINE), a right angle.
pub(crate) const MOST_TURN: f32 = 0.4;

/// The surface of one body.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlacedBody {
    pub topology: Weak<Topology>,
    /// Its index in the island, and its first particle and leaf there.
    pub place: usize,
    pub first: u32,
    pub first_leaf: u32,
    pub tree: PlacedTree,
}

/// The part of a star's motion that its pairs do not expect.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Off {
    /// Greatest distance of its corners from where its row expects them, in metres; and a bound of the angle by which its
    /// faces have turned, in radians.
    pub way: f32,
    pub turn: f32,
    /// The same, when its pairs were last left as they were listed.
    pub way_before: f32,
    /// Turning of its faces until then, since flat patches were left out.
    pub turn_before: f32,
    /// True if its pairs are looked for.
    pub is_stale: bool,
}

impl PlacedBody {
    /// Its stars among those of the island.
    pub fn stars(&self) -> Range<usize> {
        let Range { start, end } = self.leaves();
        start * LANES..end * LANES
    }

    /// The same with where they are at both ends of their ways, out of the `stars` of the island and their `sharpness`.
    pub fn flying<'a>(
        &self,
        places: [&'a [Vec4]; 2],
        thickness: f32,
        stars: &'a [Star],
        sharpness: &'a [[f32; EDGES]],
    ) -> FlyingStars<'a> {
        let own = self.stars();
        let (stars, sharpness) = (&stars[own.clone()], &sharpness[own]);
        FlyingStars { stars, first: self.first, sharpness, places, thickness }
    }

    /// Its leaves among those of the island.
    pub fn leaves(&self) -> Range<usize> {
        let first = self.first_leaf as usize;
        first..first + self.tree.stars.len()
    }

    pub fn interacts(&self, other: &Self, bodies: &[Body]) -> bool {
        bodies[self.place].layers.interact(bodies[other.place].layers)
    }

    pub fn surface<'a>(&'a self, bodies: &'a [Body]) -> PlacedSurface<'a> {
        let surface = bodies[self.place].topology.surface();
        PlacedSurface { surface, at: &self.tree, first_leaf: self.first_leaf }
    }
}

/// The columns of the stars of some bodies that follow each other.
pub(crate) struct StarColumns<'a> {
    pub heights: &'a mut [f32],
    pub offs: &'a mut [Off],
    pub rows: &'a mut [Row],
}

impl StarColumns<'_> {
    /// Those of the first `count` stars, and those of the others.
    pub fn split_at(&mut self, count: usize) -> [StarColumns<'_>; 2] {
        let (heights, offs, rows) =
            (self.heights.split_at_mut(count), self.offs.split_at_mut(count), self.rows.split_at_mut(count));
        [
            StarColumns { heights: heights.0, offs: offs.0, rows: rows.0 },
            StarColumns { heights: heights.1, offs: offs.1, rows: rows.1 },
        ]
    }
}

/// Does `work` on each body and the columns of its stars, on several threads if there are enough stars.
pub(crate) fn for_each_body(
    bodies: &mut [PlacedBody],
    columns: &mut StarColumns,
    workers: &Workers,
    work: &(dyn Fn(&mut PlacedBody, StarColumns) + Sync),
) {
    let stars = |body: &PlacedBody| body.stars().len();
    let Some(cut) = balanced_cut(bodies.iter().map(stars), LEAST_SHARED_STARS, workers) else {
        let mut first = 0;
        for body in bodies {
            let [_, mut left] = columns.split_at(first);
            let [own, _] = left.split_at(stars(body));
            first += stars(body);
            work(body, own);
        }
        return;
    };
    let (before, after) = bodies.split_at_mut(cut);
    let [mut own, mut others] = columns.split_at(before.iter().map(stars).sum());
    workers.join(&mut || for_each_body(before, &mut own, workers, work), &mut || {
        for_each_body(after, &mut others, workers, work);
    });
}

impl PlacedTree {
    /// Begins new leans of this many slots.
    pub fn begin_leans(&mut self, slots: usize) {
        core::mem::swap(&mut self.leans, &mut self.leans_before);
        self.leans.clear();
        self.leans.resize(slots, Lean::NOTHING);
        // Without a list before, nothing has turned.
        self.leans_before.resize(slots, Lean::EVERY_WAY);
    }

    /// Adds the stars around what turns to the stale ones, and notes all of these. That what has gone and what is expected
    /// now have turned since the pairs were looked for shows in the leans: whether a patch is flat depends on nothing else.
    pub fn choose_active(&mut self, surface: &Surface, offs: &mut [Off]) {
        for (place, star) in surface.stars.iter().enumerate() {
            let slot = star.centre as usize;
            let turned = offs[place].turn_before + self.leans[slot].turned_out_of(&self.leans_before[slot]);
            // Pairs of other stars rest on this one's faces, so it forgets its turn only if these are looked for, too.
            let is_far = turned > MOST_TURN;
            offs[place].turn_before = if is_far { 0.0 } else { turned };
            if is_far {
                for &(leaf, mask) in surface.near_star(place) {
                    set_lanes(mask).for_each(|lane| offs[leaf as usize * LANES + lane].is_stale = true);
                }
            }
        }
        for (active, offs) in self.active.iter_mut().zip(offs.chunks_exact(LANES)) {
            *active = (0..LANES).fold(0, |mask, k| mask | (u16::from(offs[k].is_stale) << k));
        }
    }
}
