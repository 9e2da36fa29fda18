//! The number of bodies in each state of activity.

use bevy::prelude::*;

use crate::ball::projectile::ProjectileState;
use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::body::particles::Particles;

/// Number of bodies, balls included, in each state of [`Activity`] after the last step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ActivityCounts {
    /// Simulated bodies.
    pub active: usize,
    /// Resting bodies.
    pub resting: usize,
    /// Culled bodies.
    pub culled: usize,
    /// Bodies frozen at a distance.
    pub frozen: usize,
}

/// Counts the bodies and balls that have been built.
pub(crate) fn count_activity(
    bodies: Query<&Activity, Or<(With<Particles>, With<OnGpu>, With<ProjectileState>)>>,
    mut counts: ResMut<ActivityCounts>,
) {
    let mut new = ActivityCounts::default();
    for activities in bodies.contiguous_iter().into_iter().flatten() {
        // In 32 bits, which vectorizes well.
        let count =
            |state| activities.iter().map(|&activity| u32::from(activity == state)).sum::<u32>() as usize;
        new.active += count(Activity::Active);
        new.resting += count(Activity::Resting);
        new.culled += count(Activity::Culled);
        new.frozen += count(Activity::Frozen);
    }
    counts.set_if_neq(new);
}
