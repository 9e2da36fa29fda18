//! Chains for the tests of direct solves.

use fearless_simd::Simd;
use glam::Vec3;

use crate::constraint::direct::chain::{ChainScratch, Chains};
use crate::constraint::projection::Exact;
use crate::constraint::testing::dice;
use crate::simd::cell_columns::CellColumns;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::state::membrane::ElasticStick;

pub const REST: f32 = 0.1;
pub const RIGID: ElasticStick = ElasticStick { rest: REST, compliance: 0.0 };
/// As soft as some of the particles are light.
pub const SOFT: ElasticStick = ElasticStick { rest: REST, compliance: 5.0 };
const EDGES: u16 = 0x8001;

/// A solve of the chains that `chains` makes.
pub struct Solve<'a> {
    pub position: &'a mut [Cell],
    pub inverse_mass: &'a [[f32; LANES]],
    pub count: usize,
    pub gaps: Option<&'a [u16]>,
    pub softness: Option<&'a [[f32; LANES]]>,
    pub stick: ElasticStick,
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { position, inverse_mass, count, gaps, softness, stick } = self;
        let mut scratch = ChainScratch::default();
        scratch.reserve(count);
        let mut columns = CellColumns::new(position, 2);
        let mut chains = Chains { position: columns.column(1), inverse_mass, count, gaps, softness };
        chains.solve(simd, &mut scratch, stick, EDGES, Exact);
    }
}

/// Sixteen crooked chains in every second cell of three, some of their particles pinned, heavy or in one place.
pub fn chains(count: usize, stretched: f32) -> (Vec<Cell>, Vec<[f32; LANES]>) {
    let mut dice = dice(1);
    let mut position = vec![Cell::default(); 2 * count + 1];
    let mut inverse_mass = vec![[1.0; LANES]; 2 * count + 1];
    let mut at = [Vec3::ZERO; LANES];
    for i in 0..count {
        let cell = 1 + 2 * i;
        for (lane, at) in at.iter_mut().enumerate() {
            let weight = 8.0 * (1.0 + dice());
            position[cell].set(lane, *at);
            inverse_mass[cell][lane] = if weight < 1.0 { 0.0 } else { weight };
            let turn = Vec3::new(dice(), dice(), dice()) * 0.6;
            let length = if i == 4 { 0.0 } else { REST * (1.0 + stretched * dice()) };
            *at += (Vec3::X + turn).normalize() * length;
        }
    }
    (position, inverse_mass)
}

/// The width of the sticks of a lane's chain, in parts of those inside the cloth.
pub fn width_share(lane: usize) -> f64 {
    if EDGES & (1 << lane) == 0 { 1.0 } else { 0.5 }
}

pub fn lane_of<T>(count: usize, of: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(|i| of(1 + 2 * i)).collect()
}

/// The compliance of each stick in parts of that inside the cloth: from 1 to 3.
pub fn softness(count: usize) -> Vec<[f32; LANES]> {
    (0..count).map(|i| core::array::from_fn(|lane| ((i + lane) % 3 + 1) as f32)).collect()
}
