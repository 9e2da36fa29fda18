//! The scene manager: sleeps what is at rest, wakes what is touched, culls what is out of sight.

use bevy::prelude::*;

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
        Self {
            sleeping: true,
            sleep_time: 1.0,
            play_area_min: Vec3::splat(-1000.0),
            play_area_max: Vec3::splat(1000.0),
            viewer_distance: 200.0,
            despawn_lost_balls: false,
        }
    }
}
