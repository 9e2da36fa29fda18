//! Activity of bodies: simulated, at rest, or culled.

use bevy::prelude::*;
use drape_solver::world::activity as solver;

/// Activity of a body: simulated, at rest, or out of sight. The scene manager writes it; set it by hand to put a body
/// to sleep or to wake it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Activity {
    /// Simulated.
    #[default]
    Active,
    /// At rest: costs nothing until something touches, pushes or edits it.
    Resting,
    /// Outside the play area, asleep far from every viewer, or invalid: neither simulated nor drawn.
    Culled,
    /// Too far from every viewer for its motion to be seen ([`LevelOfDetail`](crate::detail::level::LevelOfDetail)):
    /// drawn, but not simulated, and touched by nothing. It moves rigidly with its entity.
    Frozen,
}

impl Activity {
    /// True if any of these is [`Active`](Self::Active).
    pub(crate) fn is_any_active(activities: &[Self]) -> bool {
        activities.iter().fold(false, |any, activity| any | (*activity == Self::Active))
    }

    /// True if the body moves rigidly with its entity, because it is not simulated.
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
