//! Checks of expectations: probes, and when they are evaluated.

use super::checker::{Checker, Kind, fail, point};
use crate::scene::{Action, Axis, Body, Expected, Names, Probe, SceneScript, SelfContact, When, whole};
use crate::text::{SceneError, unknown};

impl Checker<'_> {
    pub(super) fn when(&self, field: &str, when: &When) -> Result<(), SceneError> {
        let field = format!("{field}.when");
        match when {
            When::End | When::Always => Ok(()),
            When::At(time) if time.get() < 0.5 * self.script.settings.dt.get() => {
                let first = self.script.settings.dt.get();
                fail(&field, format!("expected {first} s or more: the first look is after the first step"))
            }
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

    pub(super) fn since(&self, field: &str, probe: &Probe, when: &When) -> Result<(), SceneError> {
        let Some(since) = probe.since() else { return Ok(()) };
        let on_since = format!("{field}.probe.since");
        self.within_duration(&on_since, since.get())?;
        let last = match when {
            When::At(at) => Some(at),
            When::During(_, to) => Some(to),
            When::Eventually { within, .. } => within.as_ref(),
            When::End | When::Always => None,
        };
        match last.filter(|last| since > **last) {
            Some(last) => {
                let (since, last) = (since.get(), last.get());
                fail(
                    &on_since,
                    format!("expected a time up to {last} s, when it is looked at last, found {since}"),
                )
            }
            None => Ok(()),
        }
    }

    pub(super) fn probe(&self, field: &str, probe: &Probe, expect: &Expected) -> Result<(), SceneError> {
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
        expected_type(field, probe, expect)?;
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
                fail(&format!("{on_probe}.of"), "expected balls or a cannon; use `Contacts` for others")
            }
            Probe::Contacts { of, on } | Probe::Touching { of, on } if !self.reports_contacts(of, on) => {
                fail(&on_probe, "no contacts are reported here: give one of the two `contacts: true`")
            }
            Probe::Contacts { of, on } | Probe::Touching { of, on }
                if let Some(name) = self.without_body_contact(of, on) =>
            {
                let problem =
                    "does not touch other cloths and ropes: give both `self_contact: On` in their `solver`";
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

    /// True if contacts between these are reported at all. An empty list stands for everything.
    fn reports_contacts(&self, of: &Names, on: &Names) -> bool {
        let SceneScript { bodies, obstacles, cannons, .. } = self.script;
        if of.is_empty() || on.is_empty() {
            return bodies.iter().any(|(_, body)| body.reports_contacts())
                || obstacles.iter().any(|(_, obstacle)| obstacle.contacts)
                || cannons.iter().any(|(_, cannon)| cannon.ball.contacts);
        }
        of.iter().chain(on.iter()).any(|name| {
            let whole = whole(name);
            bodies.get(whole).is_some_and(Body::reports_contacts)
                || obstacles.get(whole).is_some_and(|obstacle| obstacle.contacts)
                || cannons.get(whole).is_some_and(|cannon| cannon.ball.contacts)
        })
    }

    /// Of bodies of particles that are expected to touch each other, one that has no contacts with other bodies of
    /// particles.
    fn without_body_contact<'n>(&self, of: &'n Names, on: &'n Names) -> Option<&'n str> {
        let is_soft =
            |name: &String| self.script.bodies.get(whole(name)).is_some_and(|body| body.solver().is_some());
        // Lists with other things may be touched by those.
        if of.is_empty() || on.is_empty() || !of.iter().chain(on.iter()).all(is_soft) {
            return None;
        }
        let has_contact = |name: &String| {
            let solver = self.script.bodies.get(whole(name)).and_then(Body::solver);
            let own = solver.and_then(|solver| solver.self_contact);
            let contact = own.or(self.script.settings.solver.self_contact).unwrap_or(SelfContact::Off);
            contact != SelfContact::Off || self.is_set_later(whole(name))
        };
        of.iter().chain(on.iter()).find(|name| !has_contact(name)).map(String::as_str)
    }

    /// True if the timeline may change the body's self-contact.
    fn is_set_later(&self, name: &str) -> bool {
        self.script.timeline.iter().any(|event| match &event.action {
            Action::Set(path, _) => path.contains("self_contact") || path.starts_with(name),
            _ => false,
        })
    }
}

/// Checks that a word is expected of a probe that measures words, and numbers of all others.
fn expected_type(field: &str, probe: &Probe, expect: &Expected) -> Result<(), SceneError> {
    let on_expect = format!("{field}.expect");
    let is_word = matches!(probe, Probe::Activity { .. } | Probe::StateHash { .. });
    match (is_word, expect) {
        (true, Expected::Is(word)) => {
            let known = ["Active", "Resting", "Frozen", "Culled"];
            if matches!(probe, Probe::Activity { .. }) && !known.contains(&word.as_str()) {
                return fail(&on_expect, unknown(&format!("an activity is no `{word}`"), word, &known));
            }
            Ok(())
        }
        (_, Expected::Reported) => Ok(()),
        (true, _) => fail(&on_expect, "expected `Is(\"..\")`, as this probe measures a word"),
        (false, Expected::Is(_)) => fail(&on_expect, "expected numbers, as this probe measures one"),
        (false, Expected::Between(least, greatest)) if least > greatest => {
            fail(&on_expect, "expected the lesser number first")
        }
        _ => Ok(()),
    }
}

/// True if the faces of a body are closed, so that it has a volume.
fn is_closed(script: &SceneScript, name: &str) -> bool {
    match script.bodies.get(name) {
        Some(Body::ClothMesh(cloth)) => {
            cloth.build(&script.meshes).is_ok_and(|built| built.topology.rest_volume().is_some())
        }
        body => matches!(body, Some(Body::SoftBody(_))),
    }
}
