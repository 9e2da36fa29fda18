//! Bodies that cloth carries: how long they have been still, and when they wake.

use core::cell::LazyCell;

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::drape_solver::world::bounds::Bounds;
use bevy_drape::environment::{DynamicObstacle, ObstacleReaction};
use bevy_drape::prelude::*;

use crate::body::BodyReach;
use crate::marks::{BodyObstacle, ObstacleOf};
use crate::motion::EngineBody;

/// Asks the engine to wake a body that sleeps: cloth pushes it otherwise than when it fell asleep, or has gone.
#[derive(EntityEvent, Clone, Copy, Debug)]
pub struct WakeRequest {
    /// The body.
    pub entity: Entity,
}

/// The support that a body has of cloth.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Mean acceleration by which cloth has lately held or pushed the body, in m/s^2.
    pub acceleration: Vec3,
    /// Seconds for which the body has been slow enough for sleep.
    pub still_for: f32,
    /// The acceleration in the first step that the body slept through: cloth that is squeezed between the body and the ground bears
    /// less once the body holds itself.
    asleep: Option<Vec3>,
    /// True if cloth is tied to the body.
    is_tied: bool,
    /// True if cloth moves that is tied to the body, or the pins of cloth that carries it.
    is_stirred: bool,
    /// True if cloth that carries the body moves fast beside it.
    is_shaken: bool,
}

impl Load {
    /// True if cloth carries a good part of the body.
    pub fn is_carried(&self) -> bool {
        self.acceleration.length() > WAKING_CHANGE
    }

    /// Wakes the body that sleeps with this load.
    fn wake(&mut self, body: Entity, commands: &mut Commands) {
        commands.trigger(WakeRequest { entity: body });
        *self = Self::default();
    }

    /// Wakes a body that slept on cloth which has gone.
    pub(crate) fn wake_if_carried(&mut self, of: Entity, body: &EngineBody, commands: &mut Commands) {
        if self.is_carried() && body.is_asleep {
            self.wake(of, commands);
        }
    }

    /// True if a sleeping body wakes that cloth pushes with this acceleration.
    fn wakes(&mut self, acceleration: Vec3) -> bool {
        let is_pushed = if self.is_tied {
            // A body that sleeps holds what is tied to it: it does not feel the pull.
            acceleration.length() > WAKING_CHANGE
        } else {
            let before = *self.asleep.get_or_insert(acceleration);
            // Cloth between the body and the ground may not push a body that holds itself, though it is still there.
            let was_pushed = before != Vec3::ZERO || self.is_shaken;
            let has_lost_support = self.is_carried() && was_pushed && acceleration == Vec3::ZERO;
            has_lost_support || acceleration.distance(before) > WAKING_CHANGE
        };
        self.is_stirred || is_pushed
    }
}

/// Notes which sleeping bodies are tied to cloth that moves, or lie on cloth whose pins move.
pub(crate) fn note_carriers(
    cloths: Query<(&Particles, &Activity, Option<&Attachment>)>,
    bodies: Query<(&BodyObstacle, &BodyReach)>,
    mut obstacles: Query<(Entity, &ObstacleOf, &EngineBody, &mut Load)>,
    mut carried: Local<Vec<(Entity, Vec3, f32)>>,
) {
    carried.clear();
    for (entity, of, body, mut load) in &mut obstacles {
        let load = load.bypass_change_detection();
        (load.is_tied, load.is_stirred, load.is_shaken) = (false, false, false);
        if body.is_asleep
            && load.is_carried()
            && let Ok((_, reach)) = bodies.get(of.0)
        {
            carried.push((entity, body.place.translation, reach.radius));
        }
    }
    for (particles, activity, attachment) in &cloths {
        // These look at all particles, so only where it matters.
        let is_fast = LazyCell::new(|| is_any(particles, |_, speed| speed > WAKING_SPEED));
        let is_led = LazyCell::new(|| {
            is_any(particles, |i, speed| particles.is_pinned(i) && speed > WAKING_SPEED_OF_PINS)
        });
        for tie in attachment.map_or(&[][..], |attachment| &attachment.ties) {
            if let Ok((obstacle, _)) = bodies.get(tie.entity)
                && let Ok((_, _, body, mut load)) = obstacles.get_mut(obstacle.entity())
                && body.is_asleep
            {
                load.is_tied = true;
                load.is_stirred |= *is_fast;
            }
        }
        if carried.is_empty() || *activity != Activity::Active {
            continue;
        }
        let bounds = Bounds::from(particles.bounds());
        for &(entity, place, reach) in &carried {
            let is_beside = |i| particles.position(i).distance(place) < reach;
            if bounds.distance_to(place) < reach
                && is_any(particles, |i, _| is_beside(i))
                && let Ok((.., mut load)) = obstacles.get_mut(entity)
            {
                // The rest of a net springs back once the body holds itself, so only pins stir it.
                load.is_stirred |= *is_led;
                load.is_shaken |= is_any(particles, |i, speed| speed > WAKING_SPEED && is_beside(i));
            }
        }
    }
}

