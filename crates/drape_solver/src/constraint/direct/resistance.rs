//! How the sticks of a chain resist: what they add to its matrix, and how much of its step they let it take.
//!
//! Design: `docs/design/line_solves.md`.

use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

use crate::constants::{CHAIN_REGULARISER, EASING, ELASTIC_REGULARISER, OVERSTRETCHED, OVERSTRETCHED_STICK};
use crate::state::membrane::ElasticStick;

/// The least compliance of sticks, in parts of the inverse masses of their ends.
pub(super) fn regulariser(stick: ElasticStick) -> f32 {
    if stick.compliance > 0.0 { ELASTIC_REGULARISER } else { CHAIN_REGULARISER }
}

/// Compliance by lane: at an edge of the cloth it is twice that inside.
#[inline(always)]
pub(super) fn compliances<S: Simd>(simd: S, inside: f32, edges: u16) -> f32x16<S> {
    let is_edge = mask32x16::from_bitmask(simd, u64::from(edges));
    is_edge.select(f32x16::splat(simd, 2.0 * inside), f32x16::splat(simd, inside))
}

/// How fast an overstretched stick eases its chain: not if it is a spring, which stretches as far as it is pulled.
fn easing(stick: ElasticStick) -> f32 {
    if stick.compliance > 0.0 { 0.0 } else { EASING }
}

/// The part of its step that a line takes that is solved alone, as ropes are, and whose longest stick is too long by `error` metres. In a
/// knot a few sticks carry the pull, and a rope that took its whole step would draw the strands through each other.
pub(super) fn eased_part(stick: ElasticStick, error: f32) -> f32 {
    let excess = (error - OVERSTRETCHED_STICK * stick.rest) * (easing(stick) / stick.rest);
    1.0 / (1.0 + excess.max(0.0))
}

/// The parts of their steps that lines of cloth take whose sticks are too long by `stretch` metres on average. A ball that lies on the cloth
/// may stretch a few sticks for a moment: their line then takes its whole step, or the ball would sink in.
#[inline(always)]
pub(super) fn eased_parts<S: Simd>(simd: S, stick: ElasticStick, stretch: f32x16<S>) -> f32x16<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let excess = (stretch - OVERSTRETCHED * stick.rest) * (easing(stick) / stick.rest);
    one / (one + excess.max(zero))
}
