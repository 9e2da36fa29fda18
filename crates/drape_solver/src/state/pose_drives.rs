//! Drives towards the animated pose as data: a damped spring from each particle to its animated place.
//!
//! `motion/pose_drive.rs` moves the particles.
//!
//! Design: `docs/design/characters.md`.

use glam::Vec3;

use crate::constants::{MAX_DAMPING_RATIO, MAX_DRIVE_FREQUENCY};
use crate::error::{BuildError, in_range};
use crate::simd::columns::LANES;
use crate::state::animated_columns::AnimatedColumns;

/// The angle in radians by which a drive swings in one substep at most. Drives without damping grow at half a turn.
const MOST_SWING: f64 = 1.0;

/// A damped spring that draws a particle towards its animated place, whatever its mass: `x'' = -w^2 x - 2 z w x'`, with
/// `x` relative to that place.
///
/// Unreal's cloth has an animation drive, whose stiffness depends on the step; this one gives the same motion in steps
/// and substeps of any length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseDrive {
    /// Angular frequency `w` in rad/s, 0 to 10 000; 0 is no drive. Gravity makes a particle sag by `g / w^2`: 27 cm at 6,
    /// 2.5 cm at 20, 1 mm at 100.
    pub angular_frequency: f32,
    /// Damping ratio `z`, 0 to 1000: 0 swings for ever, 1 comes back as fast as can be without swinging over, more
    /// comes back slower.
    pub damping_ratio: f32,
}

impl Default for PoseDrive {
    /// No drive, damped critically.
    fn default() -> Self {
        Self { angular_frequency: 0.0, damping_ratio: 1.0 }
    }
}

impl PoseDrive {
    /// Checks both numbers.
    ///
    /// # Errors
    /// [`BuildError`] if one of them is NaN or out of range.
    pub fn validate(&self) -> Result<(), BuildError> {
        in_range("angular frequency of a pose drive", self.angular_frequency, 0.0, MAX_DRIVE_FREQUENCY)?;
        in_range("damping ratio of a pose drive", self.damping_ratio, 0.0, MAX_DAMPING_RATIO)?;
        Ok(())
    }

    /// Factors for a substep in seconds: those of the exact solution between equal steps,
    /// `x[n+1] - x[n] = decay (x[n] - x[n-1]) - pull x[n]`. A swing by more than a radian in a substep would come out
    /// anyhow, and is taken as one of a radian.
    fn factors(&self, substep: f32) -> [f64; 3] {
        let ratio = f64::from(self.damping_ratio);
        let angle = f64::from(self.angular_frequency) * f64::from(substep);
        let decay = libm::exp(-2.0 * ratio * angle);
        let pull = if ratio < 1.0 {
            let half = 0.5 * (angle * (1.0 - ratio * ratio).sqrt()).min(MOST_SWING);
            let (lost, sine) = (libm::expm1(-ratio * angle), libm::sin(half));
            lost * lost + 4.0 * libm::exp(-ratio * angle) * sine * sine
        } else {
            let fast = ratio + (ratio * ratio - 1.0).sqrt();
            libm::expm1(-angle * fast) * libm::expm1(-angle / fast)
        };
        [decay, pull, pull / (angle * angle)]
    }
}

/// Factors of all slots by which a drive acts in one substep.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct DriveFactors {
    /// The part of the displacement relative to the animated place that is kept.
    pub decay: Vec<f32>,
    /// The part of the distance to the animated place that is taken; 0 without a drive.
    pub pull: Vec<f32>,
    /// The part of the displacement by other accelerations that counts.
    pub gain: Vec<f32>,
    /// The substep that they are for, in seconds; 0 if a drive has changed since.
    substep: f32,
}

/// The drives of a body's particles, by slot; empty where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PoseDrives {
    /// Animated places, relative to the body's origin.
    pub place: AnimatedColumns,
    pub drives: Vec<PoseDrive>,
    pub factors: DriveFactors,
}

impl PoseDrives {
    pub fn is_empty(&self) -> bool {
        self.drives.is_empty()
    }

    /// True once factors have been prepared, if only for drives that have changed since.
    pub fn has_factors(&self) -> bool {
        !self.factors.pull.is_empty()
    }

    /// Makes room for the particles of `cells` cells, all without a drive.
    pub fn reset(&mut self, cells: usize) {
        self.place.reset(cells);
        self.drives.clear();
        self.drives.resize(cells * LANES, PoseDrive::default());
        self.factors.substep = 0.0;
    }

    pub fn set(&mut self, slot: usize, place: [Vec3; 2], drive: PoseDrive) {
        self.place.set(slot, place);
        self.drives[slot] = drive;
        self.factors.substep = 0.0;
    }

    pub fn get(&self, slot: usize) -> Option<PoseDrive> {
        self.drives.get(slot).copied().filter(|drive| drive.angular_frequency > 0.0)
    }

    /// Copies the drive of a slot of another body, if there is one.
    pub fn copy(&mut self, to: usize, others: &Self, from: usize) {
        if let Some(drive) = others.get(from) {
            self.set(to, others.place.get(from), drive);
        }
    }

    /// Prepares the factors for a substep in seconds.
    pub fn set_substep(&mut self, substep: f32) {
        let Self { drives, factors: DriveFactors { decay, pull, gain, substep: known }, .. } = self;
        if *known == substep {
            return;
        }
        *known = substep;
        for (numbers, none) in [(&mut *decay, 1.0), (&mut *pull, 0.0), (&mut *gain, 1.0)] {
            numbers.clear();
            numbers.resize(drives.len(), none);
        }
        let mut last = (PoseDrive::default(), [1.0, 0.0, 1.0]);
        for (slot, drive) in drives.iter().enumerate().filter(|(_, drive)| drive.angular_frequency > 0.0) {
            // Most neighbours are painted alike.
            if *drive != last.0 {
                last = (*drive, drive.factors(substep).map(|factor| factor as f32));
            }
            [decay[slot], pull[slot], gain[slot]] = last.1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factors keep each exact solution: they are checked against the roots of the oscillator.
    #[test]
    fn factors_are_those_of_the_exact_solution_below_at_and_above_critical_damping() {
        for (frequency, ratio) in
            [(6.0, 0.0), (6.0, 0.2), (40.0, 0.999), (40.0, 1.0), (40.0, 3.0), (0.01, 0.5)]
        {
            let (drive, h) = (PoseDrive { angular_frequency: frequency, damping_ratio: ratio }, 1.0 / 60.0);
            let [decay, pull, gain] = drive.factors(h);
            let (w, z, h) = (f64::from(frequency), f64::from(ratio), f64::from(h));
            let at = |t: f64| {
                let spread = w * (z * z - 1.0).abs().sqrt();
                let wave = if z < 1.0 { libm::cos(spread * t) } else { libm::cosh(spread * t) };
                libm::exp(-z * w * t) * wave
            };
            let [before, now, after] = [-h, 0.0, h].map(at);
            let expected = after - now;
            let found = decay * (now - before) - pull * now;
            assert!((found - expected).abs() < 1e-12, "{drive:?}: {found} instead of {expected}");
            assert!((gain - pull / (w * h * w * h)).abs() < 1e-12);
        }
        // However stiff, a substep brings the particle to its place and not beyond.
        let [decay, pull, _] =
            PoseDrive { angular_frequency: MAX_DRIVE_FREQUENCY, damping_ratio: 1.0 }.factors(1.0 / 60.0);
        assert!(decay < 1e-9 && (pull - 1.0).abs() < 1e-9);
    }
}
