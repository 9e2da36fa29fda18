//! Workload W: a square sheet that falls on a sphere.

use clap::ValueEnum;
use drape_solver::glam::Vec3;
use serde::Serialize;

/// Which particles of the sheet are pinned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Pins {
    /// The two corners of one side.
    Corners,
    /// That whole side.
    Edge,
}

/// Side of the sheet in metres.
pub const SIDE: f32 = 2.0;
/// Mass of the sheet in kilograms.
pub const MASS: f32 = 1.0;
/// Gravity in m/s^2.
pub const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
/// Height at which potential energy counts as zero, in metres: no particle of a sheet at its rest length can hang
/// lower than its diagonal below the pins.
pub const LOWEST: f32 = -2.83;
/// Length of a step in seconds.
pub const STEP: f32 = 1.0 / 60.0;
/// Radius of the static sphere below the sheet, in metres.
pub const SPHERE_RADIUS: f32 = 0.5;
/// Centre of the sphere, in metres: 0.6 below the middle of the sheet.
pub const SPHERE_CENTRE: Vec3 = Vec3::new(0.0, -0.6, 0.0);
/// Steps of a run.
pub const STEPS: usize = 300;
/// Steps at the start that are not timed, and not counted as motion.
pub const WARM_UP: usize = 30;

/// `n` x `n` particles over 2 m x 2 m in the XZ plane.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// Particles in a row and in a column.
    pub n: u32,
    /// Which are pinned.
    pub pins: Pins,
}

/// A family of sticks: pairs of particle indices, in the order of rows.
pub type Family = Vec<[u32; 2]>;

impl Sheet {
    /// Number of particles.
    pub fn particle_count(&self) -> usize {
        self.n as usize * self.n as usize
    }

    /// Starting positions.
    pub fn positions(&self) -> Vec<Vec3> {
        let spacing = SIDE / (self.n - 1) as f32;
        let place = |i: u32| i as f32 * spacing - SIDE * 0.5;
        let rows = (0..self.n).flat_map(|row| (0..self.n).map(move |column| (column, row)));
        rows.map(|(column, row)| Vec3::new(place(column), 0.0, place(row))).collect()
    }

    /// Inverse masses, 0 for pins: every particle weighs the same.
    pub fn inverse_masses(&self) -> Vec<f32> {
        let mut inverse = vec![self.particle_count() as f32 / MASS; self.particle_count()];
        for pin in self.pinned() {
            inverse[pin as usize] = 0.0;
        }
        inverse
    }

    /// The pinned particles.
    pub fn pinned(&self) -> Vec<u32> {
        match self.pins {
            Pins::Corners => vec![0, self.n - 1],
            Pins::Edge => (0..self.n).collect(),
        }
    }

    /// Horizontals, verticals, the two diagonals, skip-one bends in rows and in columns:
    /// `2n(n-1) + 2(n-1)^2 + 2n(n-2)` sticks.
    pub fn families(&self) -> [Family; 6] {
        let n = self.n;
        [
            self.pairs([n - 1, n], [0, 0], [1, 0]),
            self.pairs([n, n - 1], [0, 0], [0, 1]),
            self.pairs([n - 1, n - 1], [0, 0], [1, 1]),
            self.pairs([n - 1, n - 1], [1, 0], [0, 1]),
            self.pairs([n - 2, n], [0, 0], [2, 0]),
            self.pairs([n, n - 2], [0, 0], [0, 2]),
        ]
    }

    fn pairs(&self, [columns, rows]: [u32; 2], from: [u32; 2], to: [u32; 2]) -> Family {
        let index = |[column, row]: [u32; 2]| row * self.n + column;
        let cells = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        cells.map(|[c, r]| [from, to].map(|[dc, dr]| index([c + dc, r + dr]))).collect()
    }
}

/// How far structural sticks are from their rest length: root mean square, 99th percentile and greatest, as
/// fractions.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct StretchFigures {
    /// Root of the mean square.
    pub rms: f64,
    /// 99th percentile.
    pub p99: f64,
    /// The greatest.
    pub max: f64,
}

impl StretchFigures {
    /// Of the sheet's structural sticks, with the particles at `positions`.
    pub fn of(structural: &[[u32; 2]], rest: f64, positions: &[Vec3]) -> Self {
        let strain = |&[a, b]: &[u32; 2]| {
            let (p, q) = (positions[a as usize].as_dvec3(), positions[b as usize].as_dvec3());
            (p.distance(q) / rest - 1.0).abs()
        };
        let mut strains: Vec<f64> = structural.iter().map(strain).collect();
        let rms = (strains.iter().map(|s| s * s).sum::<f64>() / strains.len() as f64).sqrt();
        strains.sort_unstable_by(f64::total_cmp);
        let p99 = strains[(strains.len() - 1) * 99 / 100];
        Self { rms, p99, max: strains[strains.len() - 1] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_has_the_sticks_that_the_formula_says() {
        for n in [3, 8, 17] {
            let families = Sheet { n, pins: Pins::Edge }.families();
            let count: usize = families.iter().map(Vec::len).sum();
            let n = n as usize;
            assert_eq!(count, 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2));
        }
    }
}
