//! One pass over all particles for their [statistics](crate::state::particle_stats), shared by the workers.
//!
//! Design: `docs/design/rest_and_islands.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::constants::LEAST_SHARED_CELLS;
use crate::parallel::workers::Workers;
use crate::simd::columns::{Cell, LANES};
use crate::simd::isa::{Isa, Kernel};
use crate::simd::lanes::{Lanes3, load};
use crate::state::particle_stats::ParticleStats;
use crate::state::particles::Particles;

impl Particles {
    /// True if every position, velocity, force and pin target is finite.
    pub fn is_finite(&self) -> bool {
        let forces = self.force.cells.iter().flat_map(Cell::axes);
        self.stats().is_finite
            && forces.flatten().all(|value| value.is_finite())
            && self.origin.is_finite()
            && self.pose.is_finite()
            && self.pin_targets.iter().all(|(_, target)| target.is_finite())
    }

    /// Greatest speed of a particle in m/s.
    pub fn greatest_speed(&self) -> f32 {
        self.stats().greatest_displacement / self.substep
    }

    /// The smallest box around all particles, as (least, greatest) corner in the world.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let ParticleStats { low, high, .. } = self.stats();
        (self.origin + low, self.origin + high)
    }

    /// Mean of the squared speeds of the free particles in (m/s)^2; 0 where all are pinned.
    pub fn mean_square_speed(&self) -> f32 {
        self.stats().mean_square_displacement / (self.substep * self.substep)
    }

    /// The statistics of all particles, gathered now unless they are known.
    pub(crate) fn stats(&self) -> ParticleStats {
        self.stats.unwrap_or_else(|| ParticleStats::of(self))
    }

    /// Gathers the statistics unless they are known, and keeps them.
    pub(crate) fn take_stats(&mut self) {
        self.stats = Some(self.stats());
    }

    /// Gathers the statistics again, with the help of the workers.
    pub(crate) fn renew_stats(&mut self, workers: &Workers) {
        self.stats = Some(ParticleStats::of_shared(self, workers));
    }
}

impl ParticleStats {
    pub fn of(particles: &Particles) -> Self {
        Self::of_shared(particles, &Workers::default())
    }

    /// The same with the help of the workers, to the last bit.
    pub fn of_shared(particles: &Particles, workers: &Workers) -> Self {
        let sums = Sums::of(particles, 0..particles.position.cells.len(), workers);
        Self {
            low: sums.low,
            high: sums.high,
            is_finite: sums.odd == 0.0,
            greatest_displacement: sums.greatest.max(0.0).sqrt(),
            mean_square_displacement: sums.squared / sums.count.max(1.0),
        }
    }
}

/// Sums over some cells.
struct Sums {
    low: Vec3,
    high: Vec3,
    /// Zero while every value is finite.
    odd: f32,
    /// Greatest and sum of the squared displacements, the latter of the `count` free particles.
    greatest: f32,
    squared: f32,
    count: f32,
}

impl Sums {
    /// Sums the halves of many cells one after the other, with helpers or without: the order of a sum decides its last
    /// bits.
    fn of(particles: &Particles, cells: Range<usize>, workers: &Workers) -> Self {
        if cells.len() <= LEAST_SHARED_CELLS {
            return Isa::detected().run(StatsPass { particles, cells });
        }
        let middle = cells.start.midpoint(cells.end);
        let (mut upper, mut lower) = (None, None);
        workers.join(&mut || upper = Some(Self::of(particles, cells.start..middle, workers)), &mut || {
            lower = Some(Self::of(particles, middle..cells.end, workers));
        });
        match (upper, lower) {
            (Some(upper), Some(lower)) => upper.and(lower),
            (either, other) => either.or(other).unwrap_or_else(|| Self::of(particles, cells, workers)),
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            odd: self.odd + other.odd,
            greatest: self.greatest.max(other.greatest),
            squared: self.squared + other.squared,
            count: self.count + other.count,
        }
    }
}

struct StatsPass<'a> {
    particles: &'a Particles,
    cells: Range<usize>,
}

impl Kernel for StatsPass<'_> {
    type Output = Sums;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Sums {
        let Self { particles, cells } = self;
        let Particles { position, displacement, inverse_mass, layout, .. } = particles;
        let (masses, _) = inverse_mass.as_chunks::<LANES>();
        let zero = f32x16::splat(simd, 0.0);
        let mut low = Lanes3::splat(simd, Vec3::splat(f32::INFINITY));
        let mut high = Lanes3::splat(simd, Vec3::splat(f32::NEG_INFINITY));
        // Zero while every value is finite.
        let mut odd = zero;
        let (mut greatest, mut sum, mut count) = (zero, zero, zero);
        for index in cells {
            let x = Lanes3::load(simd, &position.cells[index]);
            let d = Lanes3::load(simd, &displacement.cells[index]);
            let real = mask32x16::from_bitmask(simd, u64::from(layout.real_lanes(index)));
            let free = load(simd, &masses[index]).simd_gt(zero);
            low = Lanes3 {
                x: real.select(x.x.min(low.x), low.x),
                y: real.select(x.y.min(low.y), low.y),
                z: real.select(x.z.min(low.z), low.z),
            };
            high = Lanes3 {
                x: real.select(x.x.max(high.x), high.x),
                y: real.select(x.y.max(high.y), high.y),
                z: real.select(x.z.max(high.z), high.z),
            };
            // Lanes without a particle fall for ever, so they are masked out.
            let squared = real.select(d.dot(d), zero);
            odd += (real.select(x.x + x.y + x.z, zero) + squared) * zero;
            greatest = squared.max(greatest);
            sum += free.select(squared, zero);
            count += free.select(f32x16::splat(simd, 1.0), zero);
        }
        let least = |v: f32x16<S>| v.to_array().into_iter().fold(f32::INFINITY, f32::min);
        let most = |v: f32x16<S>| v.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        let total = |v: f32x16<S>| v.to_array().into_iter().sum::<f32>();
        Sums {
            low: Vec3::new(least(low.x), least(low.y), least(low.z)),
            high: Vec3::new(most(high.x), most(high.y), most(high.z)),
            odd: total(odd),
            greatest: most(greatest),
            squared: total(sum),
            count: total(count),
        }
    }
}
