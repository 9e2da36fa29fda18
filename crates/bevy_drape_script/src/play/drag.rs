//! Particles dragged along paths.

use bevy::prelude::*;
use bevy_drape::attach::{Grab, Hand};
use bevy_drape::prelude::*;
use serde::{Deserialize, Serialize};

use super::points;
use super::scene_entities::SceneEntities;
use crate::scene::{Action, Point, Positive, Seconds, Vector};

/// A drag under way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Drag {
    of: String,
    point: Point,
    radius: f32,
    path: Vec<(Seconds, Vector)>,
    is_absolute: bool,
    greatest_force: Option<Positive>,
    began: f64,
    /// The number of its hand, which finds it on whatever piece it holds.
    hand: u64,
    /// The position of the particle when the hand took hold of it; none before.
    from: Option<Vector>,
}

/// The least number of a script's hand: pointers and games count theirs from 0.
const FIRST_HAND: u64 = 1 << 32;

impl Drag {
    /// The drag of a `Drag` action that begins at `began`, in seconds; none for other actions.
    pub fn new(action: &Action, began: f64, hand: u64) -> Option<Self> {
        let Action::Drag { of, point, radius, path, absolute, greatest_force } = action.clone() else {
            return None;
        };
        Some(Self {
            of,
            point,
            radius: radius.get(),
            path,
            is_absolute: absolute,
            greatest_force,
            began,
            hand,
            from: None,
        })
    }

    /// The number of a hand that none of `drags` has.
    pub fn free_hand(drags: &[Self]) -> u64 {
        drags.iter().map(|drag| drag.hand + 1).fold(FIRST_HAND, u64::max)
    }

    /// The displacement of the hand `time` seconds after it took hold at `start`.
    fn displacement(&self, start: Vec3, time: f64) -> Vec3 {
        let next = self.path.iter().position(|(key, _)| key.get() > time);
        let (from, to) = match next {
            Some(0) => ((0.0, Vec3::ZERO), self.key(start, 0)),
            Some(next) => (self.key(start, next - 1), self.key(start, next)),
            None => return self.path.len().checked_sub(1).map_or(Vec3::ZERO, |last| self.key(start, last).1),
        };
        from.1.lerp(to.1, ((time - from.0) / (to.0 - from.0)) as f32)
    }

    fn key(&self, start: Vec3, index: usize) -> (f64, Vec3) {
        let (time, place) = self.path[index];
        (time.get(), if self.is_absolute { place.get() - start } else { place.get() })
    }

    fn end(&self) -> f64 {
        self.path.last().map_or(0.0, |(time, _)| time.get())
    }

    /// Takes hold if it has not yet, pulls to the position on the path at `time`, and lets go at its end. Returns true
    /// while it goes on.
    pub fn advance(&mut self, world: &mut World, entities: &SceneEntities, time: f64) -> bool {
        if self.from.is_none() {
            self.from = self.take_hold(world, entities);
        }
        let Some(from) = self.from else { return entities.contains(&self.of) };
        let since = time - self.began;
        let is_over = since > self.end() + 1e-9;
        let target = from.get() + self.displacement(from.get(), since);
        // A piece may have come off with the hand, so that it holds two bodies.
        let mut holds = false;
        let mut empty = Vec::new();
        for (body, mut grab) in world.query::<(Entity, &mut Grab)>().iter_mut(world) {
            let Some(hand) = grab.hand_mut(self.hand) else { continue };
            hand.target = target;
            holds = true;
            if is_over {
                empty.extend(grab.let_go(self.hand).then_some(body));
            }
        }
        for body in empty {
            world.entity_mut(body).remove::<Grab>();
        }
        holds && !is_over
    }

    /// Has the hand take hold of the particle. Returns the position of the particle.
    fn take_hold(&self, world: &mut World, entities: &SceneEntities) -> Option<Vector> {
        let all = points::particles(world, entities, &self.of)?;
        let (body, index) = points::particle_at(world, &self.point, &all)?;
        let mut hand = Hand::new(world.get::<Particles>(body)?, index, self.radius.max(1e-3));
        hand.id = self.hand;
        if let Some(force) = self.greatest_force {
            hand.greatest_force = force.get();
        }
        let from = Vector::known(hand.target);
        hand.hold(&mut world.entity_mut(body));
        Some(from)
    }
}
