//! Ropes that are paid out and reeled in.

use std::sync::Arc;

use bevy::prelude::*;

use crate::body::activity::Activity;
use crate::body::particles::{Particles, Sticks};
use crate::build::rope::Rope;
use crate::clock::DrapeClock;
use crate::refusal::Refusals;

/// Changes the length of a [`Rope`]. All links grow or shrink alike, with their mass; masses hung on the rope stay.
/// Tethers follow. A torn rope no longer changes, and one that is frozen or culled waits.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Winch {
    /// Speed in m/s at which rope is paid out, or reeled in if negative; 0, the default, holds.
    pub speed: f32,
    /// The least length in metres, above 0; 0.1 by default.
    pub least: f32,
    /// The greatest length in metres; 100 by default.
    pub greatest: f32,
}

impl Default for Winch {
    fn default() -> Self {
        Self { speed: 0.0, least: 0.1, greatest: 100.0 }
    }
}

impl Winch {
    /// Pays out `speed` metres per second, or reels in if negative.
    pub fn new(speed: f32) -> Self {
        Self { speed, ..Self::default() }
    }

    fn is_usable(&self) -> bool {
        self.speed.is_finite() && self.least > 0.0 && self.greatest >= self.least && self.greatest.is_finite()
    }
}

/// Returns the length of a rope at rest in metres; none if the rope is torn.
pub fn rest_length(rope: &Rope, sticks: &Sticks) -> Option<f32> {
    let count = sticks.particle_count();
    let is_whole = count >= 2 && count == rope.particles as usize && sticks.segments().len() == count - 1;
    // Ropes are straight at rest.
    is_whole.then(|| sticks.rest_position(0).distance(sticks.rest_position(count - 1)))
}

/// Turns the winches for one step.
pub(crate) fn turn_winches(
    mut ropes: Query<(Entity, &Rope, Ref<Winch>, &Activity, &mut Particles, &mut Sticks)>,
    clock: Res<DrapeClock>,
    mut refusals: ResMut<Refusals>,
) {
    for (entity, rope, winch, activity, mut particles, mut sticks) in &mut ropes {
        if winch.is_changed() {
            refusals.forget_component(entity, "Winch");
        }
        if !winch.is_usable() {
            let reason = "its lengths must be above zero, the least first, and all of it finite";
            refusals.entity(entity, "Winch", reason);
            continue;
        }
        // What is not simulated would be jerked when it goes on.
        if activity.is_carried() {
            continue;
        }
        let Some(length) = rest_length(rope, &sticks) else { continue };
        let wanted = (length + winch.speed * clock.delta()).clamp(winch.least, winch.greatest);
        // A rope that was built outside the range approaches it at the winch's speed.
        let farthest = winch.speed.abs() * clock.delta();
        let wanted = wanted.clamp(length - farthest, length + farthest);
        if wanted == length || particles.len() != sticks.particle_count() {
            continue;
        }
        let Ok((_, topology)) = rope.builder(Vec3::ZERO, Vec3::X * wanted).build_parts() else { continue };
        let links = particles.len() - 1;
        let gain = rope.linear_density * (wanted - length) / links as f32;
        for i in 0..particles.len() {
            let inverse_mass = particles.inverse_mass(i);
            let gain = if i == 0 || i == links { 0.5 * gain } else { gain };
            let mass = 1.0 / inverse_mass + gain;
            if inverse_mass > 0.0 && mass > 0.0 {
                particles.set_inverse_mass(i, 1.0 / mass);
            }
        }
        // All at once, the first substep would throw what hangs on it, by the number of substeps times the winch's speed.
        particles.change_lengths_from(length / wanted);
        sticks.0 = Arc::new(topology);
    }
}
