//! Particles dragged along paths.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use serde::{Deserialize, Serialize};

use super::ScenePlay;
use super::points;
use crate::scene::{Action, Point, Positive, Seconds, Vector};

/// A drag on its way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DragUnderWay {
    of: String,
    point: Point,
    radius: f32,
    path: Vec<(Seconds, Vector)>,
    is_absolute: bool,
    greatest_force: Option<Positive>,
    began: f64,
    /// The number of its hand, by which it is found on whatever piece it holds.
    hand: u64,
    /// Where the particle was; none before the hand has taken hold of it.
    from: Option<Vector>,
}

/// The least number of a hand of a script: pointers and games count from 0.
const FIRST_HAND: u64 = 1 << 32;

impl DragUnderWay {
    /// The drag that an action asks for, if it asks for one.
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

    /// The way of the hand `time` seconds after it took hold at `start`.
    fn way(&self, start: Vec3, time: f64) -> Vec3 {
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
}

impl ScenePlay {
    /// Takes hold, pulls to where the path is at `time`, and lets go at its end.
    pub(super) fn drag(&mut self, world: &mut World, time: f64) {
        let mut drags = core::mem::take(&mut self.drags);
        drags.retain_mut(|drag| {
            if drag.from.is_none() {
                drag.from = self.take_hold(world, drag);
            }
            let Some(from) = drag.from else { return self.stage.contains(&drag.of) };
            let since = time - drag.began;
            let is_over = since > drag.end() + 1e-9;
            let target = from.get() + drag.way(from.get(), since);
            // A piece may have come off with it, so that it holds two.
            let mut holds = false;
            let mut empty = Vec::new();
            for (body, mut grab) in world.query::<(Entity, &mut Grab)>().iter_mut(world) {
                let Some(hand) = grab.hand_mut(drag.hand) else { continue };
                hand.target = target;
                holds = true;
                if is_over {
                    empty.extend(grab.let_go(drag.hand).then_some(body));
                }
            }
            for body in empty {
                world.entity_mut(body).remove::<Grab>();
            }
            holds && !is_over
        });
        self.drags = drags;
    }

    /// Has the hand of a drag take hold, and tells where.
    fn take_hold(&self, world: &mut World, drag: &DragUnderWay) -> Option<Vector> {
        let all = points::particles(world, &self.stage, &drag.of)?;
        let (body, index) = points::particle_at(world, &drag.point, &all)?;
        let mut hand = Hand::new(world.get::<Particles>(body)?, index, drag.radius.max(1e-3));
        hand.id = drag.hand;
        if let Some(force) = drag.greatest_force {
            hand.greatest_force = force.get();
        }
        let from = Vector::known(hand.target);
        hand.hold(&mut world.entity_mut(body));
        Some(from)
    }
}
