//! Statistics of a body's particles: bounds, speeds, and whether all is finite; and of their masses.
//!
//! `motion/particle_stats.rs` gathers them in one pass.

use glam::Vec3;

use crate::simd::columns::LANES;
use crate::state::layout::Layout;

/// What a look at all particles shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParticleStats {
    /// Corners of the box around them, relative to the body's origin.
    pub low: Vec3,
    pub high: Vec3,
    /// Whether every position and displacement is finite.
    pub is_finite: bool,
    /// Length of the longest displacement, in metres.
    pub greatest_displacement: f32,
    /// Mean of the squared displacements of free particles, in square metres.
    pub mean_square_displacement: f32,
}

/// What a look at the masses shows. It is kept until a mass is changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MassStats {
    is_known: bool,
    /// For each cell the inverse mass that all its particles have in common; 0 if they differ, or one is pinned.
    pub common: Vec<f32>,
    /// Number of free particles, and their mass in kilograms.
    pub free_count: usize,
    pub free_mass: f64,
    /// Whether any particle is pinned.
    pub has_pins: bool,
}

impl MassStats {
    /// Drops what is known: a mass has changed.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// Looks at the masses, if any has changed.
    pub fn update(&mut self, inverse_mass: &[f32], layout: &Layout) {
        if self.is_known {
            return;
        }
        *self = Self { is_known: true, common: core::mem::take(&mut self.common), ..Self::default() };
        self.common.clear();
        let (cells, _) = inverse_mass.as_chunks::<LANES>();
        for (index, cell) in cells.iter().enumerate() {
            let real = layout.real_lanes(index);
            let mut masses = (0..LANES).filter(|lane| real & (1 << lane) != 0).map(|lane| cell[lane]);
            let first = masses.clone().next().unwrap_or(0.0);
            self.common.push(if masses.all(|w| w == first) { first } else { 0.0 });
        }
        for w in layout.slots().map(|slot| inverse_mass[slot]) {
            if w > 0.0 {
                self.free_count += 1;
                self.free_mass += 1.0 / f64::from(w);
            } else {
                self.has_pins = true;
            }
        }
    }
}
