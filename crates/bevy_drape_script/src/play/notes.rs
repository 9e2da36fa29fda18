//! What a scene asked for in vain: no failure, but hardly what its author meant.

use super::ScenePlay;
use crate::scene::{Action, Names, whole};

/// A cut whose step has not been taken yet.
#[derive(Clone, Copy)]
pub(super) struct CutUnderWay {
    event: usize,
    /// When it was made, in seconds.
    time: f64,
    /// How many sticks had been severed or torn before.
    torn: usize,
}

impl ScenePlay {
    /// What was asked for in vain, in words; once the scene is over also what never came about.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.notes.clone();
        if !self.is_over {
            return notes;
        }
        for (index, event) in self.schedule.iter().enumerate().filter(|(_, event)| event.done == 0) {
            if event.is_waiting {
                notes.push(format!("timeline[{index}]: it was never set off"));
            } else if event.due.is_some() {
                notes.push(format!("timeline[{index}]: the scene was over before"));
            }
        }
        let orders = self.orders.iter().map(|order| &order.of);
        notes.extend(orders.map(|of| format!("`{of}` never came to be pinned, let go or pushed")));
        notes
    }

    /// Notes an event that has nothing to act on, and watches what comes of a cut.
    pub(super) fn note_event(&mut self, event: usize, time: f64) {
        let action = &self.script.timeline[event].action;
        let is_there = |name: &str| self.stage.contains(whole(name));
        let vain = match action {
            Action::Spawn(name) => is_there(name).then(|| format!("`{name}` is there already")),
            Action::Picture(_) => None,
            _ => {
                let gone = action.names().into_iter().find(|name| !is_there(name));
                gone.map(|name| format!("`{name}` is not there"))
            }
        };
        if let Action::Cut { .. } = action {
            self.cuts.push(CutUnderWay { event, time, torn: self.tally.torn(&Names::default()) });
        }
        if let Some(vain) = vain {
            self.note(event, time, &vain);
        }
    }

    /// Notes the cuts of the last step that severed nothing.
    pub(super) fn note_cuts(&mut self) {
        let torn = self.tally.torn(&Names::default());
        for cut in core::mem::take(&mut self.cuts) {
            if cut.torn == torn {
                self.note(cut.event, cut.time, "the cut severed nothing");
            }
        }
    }

    /// Once for each event: it may happen again and again.
    fn note(&mut self, event: usize, time: f64, vain: &str) {
        let of = format!("timeline[{event}] ");
        if !self.notes.iter().any(|note| note.starts_with(&of)) {
            self.notes.push(format!("{of}at {time:.3} s: {vain}"));
        }
    }
}
