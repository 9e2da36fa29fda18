//! Whether a body is simulated.

use bevy::prelude::*;

use crate::ball::projectile::ProjectileState;
use crate::body::particles::Particles;

/// Whether a body is simulated, at rest, or out of sight. The scene manager keeps it; setting it by hand puts a
/// body to sleep or wakes it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Activity {
    /// Simulated.
    #[default]
    Active,
    /// Came to rest: costs nothing until something touches, pushes or edits it.
    Resting,
    /// Left the play area, or fell asleep far from every viewer, or cannot be simulated: neither simulated nor
    /// drawn.
    Culled,
    /// Too far from every viewer for its motion to be seen ([`LevelOfDetail`](crate::detail::level::LevelOfDetail)): drawn as it is, but not
    /// simulated, and touched by nothing. It goes along with its entity.
    Frozen,
}

impl Activity {
    /// Whether any of these is [`Active`](Self::Active).
    pub(crate) fn is_any_active(activities: &[Self]) -> bool {
        activities.iter().fold(false, |any, activity| any | (*activity == Self::Active))
    }

    /// Whether the body goes along with its entity as it is, because nobody simulates it.
    pub(crate) fn is_carried(self) -> bool {
        matches!(self, Self::Culled | Self::Frozen)
    }
}

/// How many bodies, balls included, are in each state of [`Activity`] after the last step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct ActivityCounts {
    /// Bodies that are simulated.
    pub active: usize,
    /// Bodies at rest.
    pub resting: usize,
    /// Bodies that are culled.
    pub culled: usize,
    /// Bodies that stand still as they are far away.
    pub frozen: usize,
}

/// Counts what has been built.
pub(crate) fn count_activity(
    bodies: Query<&Activity, Or<(With<Particles>, With<ProjectileState>)>>,
    mut counts: ResMut<ActivityCounts>,
) {
    let mut new = ActivityCounts::default();
    for activities in bodies.contiguous_iter().into_iter().flatten() {
        // In 32 bits, so that many are counted at once.
        let count =
            |state| activities.iter().map(|&activity| u32::from(activity == state)).sum::<u32>() as usize;
        new.active += count(Activity::Active);
        new.resting += count(Activity::Resting);
        new.culled += count(Activity::Culled);
        new.frozen += count(Activity::Frozen);
    }
    counts.set_if_neq(new);
}
