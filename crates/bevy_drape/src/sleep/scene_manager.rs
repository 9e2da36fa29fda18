//! The scene manager: sleeps what is at rest, wakes what is touched, culls what is out of sight.

use bevy::prelude::*;
use drape_solver::ActivityRules;

/// When bodies fall asleep and when they are culled.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SceneManager {
    /// Whether bodies at rest fall asleep.
    pub sleeping: bool,
    /// How long a body, and all that it touches, must stay below the threshold of rest (2 cm/s, root mean
    /// square) before it falls asleep, in seconds. Shorter than that, a swing may be at its turning point.
    pub sleep_time: f32,
    /// Least corner of the play area in metres. Bodies wholly outside are culled.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub play_area_min: Vec3,
    /// Greatest corner of the play area in metres.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub play_area_max: Vec3,
    /// Distance in metres from every [`Viewer`] beyond which a sleeping body is culled; it comes back when a
    /// viewer does. Without viewers nothing is culled for distance.
    pub viewer_distance: f32,
    /// Whether balls that left the play area are despawned.
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