/// True if a particle is such, by its index and its speed in m/s.
fn is_any(particles: &Particles, is_such: impl Fn(usize, f32) -> bool) -> bool {
    (0..particles.len()).any(|i| is_such(i, particles.velocity(i).length()))
}

/// Takes the mean of the loads on bodies that are awake, and wakes those that cloth pushes otherwise than it did when
/// they fell asleep.
pub(crate) fn note_loads(
    mut obstacles: Query<(&ObstacleOf, &DynamicObstacle, &ObstacleReaction, &mut EngineBody, &mut Load)>,
    mut commands: Commands,
    time: Res<Time>,
) {
    for (of, dynamic, reaction, mut body, mut load) in &mut obstacles {
        if body.is_paused {
            continue;
        }
        let push = reaction.impulse / dynamic.mass;
        let acceleration = push / time.delta_secs();
        if !body.is_asleep {
            load.acceleration = load.acceleration.lerp(acceleration, LOAD_PART);
            load.asleep = None;
            let [speed, spin] = body.sleep_speeds;
            let is_still = body.velocity.length() < speed && body.angular_velocity.length() < spin;
            load.still_for = if is_still { load.still_for + time.delta_secs() } else { 0.0 };
        } else if reaction.is_near && load.wakes(acceleration) {
            load.wake(of.0, &mut commands);
            body.velocity += push;
            body.is_pushed = true;
        }
    }
}

/// Wakes bodies that slept on cloth which is gone.
pub(crate) fn wake_carried(
    _gone: On<Remove<Particles>>,
    mut obstacles: Query<(&ObstacleOf, &EngineBody, &mut Load)>,
    mut commands: Commands,
) {
    for (of, body, mut load) in &mut obstacles {
        load.wake_if_carried(of.0, body, &mut commands);
    }
}

/// Wakes bodies that slept on a rope which has let go.
pub(crate) fn wake_released(
    released: On<Remove<Attachment>>,
    attachments: Query<&Attachment>,
    bodies: Query<&BodyObstacle>,
    mut obstacles: Query<(&EngineBody, &mut Load)>,
    mut commands: Commands,
) {
    let Ok(attachment) = attachments.get(released.entity) else { return };
    for tie in &attachment.ties {
        let Ok(obstacle) = bodies.get(tie.entity) else { continue };
        if let Ok((body, mut load)) = obstacles.get_mut(obstacle.entity())
            && body.is_asleep
        {
            load.wake(tie.entity, &mut commands);
        }
    }
}

/// A sleeping body wakes if the acceleration by which cloth holds or pushes it changes by this much (m/s^2): half its
/// weight on earth.
const WAKING_CHANGE: f32 = 5.0;

/// It wakes, too, if cloth that is tied to it moves this fast (m/s).
const WAKING_SPEED: f32 = 0.25;

/// It wakes, too, if a pin of cloth that carries it moves this fast (m/s). Ends that are tied to other bodies are pins, and creep with them.
const WAKING_SPEED_OF_PINS: f32 = 0.02;

/// The part of each step in the mean of a load.
const LOAD_PART: f32 = 0.1;
