//! Entities that can be measured and pushed.

use bevy::prelude::*;
use bevy_drape::rig::InRig;

use super::named_entity::{NamedEntity, is_ball, is_body};

/// Bodies of particles, balls and obstacles that exist in the world.
#[derive(Debug, Default)]
pub(super) struct SimulatedEntities {
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    pub obstacles: Vec<Entity>,
}

impl SimulatedEntities {
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty() && self.balls.is_empty() && self.obstacles.is_empty()
    }

    /// Adds all that `named` has in `world`.
    pub fn add(&mut self, world: &World, named: &NamedEntity) {
        match named {
            NamedEntity::Body { body, pieces } => {
                let all = core::iter::once(body).chain(pieces).copied();
                self.bodies.extend(all.filter(|&body| is_body(world, body)));
            }
            NamedEntity::Rig { particles, .. } => {
                for body in particles.iter().filter_map(|&particle| world.get::<InRig>(particle)) {
                    if !self.bodies.contains(&body.body) {
                        self.bodies.push(body.body);
                    }
                }
            }
            NamedEntity::Balls(balls) | NamedEntity::Cannon { balls, .. } => {
                self.balls.extend(balls.iter().copied().filter(|&ball| is_ball(world, ball)));
            }
            NamedEntity::Obstacle(obstacle) => self.obstacles.push(*obstacle),
            NamedEntity::Wind(_) => {}
        }
    }
}
