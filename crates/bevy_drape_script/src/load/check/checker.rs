//! Looks up the names of a scene, for all checks.

use std::collections::BTreeMap;

use crate::scene::{Action, Body, Motion, Named, Point, SceneScript, Turn, whole};
use crate::text::{SceneError, unknown};

/// The kind of thing that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A body of so many particles.
    Particles(u32),
    Balls,
    Obstacle,
    DynamicObstacle,
    Wind,
    Cannon,
}

pub(super) struct Checker<'a> {
    pub script: &'a SceneScript,
    /// The numbers of particles of the bodies that are made of meshes.
    counts: BTreeMap<&'a str, u32>,
}

impl<'a> Checker<'a> {
    pub fn new(script: &'a SceneScript) -> Result<Self, SceneError> {
        Ok(Self { script, counts: particle_counts(script)? })
    }

    pub fn kind(&self, name: &str) -> Option<Kind> {
        if let Some(body) = self.script.bodies.get(name) {
            return Some(match body {
                Body::Cloth(cloth) => Kind::Particles(cloth.particles.0.get() * cloth.particles.1.get()),
                Body::Rope(rope) => Kind::Particles(rope.particles.get()),
                Body::SoftBall(ball) => Kind::Particles(ball.particle_count()),
                Body::ClothMesh(_) | Body::SoftBody(_) => {
                    Kind::Particles(self.counts.get(name).copied().unwrap_or_default())
                }
                Body::Rig(rig) => Kind::Particles(rig.particles.len() as u32),
                Body::Balls(_) => Kind::Balls,
            });
        }
        if let Some(obstacle) = self.script.obstacles.get(name) {
            let is_dynamic = matches!(obstacle.motion, Motion::Dynamic(_));
            return Some(if is_dynamic { Kind::DynamicObstacle } else { Kind::Obstacle });
        }
        if self.script.winds.contains_key(name) {
            return Some(Kind::Wind);
        }
        if self.script.cannons.contains_key(name) {
            return Some(Kind::Cannon);
        }
        let (group, number) = name.split_once('#')?;
        let is_numbered = number.parse().is_ok_and(|number: u32| number > 0);
        match self.kind(group)? {
            Kind::Cannon | Kind::Balls if is_numbered => Some(Kind::Balls),
            // A piece has no more particles than the whole body, apart from those that were split.
            whole @ Kind::Particles(_) if is_numbered && self.can_be_cut(group) => Some(whole),
            _ => None,
        }
    }

    pub fn can_be_cut(&self, name: &str) -> bool {
        self.script.bodies.get(whole(name)).is_some_and(Body::can_be_cut)
    }

    pub fn known(&self, field: &str, name: &str) -> Result<Kind, SceneError> {
        self.kind(name).map_or_else(
            || {
                let known = [
                    self.keys(&self.script.bodies),
                    self.keys(&self.script.obstacles),
                    self.keys(&self.script.winds),
                    self.keys(&self.script.cannons),
                ];
                fail(field, unknown(&format!("nothing is called `{name}`"), name, &known.concat()))
            },
            Ok,
        )
    }

    pub fn keys<T>(&self, named: &Named<T>) -> Vec<String> {
        named.keys().cloned().collect()
    }

    /// Checks that the material of a body or obstacle exists.
    pub fn material(&self, field: &str, material: Option<&str>) -> Result<(), SceneError> {
        match material {
            Some(name) if !self.script.materials.contains_key(name) => {
                let known = self.keys(&self.script.materials);
                let problem = unknown(&format!("no material is called `{name}`"), name, &known);
                fail(&format!("{field}.material"), problem)
            }
            _ => Ok(()),
        }
    }

    /// The longest duration of the scene in seconds, as its timeline may prolong it.
    pub fn greatest_duration(&self) -> f64 {
        let set = self.script.timeline.iter().filter_map(|event| match &event.action {
            Action::Set(path, value) if path == "settings.duration" => value.as_str().parse().ok(),
            _ => None,
        });
        set.fold(self.script.settings.duration.get(), f64::max)
    }

    /// Checks that the scene reaches `time`, in seconds.
    pub fn within_duration(&self, field: &str, time: f64) -> Result<(), SceneError> {
        let (duration, dt) = (self.greatest_duration(), self.script.settings.dt.get());
        if time <= duration + 0.5 * dt {
            Ok(())
        } else {
            fail(field, format!("expected a time up to {duration} s, when the scene ends, found {time}"))
        }
    }
}

/// Builds all bodies that are made of meshes, to find out if they can be built and how many particles they have.
fn particle_counts(script: &SceneScript) -> Result<BTreeMap<&str, u32>, SceneError> {
    let mut counts = BTreeMap::new();
    for (name, body) in script.bodies.iter() {
        let built = match body {
            Body::ClothMesh(cloth) => cloth.build(&script.meshes).map(|built| built.particles),
            Body::SoftBody(solid) => solid.build(&script.meshes).map(|built| built.particles),
            _ => continue,
        };
        match built {
            Ok(particles) => _ = counts.insert(name.as_str(), particles.len() as u32),
            Err(problem) => return fail(&format!("bodies.{name}.mesh"), problem),
        }
    }
    Ok(counts)
}

pub(super) fn fail<T>(field: &str, problem: impl core::fmt::Display) -> Result<T, SceneError> {
    Err(SceneError::of_field(field, problem))
}

pub(super) fn turn(field: &str, turn: &Turn) -> Result<(), SceneError> {
    if turn.axis.length_squared() > 0.0 {
        Ok(())
    } else {
        fail(&format!("{field}.axis"), "expected an axis with a length, found (0, 0, 0)")
    }
}

pub(super) fn in_range(field: &str, index: u32, count: u32) -> Result<(), SceneError> {
    if index < count {
        Ok(())
    } else {
        fail(field, format!("expected a number below {count}, the number of particles, found {index}"))
    }
}

pub(super) fn point(field: &str, point: &Point, kind: Kind) -> Result<(), SceneError> {
    match (point, kind) {
        (Point::Centre, _) | (Point::First | Point::Middle | Point::Last, Kind::Particles(_)) => Ok(()),
        (Point::Particle(index), Kind::Particles(count)) => in_range(field, *index, count),
        _ => fail(field, "expected `Centre`, as this has no particles"),
    }
}
