//! The Verlet step with drag.
//!
//! Position Verlet `x' = x + (1 - c)(x - x*) + a dt^2; x* = x` (Liu 2019, section 1.2; with `c = 0.01` its
//! `1.99x - 0.99x*`), in displacement form. Some copies have `a dt^2 / 2` here: that halves gravity.
//!
//! Design: `docs/design/integration.md`.

use core::ops::Range;

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::simd::lanes::{Lanes3, load};
use crate::state::body::Body;
use crate::state::drag::Drag;

/// One substep of free flight for all particles of a body.
#[derive(Clone, Copy)]
pub(crate) struct Flight {
    pub drag: Drag,
    /// Seconds.
    pub substep: f32,
    /// The acceleration that all particles share, in m/s^2; some have others besides.
    pub uniform: Vec3,
}

impl Flight {
    /// Integrates the free particles of `cells`, at `places` in the moving columns. Pinned ones stay, as their pins
    /// have moved them already.
    #[inline(always)]
    pub fn integrate<S: Simd>(
        self,
        simd: S,
        moving: &mut MovingColumns,
        places: Range<usize>,
        rest: &BodyColumns,
        cells: Range<usize>,
    ) {
        let gain = self.drag.gain * self.substep * self.substep;
        let uniform = Lanes3::splat(simd, self.uniform * gain);
        let zero = f32x16::splat(simd, 0.0);
        let still = Lanes3 { x: zero, y: zero, z: zero };
        let decay = f32x16::splat(simd, self.drag.decay);
        for (place, cell) in places.zip(cells) {
            let position = Lanes3::load(simd, &moving.position[place]);
            let mut next = Lanes3::load(simd, &moving.displacement[place]).times(decay).plus(uniform);
            if let Some(varying) = rest.varying.get(cell) {
                next = next.plus(Lanes3::load(simd, varying).times(f32x16::splat(simd, gain)));
            }
            if rest.common_mass[cell] == 0.0 {
                let is_free: mask32x16<S> = load(simd, &rest.inverse_mass[cell]).simd_gt(zero);
                next = next.or(is_free, still);
            }
            let position = position.plus(next);
            next.store(&mut moving.displacement[place]);
            position.store(&mut moving.position[place]);
            position.store(&mut moving.integrated[place]);
        }
    }
}

impl Flight {
    /// The part of a cell's displacements in a substep that accelerations have made.
    #[inline(always)]
    pub fn accelerated<S: Simd>(self, simd: S, rest: &BodyColumns, cell: usize) -> Lanes3<S> {
        let gain = self.drag.gain * self.substep * self.substep;
        let uniform = Lanes3::splat(simd, self.uniform * gain);
        match rest.varying.get(cell) {
            Some(varying) => uniform.plus(Lanes3::load(simd, varying).times(f32x16::splat(simd, gain))),
            None => uniform,
        }
    }
}

/// Adds the moves of projections to the displacements of these cells. A contact thereby removes the normal part of the
/// velocity, and restitution zero needs no code.
#[inline(always)]
pub(crate) fn update_displacements<S: Simd>(
    simd: S,
    places: Range<usize>,
    moving: &mut MovingColumns,
    drift: Vec3,
) {
    let drift = Lanes3::splat(simd, drift);
    for cell in places {
        let position = Lanes3::load(simd, &moving.position[cell]);
        let moved = position.minus(Lanes3::load(simd, &moving.integrated[cell])).minus(drift);
        Lanes3::load(simd, &moving.displacement[cell]).plus(moved).store(&mut moving.displacement[cell]);
    }
}

/// Drift of a free body's centre of mass by sticks, in metres. Sticks cannot move it: the drift is rounding, in the
/// same direction in substep after substep. Contacts have added their part to the displacements already.
pub(crate) fn drift(body: &Body) -> Vec3 {
    let Body { particles, context, .. } = body;
    if particles.masses.has_pins {
        return Vec3::ZERO;
    }
    let mut sum = glam::DVec3::ZERO;
    for slot in particles.layout.slots() {
        let moved =
            (particles.position.get(slot) - context.integrated.get(slot)) / particles.inverse_mass[slot];
        sum += moved.as_dvec3();
    }
    (sum / particles.masses.free_mass).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drag_compounds_to_the_same_decay_for_every_substep() {
        let whole = Drag::new(2.0, 1.0 / 60.0);
        let part = Drag::new(2.0, 1.0 / 960.0);
        assert!((libm::powf(part.decay, 16.0) - whole.decay).abs() < 1e-6);
        assert_eq!(Drag::new(0.0, 0.01), Drag::default());
        // For a tiny product the gain must go to one and not to 0/0.
        assert!((Drag::new(1e-6, 1e-4).gain - 1.0).abs() < 1e-6);
    }
}
