//! The scene manager: sleeps what is at rest, wakes what is touched, culls what is out of sight.

use bevy::prelude::*;

use crate::activity::Activity;
use crate::clock::DrapeClock;
use crate::environment::SolverEnvironment;
use crate::obstacle::StirredSpace;
use crate::particles::{BodyState, CreationOrder, Extent, Particles, Sticks};
use crate::projectile::{ProjectileRecord, ProjectileState};
use crate::settings::{DefaultSolverSettings, SolverSettings, same_settings};

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
pub(crate) type Bounds = (Vec3, Vec3);

pub(crate) fn overlap(a: Bounds, b: Bounds) -> bool {
    a.0.cmple(b.1).all() && a.1.cmpge(b.0).all()
}

fn grown((low, high): Bounds, by: f32) -> Bounds {
    (low - by, high + by)
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

/// Something active, and where it can get in this step: it wakes what rests there.
#[derive(Clone, Copy)]
struct Stirrer {
    bounds: Bounds,
    is_ball: bool,
}

/// A body or ball at rest.
#[derive(Clone, Copy)]
struct Sleeper {
    entity: Entity,
    bounds: Bounds,
    is_ball: bool,
}

/// What stirs and what rests in this step.
#[derive(Default)]
pub(crate) struct Stir {
    stirrers: Vec<Stirrer>,
    sleepers: Vec<Sleeper>,
}

/// Wakes what was pushed, edited, or may be touched in this step. What has just been woken may wake others.
pub(crate) fn wake(
    mut bodies: Query<(
        Entity,
        &mut Activity,
        &mut Particles,
        Ref<Sticks>,
        &mut BodyState,
        Option<&SolverSettings>,
    )>,
    mut balls: Query<
        (Entity, &mut Activity, &mut ProjectileState, &mut ProjectileRecord),
        Without<Particles>,
    >,
    defaults: Res<DefaultSolverSettings>,
    solver: Res<SolverEnvironment>,
    clock: Res<DrapeClock>,
    stirred: Res<StirredSpace>,
    mut order: ResMut<CreationOrder>,
    mut stir: Local<Stir>,
) {
    let Stir { stirrers, sleepers } = &mut *stir;
    let (dt, gravity) = (clock.delta(), solver.environment.gravity.length());
    let is_stirred = |bounds: Bounds| stirred.0.iter().any(|&space| overlap(space, bounds));
    stirrers.clear();
    sleepers.clear();
    for (entity, mut activity, mut ball, mut record) in &mut balls {
        // A ball that was refused gets another chance when somebody has edited it.
        let mended = record.refused && ball.is_changed();
        let bounds = ball_reach(&ball, dt, gravity);
        let resting = *activity == Activity::Resting;
        if mended || (resting && (ball.is_disturbed() || solver.changed || is_stirred(bounds))) {
            record.refused = false;
            *activity = Activity::Active;
            ball.bypass_change_detection().rouse();
        }
        match *activity {
            Activity::Active => stirrers.push(Stirrer { bounds, is_ball: true }),
            Activity::Resting => sleepers.push(Sleeper { entity, bounds, is_ball: true }),
            Activity::Culled => {}
        }
    }
    for (entity, mut activity, mut particles, sticks, mut state, settings) in &mut bodies {
        let state = &mut *state;
        let settings = settings.copied().unwrap_or(defaults.0).into();
        let edited = particles.is_disturbed();
        if state.order == 0 {
            // A body that was not built by the plugin.
            state.order = order.next();
            state.extent = Extent::of(&particles);
        } else if edited && particles.is_changed() {
            state.extent = Extent::of(&particles);
        }
        let rearranged =
            !same_settings(&state.settings, &settings) || (sticks.is_changed() && !sticks.is_added());
        state.settings = settings;
        let mended = state.refused && (rearranged || particles.is_changed());
        let resting = *activity == Activity::Resting;
        let bounds = grown(state.extent.bounds, settings.thickness);
        if mended || (resting && (edited || rearranged || solver.changed || is_stirred(bounds))) {
            state.refused = false;
            *activity = Activity::Active;
            particles.bypass_change_detection().rouse();
        }
        match *activity {
            Activity::Active => {
                stirrers.push(Stirrer { bounds: body_reach(state, dt, gravity), is_ball: false });
            }
            Activity::Resting => sleepers.push(Sleeper { entity, bounds, is_ball: false }),
            Activity::Culled => {}
        }
    }
    let mut next = 0;
    while next < stirrers.len() && !sleepers.is_empty() {
        let stirrer = stirrers[next];
        next += 1;
        sleepers.retain(|sleeper| {
            // Only balls touch things: two cloths do not.
            let met = (stirrer.is_ball || sleeper.is_ball) && overlap(stirrer.bounds, sleeper.bounds);
            if met {
                stirrers.push(Stirrer { bounds: sleeper.bounds, is_ball: sleeper.is_ball });
                if let Ok((_, mut activity, mut ball, _)) = balls.get_mut(sleeper.entity) {
                    *activity = Activity::Active;
                    ball.bypass_change_detection().rouse();
                } else if let Ok((_, mut activity, mut particles, ..)) = bodies.get_mut(sleeper.entity) {
                    *activity = Activity::Active;
                    particles.bypass_change_detection().rouse();
                }
            }
            !met
        });
    }
}

/// Culls what left the play area or sleeps far from every viewer, and brings it back when it is in sight again.
pub(crate) fn cull(
    mut commands: Commands,
    mut bodies: Query<(&mut Activity, &BodyState)>,
    mut balls: Query<(Entity, &mut Activity, &ProjectileState, &ProjectileRecord), Without<BodyState>>,
    viewers: Query<&GlobalTransform, With<Viewer>>,
    manager: Res<SceneManager>,
) {
    let is_far = |(low, high): Bounds| {
        let distance = |viewer: &GlobalTransform| {
            let eye = viewer.translation();
            eye.distance(eye.max(low).min(high))
        };
        !viewers.is_empty() && viewers.iter().all(|viewer| distance(viewer) > manager.viewer_distance)
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
    for (mut activity, state) in &mut bodies {
        let next = next(*activity, state.extent.bounds, state.refused, state.context.still_for());
        activity.set_if_neq(next);
    }
    for (entity, mut activity, ball, record) in &mut balls {
        let bounds = ball_bounds(ball);
        if manager.despawn_lost_balls && !record.refused && is_lost(bounds) {
            commands.entity(entity).despawn();
        } else {
            let next = next(*activity, bounds, record.refused, ball.still_for());
            activity.set_if_neq(next);
        }
    }
}
