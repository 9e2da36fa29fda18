//! The scene manager: sleeps what is at rest, wakes what is touched, culls what is out of sight.

use bevy::prelude::*;

use crate::activity::Activity;
use crate::environment::SolverEnvironment;
use crate::obstacle::StirredSpace;
use crate::particles::{BodyState, Particles};
use crate::projectile::{ProjectileRecord, ProjectileState};
use crate::settings::{DefaultSolverSettings, SolverSettings};

/// When bodies fall asleep and when they are culled.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct SceneManager {
    /// Whether bodies at rest fall asleep.
    pub sleeping: bool,
    /// How long a body, and all that it touches, must stay below the threshold of rest (2 cm/s, root mean
    /// square) before it falls asleep, in seconds. Shorter than that, a swing may be at its turning point.
    pub sleep_time: f32,
    /// Least corner of the play area in metres. Bodies wholly outside are culled.
    pub play_area_min: Vec3,
    /// Greatest corner of the play area in metres.
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
type Bounds = (Vec3, Vec3);

fn overlap(a: Bounds, b: Bounds) -> bool {
    a.0.cmple(b.1).all() && a.1.cmpge(b.0).all()
}

fn ball_bounds(ball: &ProjectileState) -> Bounds {
    let radius = Vec3::splat(ball.material().radius);
    (ball.position() - radius, ball.position() + radius)
}

/// What may wake a body at rest in this step, besides itself.
#[derive(Default)]
pub(crate) struct Stir {
    boxes: Vec<Bounds>,
}

/// Wakes what was pushed, edited, or may be touched in this step.
pub(crate) fn wake(
    mut bodies: Query<(&mut Activity, &Particles, &mut BodyState, Option<&SolverSettings>)>,
    mut balls: Query<(&mut Activity, &ProjectileState), Without<Particles>>,
    defaults: Res<DefaultSolverSettings>,
    solver: Res<SolverEnvironment>,
    stirred: Res<StirredSpace>,
    mut stir: Local<Stir>,
) {
    let environment = &solver.environment;
    let reach = |ball: &ProjectileState| {
        let path = (ball.velocity().length() + environment.gravity.length() * environment.dt) * environment.dt;
        let (low, high) = ball_bounds(ball);
        (low - path, high + path)
    };
    stir.boxes.clear();
    stir.boxes.extend(&stirred.0);
    for (mut activity, ball) in &mut balls {
        let woken = *activity == Activity::Resting
            && (ball.is_disturbed()
                || solver.changed
                || stirred.0.iter().any(|&space| overlap(space, reach(ball))));
        if woken {
            *activity = Activity::Active;
        }
        if *activity == Activity::Active {
            stir.boxes.push(reach(ball));
        }
    }
    for (mut activity, particles, mut state, settings) in &mut bodies {
        let settings = settings.copied().unwrap_or(defaults.0).into();
        let edited = state.settings != settings || particles.is_disturbed();
        state.settings = settings;
        if *activity != Activity::Resting {
            continue;
        }
        let touched = || {
            let (low, high) = state.bounds;
            let bounds = (low - settings.thickness, high + settings.thickness);
            stir.boxes.iter().any(|&space| overlap(space, bounds))
        };
        if edited || solver.changed || touched() {
            *activity = Activity::Active;
        }
    }
}

/// Culls what left the play area or sleeps far from every viewer, and brings sleepers back when one comes near.
pub(crate) fn cull(
    mut commands: Commands,
    mut bodies: Query<(&mut Activity, &BodyState)>,
    mut balls: Query<(Entity, &mut Activity, &ProjectileState, &ProjectileRecord), Without<BodyState>>,
    viewers: Query<&GlobalTransform, With<Viewer>>,
    manager: Res<SceneManager>,
) {
    let play_area = (manager.play_area_min, manager.play_area_max);
    let is_far = |(low, high): Bounds| {
        let distance = |viewer: &GlobalTransform| {
            let eye = viewer.translation();
            eye.distance(eye.clamp(low, high))
        };
        !viewers.is_empty() && viewers.iter().all(|viewer| distance(viewer) > manager.viewer_distance)
    };
    let next = |activity: Activity, bounds: Bounds, refused: bool| match activity {
        _ if refused || !overlap(bounds, play_area) => Activity::Culled,
        Activity::Resting if is_far(bounds) => Activity::Culled,
        Activity::Culled if !is_far(bounds) => Activity::Resting,
        same => same,
    };
    for (mut activity, state) in &mut bodies {
        let next = next(*activity, state.bounds, state.refused);
        activity.set_if_neq(next);
    }
    for (entity, mut activity, ball, record) in &mut balls {
        let next = next(*activity, ball_bounds(ball), record.refused);
        if next == Activity::Culled && !record.refused && manager.despawn_lost_balls {
            commands.entity(entity).despawn();
        } else {
            activity.set_if_neq(next);
        }
    }
}
