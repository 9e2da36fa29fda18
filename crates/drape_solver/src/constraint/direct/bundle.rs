//! A bundle of sixteen lines: its particles and sticks in the lanes, and its solve.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::Simd;

use crate::constraint::direct::bent_chain::ChainBend;
use crate::constraint::direct::chain::{ChainScratch, Chains};
use crate::constraint::direct::grid_lines::{Lines, RuledGrid, Solved};
use crate::constraint::direct::line_storage::Bundling;
use crate::constraint::projection::Projection;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Isa;
use crate::state::settings::StickProjection;

/// Scratch of one thread for one bundle of lines.
#[derive(Clone, Debug, Default)]
pub(super) struct BundleScratch {
    pub chain: ChainScratch,
    pub bends: Vec<ChainBend>,
    /// The particles of sixteen lines that were brought into the lanes.
    pub position: Vec<Cell>,
    pub inverse_mass: Vec<[f32; LANES]>,
    /// Their weighted sums at rest.
    pub rest: Vec<Cell>,
}

impl BundleScratch {
    /// Makes room for lines that are brought into the lanes.
    pub fn reserve_particles(&mut self, count: usize) {
        grow(&mut self.position, count);
        grow(&mut self.inverse_mass, count);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let Self { chain, bends, position, inverse_mass, rest } = self;
        let cells = size_of_val(&**position) + size_of_val(&**inverse_mass) + size_of_val(&**rest);
        chain.bytes() + size_of_val(&**bends) + cells
    }
}

/// Makes room for `count` values.
pub(super) fn grow<T: Clone + Default>(values: &mut Vec<T>, count: usize) {
    values.resize(count.max(values.len()), T::default());
}

/// Gaps and softness of lines, by bundle and place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TornBundles<'a> {
    /// The lanes without a stick to the next place, lane 0 in the lowest bit; none if all have theirs.
    pub gaps: Option<&'a [u16]>,
    /// The compliance of these sticks, in parts of that inside the cloth; none if they are not springs.
    pub softness: Option<&'a [[f32; LANES]]>,
}

impl<'a> TornBundles<'a> {
    /// Those of bundle `bundle`, whose lines have `count` places.
    pub fn of_bundle(self, bundle: usize, count: usize) -> (Option<&'a [u16]>, Option<&'a [[f32; LANES]]>) {
        let own = bundle * count..(bundle + 1) * count;
        (self.gaps.map(|gaps| &gaps[own.clone()]), self.softness.map(|softness| &softness[own]))
    }
}

/// The solve of the lines of one direction, in bundles.
#[derive(Clone, Copy)]
pub(super) struct BundleSolve<'a> {
    pub grid: RuledGrid,
    pub inverse_mass: &'a [[f32; LANES]],
    /// Weighted sums of bends at rest, by the middle particle; none where they are zero.
    pub rest: Option<&'a [Cell]>,
    pub torn: TornBundles<'a>,
    pub lines: Lines,
    pub bundling: Bundling,
    pub solved: Solved,
    pub projection: StickProjection,
    pub isa: Isa,
}

/// Solves chains whose sticks or bends resist alike, but for those of lanes at an edge of the cloth and softer ones. Bends may have a rest.
#[inline(always)]
pub(super) fn solve_chains<S: Simd>(
    simd: S,
    mut chains: Chains,
    (chain, bends): (&mut ChainScratch, &mut [ChainBend]),
    (solved, rest): (Solved, Option<&[Cell]>),
    is_edge: impl Fn(usize) -> bool,
    projection: impl Projection,
) {
    // In torn cloth the softness covers edges, too.
    let is_soft = |lane| chains.softness.is_none() && is_edge(lane);
    let edges = (0..LANES).fold(0, |bits, lane| bits | (u16::from(is_soft(lane)) << lane));
    match solved {
        Solved::Sticks(stick) => chains.solve(simd, chain, stick, edges, projection),
        Solved::Bends(compliance) => chains.bend(simd, bends, compliance, edges, rest),
    }
}
