//! Statistics of a body's particles: bounds, speeds, finiteness, and masses.
//!
//! `motion/particle_stats.rs` gathers them in one pass.
//!
//! Design: `docs/design/rest_and_islands.md`.

use glam::Vec3;

use crate::simd::columns::LANES;
use crate::state::layout::Layout;

/// Statistics of all particles of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParticleStats {
    /// Corners of the box around them, relative to the body's origin.
    pub low: Vec3,
    pub high: Vec3,
    /// True if every position and displacement is finite.
    pub is_finite: bool,
    /// Length of the longest displacement, in metres.
    pub greatest_displacement: f32,
    /// Mean of the squared displacements of free particles, in square metres.
    pub mean_square_displacement: f32,
}

/// Statistics of the masses, kept until a mass changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MassStats {
    is_known: bool,
    /// For each cell the inverse mass that all its particles have in common; 0 if they differ, or one is pinned.
    pub common: Vec<f32>,
    /// The number of free particles, and their mass in kilograms.
    pub free_count: usize,
    pub free_mass: f64,
    /// True if any particle is pinned.
    pub has_pins: bool,
}

impl MassStats {
    /// Invalidates the statistics after a change of a mass.
    pub fn forget(&mut self) {
        self.is_known = false;
    }

    /// Gathers the statistics again if a mass has changed.
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
