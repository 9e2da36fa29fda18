//! Three columns of numbers, one vector per particle, in cells that fill a vector register each.
//!
//! Design: `docs/design/kernels.md`.

use glam::Vec3;

/// The number of particles in a cell: the widest vector register in use holds so many floats. Narrower registers take a
/// cell in parts, with the same result.
pub(crate) const LANES: usize = 16;

/// The vectors of [`LANES`] particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Cell {
    pub x: [f32; LANES],
    pub y: [f32; LANES],
    pub z: [f32; LANES],
}

impl Cell {
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    pub fn set(&mut self, lane: usize, v: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }

    pub fn add(&mut self, lane: usize, v: Vec3) {
        self.set(lane, self.get(lane) + v);
    }

    pub fn minus(&self, other: &Self) -> Self {
        let axes =
            |own: &[f32; LANES], other: &[f32; LANES]| core::array::from_fn(|lane| own[lane] - other[lane]);
        Self { x: axes(&self.x, &other.x), y: axes(&self.y, &other.y), z: axes(&self.z, &other.z) }
    }

    pub fn axes(&self) -> [&[f32; LANES]; 3] {
        [&self.x, &self.y, &self.z]
    }

    pub fn axes_mut(&mut self) -> [&mut [f32; LANES]; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }
}

/// One vector for each slot of a body's layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Columns {
    pub cells: Vec<Cell>,
}

impl Columns {
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    #[inline]
    pub fn get(&self, slot: usize) -> Vec3 {
        self.cells[slot / LANES].get(slot % LANES)
    }

    #[inline]
    pub fn set(&mut self, slot: usize, v: Vec3) {
        self.cells[slot / LANES].set(slot % LANES, v);
    }

    #[inline]
    pub fn add(&mut self, slot: usize, v: Vec3) {
        let cell = &mut self.cells[slot / LANES];
        cell.set(slot % LANES, cell.get(slot % LANES) + v);
    }

    pub fn clear(&mut self) {
        self.cells.clear();
    }

    /// Makes room for `cells` cells of zero vectors, reusing what is allocated.
    pub fn reset(&mut self, cells: usize) {
        self.cells.clear();
        self.cells.resize(cells, Cell::default());
    }
}
