//! Chains for the tests of direct solves.

use fearless_simd::Simd;
use glam::Vec3;

use crate::build::cloth::ClothBuilder;
use crate::constraint::direct::bundle::{BundleScratch, grow};
use crate::constraint::direct::chain::{ChainScratch, Chains};
use crate::constraint::projection::Exact;
use crate::constraint::testing::dice;
use crate::simd::cell_columns::CellColumns;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::Kernel;
use crate::state::body::Body;
use crate::state::membrane::ElasticStick;
use crate::state::settings::BodySettings;

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

/// A crumpled cloth with particles 0.1 m apart, in the cells of its grid. Particle 0 and those in `pins` are pinned.
pub fn crumpled(columns: u32, rows: u32, pins: &[u32]) -> Body {
    let cloth = ClothBuilder::new(REST * (columns - 1) as f32, REST * (rows - 1) as f32, columns, rows);
    let cloth = pins.iter().fold(cloth.pin(0), |cloth, &pin| cloth.pin(pin));
    let mut body = cloth.build(BodySettings::default()).expect("valid");
    let mut dice = dice(5);
    for i in 0..body.particles.len() {
        let place = body.particles.position(i) + Vec3::new(dice(), dice(), dice()) * 0.02;
        body.particles.set_position(i, place);
    }
    body.particles.arrange(&body.topology.layout);
    body
}

/// Scratch of one thread for lines of `count` places, ghosts included.
pub fn room_for(count: usize) -> BundleScratch {
    let mut scratch = BundleScratch::default();
    scratch.chain.reserve(count);
    scratch.reserve_particles(count);
    grow(&mut scratch.bends, count);
    grow(&mut scratch.rest, count);
    scratch
}

pub fn lane_of<T>(count: usize, of: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(|i| of(1 + 2 * i)).collect()
}

/// The compliance of each stick in parts of that inside the cloth: from 1 to 3.
pub fn softness(count: usize) -> Vec<[f32; LANES]> {
    (0..count).map(|i| core::array::from_fn(|lane| ((i + lane) % 3 + 1) as f32)).collect()
}
