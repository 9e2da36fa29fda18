//! The present substep: its number, its duration and its obstacles.

use crate::simd::isa::Isa;
use crate::state::obstacle::Obstacle;

/// Data that all stages of a substep share and no body owns.
#[derive(Clone, Copy, Default)]
pub(crate) struct Substep<'a> {
    pub obstacles: &'a [Obstacle],
    /// Its number in the step, from 0.
    pub index: u32,
    /// The number of substeps in the step.
    pub count: u32,
    /// Seconds.
    pub duration: f32,
    pub isa: Isa,
}

impl Substep<'_> {
    /// The time since the step began, in seconds.
    pub fn start(&self) -> f32 {
        self.index as f32 * self.duration
    }
}
