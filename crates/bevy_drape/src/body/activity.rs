//! Whether a body is simulated.

use bevy::prelude::*;
use drape_solver::world::activity as solver;

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

impl From<solver::Activity> for Activity {
    fn from(activity: solver::Activity) -> Self {
        match activity {
            solver::Activity::Active => Self::Active,
            solver::Activity::Resting => Self::Resting,
            solver::Activity::Culled => Self::Culled,
            solver::Activity::Frozen => Self::Frozen,
        }
    }
}

impl From<Activity> for solver::Activity {
    fn from(activity: Activity) -> Self {
        match activity {
            Activity::Active => Self::Active,
            Activity::Resting => Self::Resting,
            Activity::Culled => Self::Culled,
            Activity::Frozen => Self::Frozen,
        }
    }
}
