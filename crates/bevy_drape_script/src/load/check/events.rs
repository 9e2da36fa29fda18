//! Checks of events and their actions.

use super::checker::{Checker, Kind, fail, in_range, point};
use crate::load::replaced;
use crate::scene::{Action, Event, Point, Selection};
use crate::text::{SceneError, unknown};

impl Checker<'_> {
    pub(super) fn event(&self, field: &str, event: &Event) -> Result<(), SceneError> {
        match (&event.at, &event.when) {
            (Some(at), None) => {
                let on_at = format!("{field}.at");
                self.within_duration(&on_at, at.get())?;
                let first = self.script.settings.dt.get();
                if matches!(event.action, Action::Checkpoint(_)) && at.get() < 0.5 * first {
                    let problem =
                        format!("expected {first} s or more: there is nothing to keep before the first step");
                    return fail(&on_at, problem);
                }
            }
            (None, Some(trigger)) => {
                let (probe, expect) = trigger.as_probe();
                if probe.since().is_some() {
                    let problem = "expected no `since`: a trigger looks at values as they are";
                    return fail(&format!("{field}.when.probe.since"), problem);
                }
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
            Action::Set(path, _)
                if ["timeline", "expectations"].iter().any(|list| path.starts_with(list)) =>
            {
                fail(
                    field,
                    format!(
                        "expected a setting, body, obstacle, wind or cannon: `{path}` does not change once the scene runs"
                    ),
                )
            }
            Action::Set(path, value) => replaced(self.script, path, value)
                .map(|_| ())
                .map_err(|error| SceneError::of_field(field, format!("{}: {}", error.field, error.problem))),
            _ => Ok(()),
        }
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
