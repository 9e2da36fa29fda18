//! Notes on actions that had no effect: no failure, but hardly the author's intention.

use super::event_counter::EventCounter;
use super::scene_entities::SceneEntities;
use crate::scene::{Action, Names, whole};

/// Notes in words, and cuts whose effect is not known yet.
#[derive(Default)]
pub(super) struct Notes {
    pub texts: Vec<String>,
    cuts: Vec<PendingCut>,
}

/// A cut whose step has not been taken yet.
#[derive(Clone, Copy)]
struct PendingCut {
    event: usize,
    /// When it was made, in seconds.
    time: f64,
    /// The number of sticks that had been severed or torn before.
    torn: usize,
}

impl From<Vec<String>> for Notes {
    fn from(texts: Vec<String>) -> Self {
        Self { texts, cuts: Vec::new() }
    }
}

impl Notes {
    /// Notes an event that has nothing to act on. A cut is watched until its step has been taken.
    pub fn add_event(
        &mut self,
        event: usize,
        action: &Action,
        time: f64,
        entities: &SceneEntities,
        counter: &EventCounter,
    ) {
        let exists = |name: &str| entities.contains(whole(name));
        let problem = match action {
            Action::Spawn(name) => exists(name).then(|| format!("`{name}` is there already")),
            Action::Picture(_) => None,
            _ => {
                let gone = action.names().into_iter().find(|name| !exists(name));
                gone.map(|name| format!("`{name}` is not there"))
            }
        };
        if let Action::Cut { .. } = action {
            self.cuts.push(PendingCut { event, time, torn: counter.torn(&Names::default()) });
        }
        if let Some(problem) = problem {
            self.add(event, time, &problem);
        }
    }

    /// Notes the cuts of the last step that severed nothing.
    pub fn add_vain_cuts(&mut self, counter: &EventCounter) {
        let torn = counter.torn(&Names::default());
        for cut in core::mem::take(&mut self.cuts) {
            if cut.torn == torn {
                self.add(cut.event, cut.time, "the cut severed nothing");
            }
        }
    }

    /// Adds one note per event: events may repeat.
    fn add(&mut self, event: usize, time: f64, problem: &str) {
        let of = format!("timeline[{event}] ");
        if !self.texts.iter().any(|note| note.starts_with(&of)) {
            self.texts.push(format!("{of}at {time:.3} s: {problem}"));
        }
    }
}
