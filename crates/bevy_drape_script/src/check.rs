//! Checks of a scene as a whole: what is named exists, and is what it has to be.

mod body;
mod event;
mod probe;

use std::collections::BTreeMap;

use crate::SceneError;
use crate::scene::{Action, Body, Motion, Named, Point, SceneScript, Turn, whole};
use crate::suggest::unknown;

/// Checks what no field can know by itself.
///
/// # Errors
/// [`SceneError`] with the path of the first field that is wrong.
pub(crate) fn check(script: &SceneScript) -> Result<(), SceneError> {
    let checker = Checker { script, counts: particle_counts(script)? };
    checker.names()?;
    checker.bodies()?;
    checker.obstacles()?;
    for (name, zone) in script.winds.iter() {
        turn(&format!("winds.{name}.turn"), &zone.turn)?;
    }
    for (name, cannon) in script.cannons.iter() {
        turn(&format!("cannons.{name}.turn"), &cannon.turn)?;
    }
    for (index, event) in script.timeline.iter().enumerate() {
        checker.event(&format!("timeline[{index}]"), event)?;
    }
    for (index, expectation) in script.expectations.iter().enumerate() {
        let field = format!("expectations[{index}]");
        checker.when(&field, &expectation.when)?;
        checker.since(&field, &expectation.probe, &expectation.when)?;
        checker.probe(&field, &expectation.probe, &expectation.expect)?;
    }
    Ok(())
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// So many particles.
    Particles(u32),
    Balls,
    Obstacle,
    DynamicObstacle,
    Wind,
    Cannon,
}

struct Checker<'a> {
    script: &'a SceneScript,
    /// How many particles the bodies have that are made of meshes.
    counts: BTreeMap<&'a str, u32>,
}

/// Makes all bodies of meshes, which tells whether they can be made, and how many particles they have.
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

fn fail<T>(field: &str, problem: impl core::fmt::Display) -> Result<T, SceneError> {
    Err(SceneError::of_field(field, problem))
}

fn turn(field: &str, turn: &Turn) -> Result<(), SceneError> {
    if turn.axis.length_squared() > 0.0 {
        Ok(())
    } else {
        fail(&format!("{field}.axis"), "expected an axis with a length, found (0, 0, 0)")
    }
}

impl Checker<'_> {
    fn kind(&self, name: &str) -> Option<Kind> {
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
            // A piece has no more particles than the whole had, but for those that were split.
            whole @ Kind::Particles(_) if is_numbered && self.can_be_cut(group) => Some(whole),
            _ => None,
        }
    }

    fn can_be_cut(&self, name: &str) -> bool {
        self.script.bodies.get(whole(name)).is_some_and(Body::can_be_cut)
    }

    fn known(&self, field: &str, name: &str) -> Result<Kind, SceneError> {
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

    fn keys<T>(&self, named: &Named<T>) -> Vec<String> {
        named.keys().cloned().collect()
    }

    fn names(&self) -> Result<(), SceneError> {
        let bodies = &self.script.bodies;
        let obstacles = &self.script.obstacles;
        if let Some(name) = obstacles.keys().find(|name| bodies.contains_key(*name)) {
            return fail(&format!("obstacles.{name}"), format!("a body is called `{name}` already"));
        }
        let winds = &self.script.winds;
        let is_taken = |name: &&String| bodies.contains_key(*name) || obstacles.contains_key(*name);
        if let Some(name) = winds.keys().find(is_taken) {
            return fail(&format!("winds.{name}"), format!("something else is called `{name}` already"));
        }
        let is_taken = |name: &&String| is_taken(name) || winds.contains_key(*name);
        if let Some(name) = self.script.cannons.keys().find(is_taken) {
            return fail(&format!("cannons.{name}"), format!("something else is called `{name}` already"));
        }
        Ok(())
    }

    /// The longest that the scene may run, in seconds: its timeline may change that.
    fn greatest_duration(&self) -> f64 {
        let set = self.script.timeline.iter().filter_map(|event| match &event.action {
            Action::Set(path, value) if path == "settings.duration" => value.as_str().parse().ok(),
            _ => None,
        });
        set.fold(self.script.settings.duration.get(), f64::max)
    }

    /// Whether the scene comes to this time at all.
    fn within_duration(&self, field: &str, time: f64) -> Result<(), SceneError> {
        let (duration, dt) = (self.greatest_duration(), self.script.settings.dt.get());
        if time <= duration + 0.5 * dt {
            Ok(())
        } else {
            fail(field, format!("expected a time up to {duration} s, when the scene ends, found {time}"))
        }
    }
}

fn in_range(field: &str, index: u32, count: u32) -> Result<(), SceneError> {
    if index < count {
        Ok(())
    } else {
        fail(field, format!("expected a number below {count}, the number of particles, found {index}"))
    }
}

fn point(field: &str, point: &Point, kind: Kind) -> Result<(), SceneError> {
    match (point, kind) {
        (Point::Centre, _) | (Point::First | Point::Middle | Point::Last, Kind::Particles(_)) => Ok(()),
        (Point::Particle(index), Kind::Particles(count)) => in_range(field, *index, count),
        _ => fail(field, "expected `Centre`, as this has no particles"),
    }
}
