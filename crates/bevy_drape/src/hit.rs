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

/// Pairs (ball, other) that touch, this step and the last, so that a lasting touch is one hit.
#[derive(Resource, Default)]
pub(crate) struct Touching {
    before: Vec<(Entity, Entity)>,
    now: Vec<(Entity, Entity)>,
}

impl Touching {
    /// Starts a new step. Balls that are at rest, as `is_resting` tells, go on touching what they touch.
    pub fn begin_step(&mut self, is_resting: impl Fn(Entity) -> bool) {
        core::mem::swap(&mut self.before, &mut self.now);
        self.before.sort_unstable();
        self.now.clear();
        self.now.extend(self.before.iter().filter(|(ball, _)| is_resting(*ball)));
    }

    /// Notes a touch; true if it is a new one.
    pub fn note(&mut self, ball: Entity, other: Entity) -> bool {
        self.now.push((ball, other));
        self.before.binary_search(&(ball, other)).is_err()
    }
}
