//! The scene manager: sleeps what is at rest, wakes what is touched, culls what is out of sight.

use bevy::prelude::*;

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::particles::{BodyState, Extent};
use crate::sleep::candidates::Candidates;

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

/// An entity, usually the camera, that bodies are culled by their distance from.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Transform)]
pub struct Viewer;

/// A box in the world, as (least, greatest) corner.
pub(crate) type Bounds = (Vec3, Vec3);

pub(crate) fn overlap(a: Bounds, b: Bounds) -> bool {
    a.0.cmple(b.1).all() && a.1.cmpge(b.0).all()
}

pub(crate) fn grown((low, high): Bounds, by: f32) -> Bounds {
    (low - by, high + by)
}

/// Distance from `eye` to the nearest point of a box, in metres.
pub(crate) fn distance_to(eye: Vec3, (low, high): Bounds) -> f32 {
    eye.distance(eye.max(low).min(high))
}

/// Where a ball can get within a step of `dt` seconds.
pub(crate) fn ball_reach(ball: &ProjectileState, dt: f32, gravity: f32) -> Bounds {
    grown((ball.position(), ball.position()), ball.reach(dt, gravity))
}

/// Where the surface of a body that is simulated can get within a step of `dt` seconds.
pub(crate) fn body_reach(state: &BodyState, dt: f32, gravity: f32) -> Bounds {
    let Extent { bounds, greatest_speed } = state.extent;
    grown(bounds, state.settings.thickness + (greatest_speed + gravity * dt) * dt)
}

fn ball_bounds(ball: &ProjectileState) -> Bounds {
    grown((ball.position(), ball.position()), ball.material().radius)
}

/// Culls what left the play area or sleeps far from every viewer, and brings it back when it is in sight again.
pub(crate) fn cull(
    mut commands: Commands,
    mut bodies: Query<(&mut Activity, &BodyState)>,
    mut balls: Query<(&mut Activity, &ProjectileState, &ProjectileRecord), Without<BodyState>>,
    everything: Query<(Entity, Has<BodyState>), With<Activity>>,
    viewers: Query<(Ref<GlobalTransform>, Ref<Viewer>)>,
    manager: Res<SceneManager>,
    mut candidates: ResMut<Candidates>,
    mut known_viewers: Local<usize>,
) {
    let viewer_count = viewers.iter().count();
    let is_new_view = viewer_count != *known_viewers
        || viewers.iter().any(|(place, viewer)| place.is_changed() || viewer.is_added());
    *known_viewers = viewer_count;
    let candidates = &mut *candidates;
    if is_new_view || manager.is_changed() {
        candidates.bodies.clear();
        candidates.balls.clear();
        for (entity, is_body) in &everything {
            if is_body {
                candidates.bodies.push(entity);
            } else {
                candidates.balls.push(entity);
            }
        }
    }
    let is_far = |(low, high): Bounds| {
        let distance = |viewer: &GlobalTransform| distance_to(viewer.translation(), (low, high));
        !viewers.is_empty() && viewers.iter().all(|(viewer, _)| distance(&viewer) > manager.viewer_distance)
    };
    // False for what is not finite or empty: that is not lost but refused.
    let is_lost = |(low, high): Bounds| {
        let outside = low.cmpgt(manager.play_area_max) | high.cmplt(manager.play_area_min);
        outside.any() && low.cmple(high).all()
    };
    let next = |activity: Activity, bounds: Bounds, refused: bool, still_for: f32| match activity {
        _ if refused || is_lost(bounds) => Activity::Culled,
        Activity::Resting if is_far(bounds) => Activity::Culled,
        Activity::Culled if manager.sleeping && still_for >= manager.sleep_time => {
            if is_far(bounds) {
                Activity::Culled
            } else {
                Activity::Resting
            }
        }
        // It left while it moved, and goes on from there.
        Activity::Culled => Activity::Active,
        same => same,
    };
    for &body in &candidates.bodies {
        let Ok((mut activity, state)) = bodies.get_mut(body) else { continue };
        let next = next(*activity, state.extent.bounds, state.refused, state.context.still_for());
        activity.set_if_neq(next);
    }
    for &ball in &candidates.balls {
        let Ok((mut activity, state, record)) = balls.get_mut(ball) else { continue };
        let bounds = ball_bounds(state);
        if manager.despawn_lost_balls && !record.refused && is_lost(bounds) {
            commands.entity(ball).despawn();
        } else {
            let next = next(*activity, bounds, record.refused, state.still_for());
            activity.set_if_neq(next);
        }
    }
}
