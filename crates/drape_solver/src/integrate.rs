//! The Verlet step with drag.
//!
//! Position Verlet `x' = x + (1 - c)(x - x*) + a dt^2; x* = x` (Liu 2019, section 1.2; with `c = 0.01` its
//! `1.99x - 0.99x*`), in displacement form. Some copies have `a dt^2 / 2` here: that halves gravity.

use glam::Vec3;

use crate::body::Body;

/// What drag does to a displacement and to an acceleration in one substep.
///
/// A drag of `c` (1/s) multiplies the velocity by `f = exp(-c h)` in a substep `h`; an acceleration then acts
/// for the mean of that decay, `g = (1 - f) / (c h)`. The terminal velocity is `a / c` for every `h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    decay: f32,
    gain: f32,
}

impl Default for Drag {
    fn default() -> Self {
        Self { decay: 1.0, gain: 1.0 }
    }
}

impl Drag {
    /// For a drag in 1/s and a substep in seconds.
    pub fn new(drag: f32, substep: f32) -> Self {
        let exponent = f64::from(drag) * f64::from(substep);
        if exponent == 0.0 {
            return Self::default();
        }
        let lost = -libm::expm1(-exponent);
        Self { decay: (1.0 - lost) as f32, gain: (lost / exponent) as f32 }
    }

    /// The substep, in seconds, as a load feels it: where drag takes a part of what an acceleration gives, it must
    /// take the same part of what a soft stick gives back, or drag would change how far a load stretches it.
    pub(crate) fn felt_substep(self, substep: f32) -> f32 {
        substep * self.gain.sqrt()
    }

    /// The displacement of the next substep.
    pub(crate) fn step(self, displacement: Vec3, acceleration: Vec3, substep: f32) -> Vec3 {
        displacement * self.decay + acceleration * (self.gain * substep * substep)
    }
}

/// One substep of free flight for all particles of `body`. Pinned particles go where their pin takes them.
pub(crate) fn integrate(body: &mut Body) {
    let Body { particles, context, .. } = body;
    let h = particles.substep;
    let drag = context.drag;
    let gain = drag.gain * h * h;
    let uniform = context.uniform_acceleration.to_array();
    let columns = particles.position.each_mut().into_iter().zip(particles.displacement.each_mut());
    let varying = context.acceleration.each();
    let integrated = context.integrated.each_mut();
    for ((((x, d), varying), integrated), uniform) in columns.zip(varying).zip(integrated).zip(uniform) {
        let rows = x.iter_mut().zip(d.iter_mut()).zip(integrated.iter_mut());
        if varying.is_empty() {
            let shift = uniform * gain;
            for (((x, d), start), &w) in rows.zip(&particles.inverse_mass) {
                *d = if w > 0.0 { *d * drag.decay + shift } else { 0.0 };
                *x += *d;
                *start = *x;
            }
        } else {
            let rows = rows.zip(varying.iter());
            for ((((x, d), start), &a), &w) in rows.zip(&particles.inverse_mass) {
                *d = if w > 0.0 { *d * drag.decay + (uniform + a) * gain } else { 0.0 };
                *x += *d;
                *start = *x;
            }
        }
    }
    for &(i, shift) in &context.pin_shifts {
        let i = i as usize;
        particles.position.add(i, shift);
        particles.displacement.set(i, shift);
        context.integrated.set(i, particles.position.get(i));
    }
}

/// Carries what the projections moved into the displacements: this is where a contact takes the normal part
/// of the velocity, and where restitution zero falls out by itself.
pub(crate) fn update_displacements(body: &mut Body) {
    let Body { particles, context, .. } = body;
    let position = particles.position.each();
    let displacement = particles.displacement.each_mut();
    let masses = &particles.inverse_mass;
    for ((x, d), start) in position.into_iter().zip(displacement).zip(context.integrated.each_mut()) {
        // Contacts have written their part already; what is left is the sticks' and cannot move the centre of mass
        // of a free body. What it seems to move is rounding, the same way in substep after substep.
        let mut drift = 0.0;
        if context.free_mass > 0.0 {
            let moved = x.iter().zip(start.iter()).zip(masses).map(|((x, start), w)| (x - start) / w);
            drift = (moved.map(f64::from).sum::<f64>() / context.free_mass) as f32;
        }
        for ((&x, d), start) in x.iter().zip(d.iter_mut()).zip(start.iter_mut()) {
            *d += x - *start - drift;
            *start = x;
        }
    }
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
