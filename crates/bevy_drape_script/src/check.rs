//! Checks of a scene as a whole: what is named exists, and is what it has to be.

use std::collections::BTreeMap;

use crate::SceneError;
use crate::overriding;
use crate::scene::{
    Action, Axis, Body, Event, Expected, Motion, Names, Pins, Point, Probe, Rig, SceneScript, Selection,
    SelfContact, Turn, When,
};
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
        checker.since(&field, &expectation.probe)?;
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

/// Whether the faces of a body are closed, so that it has a volume.
fn is_closed(script: &SceneScript, name: &str) -> bool {
    match script.bodies.get(name) {
        Some(Body::ClothMesh(cloth)) => {
            cloth.build(&script.meshes).is_ok_and(|built| built.topology.rest_volume().is_some())
        }
        body => matches!(body, Some(Body::SoftBody(_))),
    }
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
        let whole = name.split('#').next().unwrap_or(name);
        self.script.bodies.get(whole).is_some_and(Body::can_be_cut)
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

    fn keys<T>(&self, named: &crate::scene::Named<T>) -> Vec<String> {
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

    fn material(&self, field: &str, material: Option<&str>) -> Result<(), SceneError> {
        match material {
            Some(name) if !self.script.materials.contains_key(name) => {
                let known = self.keys(&self.script.materials);
                let problem = unknown(&format!("no material is called `{name}`"), name, &known);
                fail(&format!("{field}.material"), problem)
            }
            _ => Ok(()),
        }
    }

    fn bodies(&self) -> Result<(), SceneError> {
        for (name, body) in self.script.bodies.iter() {
            let field = format!("bodies.{name}");
            self.material(&field, body.material())?;
            if let Some((_, own)) = body.place() {
                turn(&format!("{field}.turn"), own)?;
            }
            match body {
                Body::Cloth(cloth) => {
                    if let Pins::Indices(indices) = &cloth.pins {
                        let count = cloth.particles.0.get() * cloth.particles.1.get();
                        for (i, &index) in indices.iter().enumerate() {
                            in_range(&format!("{field}.pins[{i}]"), index, count)?;
                        }
                    }
                }
                Body::Rope(rope) if rope.start == rope.end => {
                    return fail(&format!("{field}.end"), "expected another place than that of `start`");
                }
                Body::Rig(rig) => self.rig(&field, rig)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn rig(&self, field: &str, rig: &Rig) -> Result<(), SceneError> {
        if rig.particles.is_empty() {
            return fail(&format!("{field}.particles"), "expected one particle at least, found none");
        }
        for (index, stick) in rig.sticks.iter().enumerate() {
            for (end, name) in [("a", &stick.a), ("b", &stick.b)] {
                if !rig.particles.contains_key(name) {
                    let known = self.keys(&rig.particles);
                    let problem = unknown(&format!("no particle is called `{name}`"), name, &known);
                    return fail(&format!("{field}.sticks[{index}].{end}"), problem);
                }
            }
            if stick.a == stick.b {
                return fail(&format!("{field}.sticks[{index}].b"), "expected another particle than `a`");
            }
        }
        Ok(())
    }

    fn obstacles(&self) -> Result<(), SceneError> {
        for (name, obstacle) in self.script.obstacles.iter() {
            let field = format!("obstacles.{name}");
            self.material(&field, obstacle.material.as_deref())?;
            turn(&format!("{field}.turn"), &obstacle.turn)?;
            if let Err(error) = obstacle.shape.build() {
                return fail(&format!("{field}.shape"), error);
            }
            match &obstacle.motion {
                Motion::Static | Motion::Steady(_) => {}
                Motion::Keyframes(keyframes) => {
                    let field = format!("{field}.motion.keys");
                    if keyframes.keys.is_empty() {
                        return fail(&field, "expected one key at least, found none");
                    }
                    for (index, pair) in keyframes.keys.windows(2).enumerate() {
                        if pair[1].time <= pair[0].time {
                            let field = format!("{field}[{}].time", index + 1);
                            let problem = format!("expected a time after {} s", pair[0].time.get());
                            return fail(&field, problem);
                        }
                    }
                    for (index, key) in keyframes.keys.iter().enumerate() {
                        turn(&format!("{field}[{index}].turn"), &key.turn)?;
                    }
                }
                Motion::Dynamic(dynamic) => {
                    if dynamic.component(&obstacle.shape).is_none() {
                        let problem =
                            "expected moments of inertia, as this shape is neither a sphere nor a cuboid";
                        return fail(&format!("{field}.motion.inertia"), problem);
                    }
                }
            }
        }
        Ok(())
    }

    fn event(&self, field: &str, event: &Event) -> Result<(), SceneError> {
        match (&event.at, &event.when) {
            (Some(at), None) => self.within_duration(&format!("{field}.at"), at.get())?,
            (None, Some(trigger)) => {
                let (probe, expect) = trigger.as_probe();
                self.probe(&format!("{field}.when"), &probe, &expect)?;
            }
            _ => return fail(field, "expected either `at` or `when`"),
        }
        self.action(&format!("{field}.do"), &event.action)
    }

    fn action(&self, field: &str, action: &Action) -> Result<(), SceneError> {
        if let Action::Picture(camera) = action {
            return if self.script.cameras.contains_key(camera) {
                Ok(())
            } else {
                let known = self.keys(&self.script.cameras);
                fail(field, unknown(&format!("no camera is called `{camera}`"), camera, &known))
            };
        }
        let mut kind = Kind::Obstacle;
        for name in action.names() {
            kind = self.known(field, name)?;
        }
        match action {
            Action::Fire(cannon) | Action::Aim { cannon, .. } if kind != Kind::Cannon => {
                fail(field, format!("expected a cannon, and `{cannon}` is none"))
            }
            Action::Pin { of, particles } | Action::Unpin { of, particles } => match kind {
                Kind::Particles(count) => selection(field, particles, count),
                _ => fail(field, format!("expected a body of particles, and `{of}` is none")),
            },
            Action::Push { of, particles, .. } => match kind {
                Kind::Particles(count) => selection(field, particles, count),
                Kind::Balls | Kind::Cannon | Kind::DynamicObstacle => Ok(()),
                Kind::Obstacle => fail(field, format!("`{of}` is an obstacle that nothing pushes")),
                Kind::Wind => fail(field, format!("`{of}` is a wind, which nothing pushes")),
            },
            Action::Drag { of, point: dragged, path, .. } => {
                let Kind::Particles(count) = kind else {
                    return fail(field, format!("expected a body of particles, and `{of}` is none"));
                };
                if *dragged == Point::Centre {
                    return fail(&format!("{field}.point"), "expected a particle, as the centre is none");
                }
                point(&format!("{field}.point"), dragged, Kind::Particles(count))?;
                if path.is_empty() {
                    return fail(&format!("{field}.path"), "expected one place at least, found none");
                }
                match path.windows(2).position(|pair| pair[1].0 <= pair[0].0) {
                    Some(index) => {
                        let problem = format!("expected a time after {} s", path[index].0.get());
                        fail(&format!("{field}.path[{}]", index + 1), problem)
                    }
                    None => Ok(()),
                }
            }
            Action::Cut { of, .. } => match of.iter().find(|name| !self.can_be_cut(name)) {
                Some(name) => fail(
                    &format!("{field}.of"),
                    format!("expected a cloth, rope or soft ball, and `{name}` is none"),
                ),
                None => Ok(()),
            },
            Action::Spawn(name) | Action::Despawn(name) if name.contains('#') => {
                fail(field, format!("expected the name of something whole, and `{name}` is a part of it"))
            }
            Action::Set(path, value) => overriding::replaced(self.script, path, value)
                .map(|_| ())
                .map_err(|error| SceneError::of_field(field, format!("{}: {}", error.field, error.problem))),
            _ => Ok(()),
        }
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

    fn when(&self, field: &str, when: &When) -> Result<(), SceneError> {
        let field = format!("{field}.when");
        match when {
            When::End | When::Always => Ok(()),
            When::At(time) => self.within_duration(&field, time.get()),
            When::Eventually { within, after } => {
                if let Some(within) = within {
                    self.within_duration(&format!("{field}.within"), within.get())?;
                }
                let Some(after) = after else { return Ok(()) };
                if let Some(within) = within.filter(|within| after > within) {
                    let (from, to) = (after.get(), within.get());
                    let problem =
                        format!("expected a time up to {to} s, by which it has to hold, found {from}");
                    return fail(&format!("{field}.after"), problem);
                }
                self.within_duration(&format!("{field}.after"), after.get())
            }
            When::During(from, to) if from > to => {
                let (from, to) = (from.get(), to.get());
                fail(&field, format!("expected the earlier time first, found {from} s, then {to} s"))
            }
            When::During(_, to) => self.within_duration(&field, to.get()),
        }
    }

    fn since(&self, field: &str, probe: &Probe) -> Result<(), SceneError> {
        match probe.since() {
            Some(time) => self.within_duration(&format!("{field}.probe.since"), time.get()),
            None => Ok(()),
        }
    }

    /// Whether contacts between these are told at all; an empty list stands for everything.
    fn is_told_of_contacts(&self, of: &Names, on: &Names) -> bool {
        let SceneScript { bodies, obstacles, cannons, .. } = self.script;
        if of.is_empty() || on.is_empty() {
            return bodies.iter().any(|(_, body)| body.tells_contacts())
                || obstacles.iter().any(|(_, obstacle)| obstacle.contacts)
                || cannons.iter().any(|(_, cannon)| cannon.ball.contacts);
        }
        of.iter().chain(on.iter()).any(|name| {
            let whole = name.split('#').next().unwrap_or(name);
            bodies.get(whole).is_some_and(Body::tells_contacts)
                || obstacles.get(whole).is_some_and(|obstacle| obstacle.contacts)
                || cannons.get(whole).is_some_and(|cannon| cannon.ball.contacts)
        })
    }

    /// Of two bodies of particles that are to touch each other, one that has no contacts with its like.
    fn does_not_touch_its_like<'n>(&self, of: &'n Names, on: &'n Names) -> Option<&'n str> {
        let whole = |name: &str| name.split('#').next().unwrap_or(name).to_string();
        let is_soft =
            |name: &String| self.script.bodies.get(&whole(name)).is_some_and(|body| body.solver().is_some());
        // Where one of many may be something else, nobody knows.
        if of.is_empty() || on.is_empty() || !of.iter().chain(on.iter()).all(is_soft) {
            return None;
        }
        let has_contact = |name: &String| {
            let solver = self.script.bodies.get(&whole(name)).and_then(Body::solver);
            let own = solver.and_then(|solver| solver.self_contact);
            let contact = own.or(self.script.settings.solver.self_contact).unwrap_or(SelfContact::Off);
            contact != SelfContact::Off || self.is_set_later(&whole(name))
        };
        of.iter().chain(on.iter()).find(|name| !has_contact(name)).map(String::as_str)
    }

    /// Whether the timeline changes how a body is solved.
    fn is_set_later(&self, name: &str) -> bool {
        self.script.timeline.iter().any(|event| match &event.action {
            Action::Set(path, _) => path.contains("self_contact") || path.starts_with(name),
            _ => false,
        })
    }

    fn probe(&self, field: &str, probe: &Probe, expect: &Expected) -> Result<(), SceneError> {
        let on_probe = format!("{field}.probe");
        let mut kinds = Vec::new();
        for name in probe.names() {
            kinds.push(self.known(&on_probe, name)?);
        }
        if kinds.contains(&Kind::Wind) {
            return fail(
                &on_probe,
                "expected something that moves, and a wind is felt only by what it moves",
            );
        }
        let is_word = matches!(probe, Probe::Activity { .. } | Probe::StateHash { .. });
        match (is_word, expect) {
            (true, Expected::Is(word)) => {
                let known = ["Active", "Resting", "Frozen", "Culled"];
                if matches!(probe, Probe::Activity { .. }) && !known.contains(&word.as_str()) {
                    let what = format!("an activity is no `{word}`");
                    return fail(&format!("{field}.expect"), unknown(&what, word, &known));
                }
            }
            (_, Expected::Reported) => {}
            (true, _) => {
                return fail(
                    &format!("{field}.expect"),
                    "expected `Is(\"..\")`, as this probe measures a word",
                );
            }
            (false, Expected::Is(_)) => {
                return fail(&format!("{field}.expect"), "expected numbers, as this probe measures one");
            }
            (false, Expected::Between(least, greatest)) if least > greatest => {
                return fail(&format!("{field}.expect"), "expected the lesser number first");
            }
            _ => {}
        }
        match probe {
            Probe::Position { of, point: of_point, .. } | Probe::Velocity { of, point: of_point, .. } => {
                if of.len() != 1 {
                    return fail(&format!("{on_probe}.of"), format!("expected one name, found {}", of.len()));
                }
                point(&format!("{on_probe}.point"), of_point, kinds[0])
            }
            Probe::Distance { from, to } => {
                point(&format!("{on_probe}.from.point"), &from.point, kinds[0])?;
                point(&format!("{on_probe}.to.point"), &to.point, kinds[1])
            }
            Probe::Least { axis: Axis::Length, .. } | Probe::Greatest { axis: Axis::Length, .. } => {
                fail(&format!("{on_probe}.axis"), "expected X, Y or Z")
            }
            Probe::Extent { of, .. } | Probe::Least { of, .. } | Probe::Greatest { of, .. }
                if kinds.iter().any(|kind| matches!(kind, Kind::Obstacle | Kind::DynamicObstacle)) =>
            {
                let problem = "expected a body or balls: an obstacle is as large as its `shape` says";
                fail(&format!("{on_probe}.of"), format!("{problem}, and its `Position` is measured ({of})"))
            }
            Probe::Hits { of, .. }
                if kinds[..of.len()].iter().any(|kind| !matches!(kind, Kind::Balls | Kind::Cannon)) =>
            {
                fail(
                    &format!("{on_probe}.of"),
                    "expected balls or a cannon; what others touch `Contacts` tells",
                )
            }
            Probe::Contacts { of, on } | Probe::Touching { of, on } if !self.is_told_of_contacts(of, on) => {
                fail(&on_probe, "nothing here tells its contacts: give one of the two `contacts: true`")
            }
            Probe::Contacts { of, on } | Probe::Touching { of, on }
                if let Some(name) = self.does_not_touch_its_like(of, on) =>
            {
                let problem = "does not touch other cloths and ropes: give both `self_contact: Particles` in their `solver`";
                fail(&on_probe, format!("`{name}` {problem}"))
            }
            Probe::Pieces { of } | Probe::Torn { of } if of.iter().any(|name| !self.can_be_cut(name)) => {
                fail(&format!("{on_probe}.of"), "expected a cloth, rope or soft ball, as nothing else tears")
            }
            Probe::Volume { of } if !of.iter().all(|name| is_closed(self.script, name)) => fail(
                &format!("{on_probe}.of"),
                "expected a body of a closed mesh, as nothing else has a volume",
            ),
            Probe::Stretch { .. } if kinds.iter().any(|kind| !matches!(kind, Kind::Particles(_))) => {
                fail(&format!("{on_probe}.of"), "expected a cloth, rope or rig, as nothing else has sticks")
            }
            _ => Ok(()),
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

fn selection(field: &str, particles: &Selection, count: u32) -> Result<(), SceneError> {
    match particles {
        Selection::All | Selection::Pinned => Ok(()),
        Selection::Particles(indices) => {
            indices.iter().try_for_each(|&index| in_range(&format!("{field}.particles"), index, count))
        }
    }
}

fn point(field: &str, point: &Point, kind: Kind) -> Result<(), SceneError> {
    match (point, kind) {
        (Point::Centre, _) | (Point::First | Point::Middle | Point::Last, Kind::Particles(_)) => Ok(()),
        (Point::Particle(index), Kind::Particles(count)) => in_range(field, *index, count),
        _ => fail(field, "expected `Centre`, as this has no particles"),
    }
}
