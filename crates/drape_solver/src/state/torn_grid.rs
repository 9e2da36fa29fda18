//! A torn grid: some of its places are empty, and some particles have none.
//!
//! ```text
//!   before     after: particle 1 is split, and a row of the cloth has come off
//!   0--1--2    0--1  9--2
//!   |  |  |    |  |  |  |      9 is a copy of 1, whose place is taken: it is kept behind the grid
//!   3--4--5    3--4-----5
//!   |  |  |                    the places of 6, 7 and 8 are empty
//!   6--7--8
//! ```
//!
//! Design: `docs/design/tears_and_cuts.md`.

use crate::simd::columns::LANES;
use crate::state::layout::Grid;

/// The map from the particles of a torn grid to slots, and back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TornGrid {
    pub grid: Grid,
    /// Home of each particle: the slot of the grid that it has, or that its original has if it was split off.
    homes: Box<[u32]>,
    slots: Box<[u32]>,
    /// Particle of each slot; [`NO_PARTICLE`] in ghosts and empty places.
    indices: Box<[u32]>,
    /// Bit mask, for each cell, of the lanes that hold a particle.
    lanes: Box<[u16]>,
}

/// Marks a slot without a particle.
const NO_PARTICLE: u32 = u32::MAX;

impl TornGrid {
    /// A torn grid of particles with these homes. Of several with the same home, the first occupies it.
    pub fn new(grid: Grid, homes: Vec<u32>) -> Self {
        let whole = grid.width * grid.height * LANES;
        let mut indices = vec![NO_PARTICLE; whole];
        let mut slots = Vec::with_capacity(homes.len());
        for (index, &home) in homes.iter().enumerate() {
            let slot = if indices[home as usize] == NO_PARTICLE { home as usize } else { indices.len() };
            if slot == indices.len() {
                indices.push(NO_PARTICLE);
            }
            indices[slot] = index as u32;
            slots.push(slot as u32);
        }
        indices.resize(indices.len().next_multiple_of(LANES), NO_PARTICLE);
        let lanes_of = |cell: &[u32; LANES]| {
            (0..LANES).filter(|&lane| cell[lane] != NO_PARTICLE).fold(0, |bits, lane| bits | (1 << lane))
        };
        let lanes = indices.as_chunks().0.iter().map(lanes_of).collect();
        Self { grid, homes: homes.into(), slots: slots.into(), indices: indices.into(), lanes }
    }

    /// The number of particles.
    pub fn count(&self) -> usize {
        self.slots.len()
    }

    /// The number of cells, those behind the grid included.
    pub fn cells(&self) -> usize {
        self.lanes.len()
    }

    /// The slot of particle `index`.
    #[inline]
    pub fn slot(&self, index: usize) -> usize {
        self.slots[index] as usize
    }

    /// The home of particle `index`: the slot that it has, or would have if it were not taken.
    pub fn home(&self, index: usize) -> u32 {
        self.homes[index]
    }

    /// True if both particles occupy their homes.
    pub fn are_home(&self, particles: [u32; 2]) -> bool {
        particles.iter().all(|&particle| self.slots[particle as usize] == self.homes[particle as usize])
    }

    /// The particle in `slot`; none in a ghost or an empty place.
    pub fn index(&self, slot: usize) -> Option<usize> {
        self.indices.get(slot).filter(|&&index| index != NO_PARTICLE).map(|&index| index as usize)
    }

    /// Bit mask of the lanes of `cell` that hold a particle, lane 0 in the lowest bit.
    pub fn lanes(&self, cell: usize) -> u16 {
        self.lanes[cell]
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        let numbers = [&self.homes, &self.slots, &self.indices];
        numbers.into_iter().map(|list| size_of_val(&**list)).sum::<usize>() + size_of_val(&*self.lanes)
    }
}
