//! Hits of balls.

use bevy::prelude::*;

use crate::entity_events::EntityMessage;

/// Kind of entity that a ball hits.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Debug, Clone, PartialEq)]
pub enum HitTarget {
    /// A cloth, rope or rig.
    Body,
    /// Another ball.
    Projectile,
    /// An obstacle.
    Obstacle,
}

/// Written in the step in which a ball begins to touch something, and triggered on the ball.
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BallHit {
    /// The ball.
    #[event_target]
    pub projectile: Entity,
    /// The entity that it hit.
    pub target: Entity,
    /// The kind of that entity.
    pub kind: HitTarget,
    /// Simulated time in seconds of the first touch, interpolated within the step.
    pub time: f64,
    /// The ball's centre at that time.
    pub ball_position: Vec3,
    /// The ball's velocity before the hit, in m/s.
    pub ball_velocity: Vec3,
    /// Point on the target's surface.
    pub point: Vec3,
    /// Unit normal from the target towards the ball.
    pub normal: Vec3,
    /// Magnitude of the normal impulse in this step, in newton seconds.
    pub impulse: f32,
}

impl EntityMessage for BallHit {}

/// Time in seconds that two must be apart before a touch counts as new. A ball that slides down a curtain loses contact
/// for moments.
pub(crate) const APART: f64 = 0.1;

/// Sorted pairs (ball, other) that touch, or touched a moment ago, so that a lasting touch is one hit.
#[derive(Resource, Default)]
pub(crate) struct Touching(Vec<Touch>);

#[derive(Clone, Copy)]
struct Touch {
    pair: (Entity, Entity),
    /// Simulated time in seconds at which the touch ends unless they touch again.
    until: f64,
}

impl Touching {
    /// All pairs, and the simulated times in seconds at which their touches end.
    pub fn iter(&self) -> impl Iterator<Item = ((Entity, Entity), f64)> + '_ {
        self.0.iter().map(|touch| (touch.pair, touch.until))
    }

    /// Replaces all pairs.
    pub fn replace(&mut self, touches: Vec<((Entity, Entity), f64)>) {
        self.0 = touches.into_iter().map(|(pair, until)| Touch { pair, until }).collect();
        self.0.sort_unstable_by_key(|touch| touch.pair);
    }

    /// Forgets the touches that ended before `now`. Resting balls keep touching.
    pub fn begin_step(&mut self, now: f64, is_resting: impl Fn(Entity) -> bool) {
        for touch in &mut self.0 {
            if is_resting(touch.pair.0) {
                touch.until = now + APART;
            }
        }
        self.0.retain(|touch| touch.until > now);
    }

    /// Notes a touch in the step that starts `now`; true if it is new.
    pub fn note(&mut self, now: f64, ball: Entity, other: Entity) -> bool {
        let touch = Touch { pair: (ball, other), until: now + APART };
        match self.0.binary_search_by_key(&touch.pair, |known| known.pair) {
            Ok(known) => {
                self.0[known] = touch;
                false
            }
            Err(place) => {
                self.0.insert(place, touch);
                true
            }
        }
    }
}
