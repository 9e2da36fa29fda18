//! Drag: the part of a velocity that a substep takes.

use glam::Vec3;

/// Factors of displacement and acceleration by which drag acts in one substep.
///
/// A drag of `c` (1/s) multiplies the velocity by `f = exp(-c h)` in a substep `h`; an acceleration then acts
/// for the mean of that decay, `g = (1 - f) / (c h)`. The terminal velocity is `a / c` for every `h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    pub(crate) decay: f32,
    pub(crate) gain: f32,
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

    /// The part of a displacement that is left after the substep.
    pub fn decay(self) -> f32 {
        self.decay
    }

    /// The displacement by an acceleration, in parts of that without drag.
    pub fn gain(self) -> f32 {
        self.gain
    }

    /// The substep in seconds that soft sticks use. Drag scales the displacement by an acceleration, so it must scale
    /// the restoring displacement of a soft stick alike; else drag would change the stretch under a load.
    pub fn effective_substep(self, substep: f32) -> f32 {
        substep * self.gain.sqrt()
    }

    /// The displacement of the next substep.
    pub(crate) fn step(self, displacement: Vec3, acceleration: Vec3, substep: f32) -> Vec3 {
        displacement * self.decay + acceleration * (self.gain * substep * substep)
    }
}
