//! Settings for sleeping and culling.

use bevy::prelude::*;
use drape_solver::ActivityRules;

/// Settings for the sleeping and culling of bodies.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SceneManager {
    /// True if bodies at rest fall asleep.
    pub sleeping: bool,
    /// Time in seconds for which a body, and everything that it touches, must stay below the threshold of rest (2 cm/s,
    /// root mean square) before it falls asleep. In less time, a swing may be at its turning point.
    pub sleep_time: f32,
    /// Least corner of the play area in metres. Bodies wholly outside are culled.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub play_area_min: Vec3,
    /// Greatest corner of the play area in metres.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub play_area_max: Vec3,
    /// Distance in metres from every [`Viewer`] beyond which a sleeping body is culled, until a viewer returns. Without
    /// viewers nothing is culled for distance.
    pub viewer_distance: f32,
    /// True if balls that left the play area are despawned.
    pub despawn_lost_balls: bool,
}

impl Default for SceneManager {
    fn default() -> Self {
        let ActivityRules { sleeping, sleep_time, play_area_min, play_area_max, viewer_distance } =
            ActivityRules::default();
        let despawn_lost_balls = false;
        Self { sleeping, sleep_time, play_area_min, play_area_max, viewer_distance, despawn_lost_balls }
    }
}

impl SceneManager {
    /// The rules of the solver.
    pub(crate) fn rules(&self) -> ActivityRules {
        let Self { sleeping, sleep_time, play_area_min, play_area_max, viewer_distance, .. } = *self;
        ActivityRules { sleeping, sleep_time, play_area_min, play_area_max, viewer_distance }
    }
}
