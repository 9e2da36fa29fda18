//! What balls hit.

use bevy::prelude::*;

/// What a ball has hit.
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

/// Sent in the step in which a ball begins to touch something.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BallHit {
    /// The ball.
    pub projectile: Entity,
    /// What it hit.
    pub target: Entity,
    /// The kind of what it hit.
    pub kind: HitTarget,
    /// Simulated time of the first touch in seconds, interpolated within the step.
    pub time: f64,
    /// The ball's centre at that time.
    pub ball_position: Vec3,
    /// The ball's velocity before the hit, in m/s.
    pub ball_velocity: Vec3,
    /// Point of the target's surface.
    pub point: Vec3,
    /// Unit normal from the target towards the ball.
    pub normal: Vec3,
    /// Size of the normal impulse in this step, in newton seconds.
    pub impulse: f32,
}

/// Time in seconds for which two must have been apart before they can touch anew. A ball that slides down a curtain
/// loses it for moments.
pub(crate) const APART: f64 = 0.1;

/// Pairs (ball, other) that touch or have just done so, in order, so that a lasting touch is one hit.
#[derive(Resource, Default)]
pub(crate) struct Touching(Vec<Touch>);

#[derive(Clone, Copy)]
struct Touch {
    pair: (Entity, Entity),
    /// Simulated time in seconds until which it lasts.
    until: f64,
}

impl Touching {
    /// All pairs, and the simulated times in seconds until which they touch.
    pub fn iter(&self) -> impl Iterator<Item = ((Entity, Entity), f64)> + '_ {
        self.0.iter().map(|touch| (touch.pair, touch.until))
    }

    /// Knows these instead of all others.
    pub fn replace(&mut self, touches: Vec<((Entity, Entity), f64)>) {
        self.0 = touches.into_iter().map(|(pair, until)| Touch { pair, until }).collect();
        self.0.sort_unstable_by_key(|touch| touch.pair);
    }

    /// Forgets the touches that ended before `now`. Balls at rest, as `is_resting` tells, go on touching.
    pub fn begin_step(&mut self, now: f64, is_resting: impl Fn(Entity) -> bool) {
        for touch in &mut self.0 {
            if is_resting(touch.pair.0) {
                touch.until = now + APART;
            }
        }
        self.0.retain(|touch| touch.until > now);
    }

    /// Notes a touch in the step that starts `now`; true if it is a new one.
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
