//! Particles dragged along paths.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use serde::{Deserialize, Serialize};

use super::ScenePlay;
use super::points;
use crate::scene::{NonNegative, Point, Seconds, Vector};

/// A drag on its way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DragUnderWay {
    of: String,
    point: Point,
    radius: f32,
    path: Vec<(Seconds, Vector)>,
    began: f64,
    /// The body that is held; none before it has been built.
    #[serde(skip)]
    held: Option<Entity>,
    /// Where the particle was; none before.
    from: Option<Vector>,
}

impl DragUnderWay {
    pub fn new(of: &str, point: &Point, radius: NonNegative, path: &[(Seconds, Vector)], began: f64) -> Self {
        Self {
            of: of.to_string(),
            point: point.clone(),
            radius: radius.get(),
            path: path.to_vec(),
            began,
            held: None,
            from: None,
        }
    }

    /// The way from the start, `time` seconds after it.
    fn way(&self, time: f64) -> Vec3 {
        let next = self.path.iter().position(|(key, _)| key.get() > time);
        let (from, to) = match next {
            Some(0) => ((0.0, Vec3::ZERO), self.key(0)),
            Some(next) => (self.key(next - 1), self.key(next)),
            None => return self.path.last().map_or(Vec3::ZERO, |(_, way)| way.get()),
        };
        from.1.lerp(to.1, ((time - from.0) / (to.0 - from.0)) as f32)
    }

    fn key(&self, index: usize) -> (f64, Vec3) {
        let (time, way) = self.path[index];
        (time.get(), way.get())
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
            let target = from.get() + drag.way(since);
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
            let grab = Grab::new(world.get::<Particles>(body)?, index, drag.radius.max(1e-3));
            world.entity_mut(body).insert(grab);
        }
        Some((body, Vector::known(world.get::<Grab>(body)?.target()?)))
    }
}
