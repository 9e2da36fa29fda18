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
    /// The body that is held; none before it has been built.
    #[serde(skip)]
    held: Option<Entity>,
    /// Where the particle was; none before.
    from: Option<Vector>,
}

impl DragUnderWay {
    /// The drag that an action asks for, if it asks for one.
    pub fn new(action: &Action, began: f64) -> Option<Self> {
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
            held: None,
            from: None,
        })
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
            if drag.held.is_none()
                && let Some((body, from)) = self.take_hold(world, drag)
            {
                (drag.held, drag.from) = (Some(body), drag.from.or(Some(from)));
            }
            let (Some(body), Some(from)) = (drag.held, drag.from) else {
                return self.stage.contains(&drag.of);
            };
            let since = time - drag.began;
            let is_over = since > drag.end() + 1e-9;
            let target = from.get() + drag.way(from.get(), since);
            let Ok(mut body) = world.get_entity_mut(body) else { return false };
            if is_over {
                body.remove::<Grab>();
            } else if let Some(mut grab) = body.get_mut::<Grab>() {
                grab.pull_to(target);
            }
            !is_over
        });
        self.drags = drags;
    }

    fn take_hold(&self, world: &mut World, drag: &DragUnderWay) -> Option<(Entity, Vector)> {
        let all = points::particles(world, &self.stage, &drag.of)?;
        let (body, index) = points::particle_at(world, &drag.point, &all)?;
        // Of what was restored the hand has hold already.
        if drag.from.is_none() || world.get::<Grab>(body).is_none() {
            let mut grab = Grab::new(world.get::<Particles>(body)?, index, drag.radius.max(1e-3));
            if let Some(force) = drag.greatest_force {
                grab = grab.with_greatest_force(force.get());
            }
            world.entity_mut(body).insert(grab);
        }
        Some((body, Vector::known(world.get::<Grab>(body)?.target()?)))
    }
}
