//! The schedule of the timeline.

use serde::{Deserialize, Serialize};

use crate::scene::{Event, Seconds};

/// When an event of the timeline happens next.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct ScheduledEvent {
    /// In seconds; none before its trigger has fired, and after its last repetition.
    pub due: Option<f64>,
    /// True while its trigger may still fire.
    pub is_waiting: bool,
    /// The number of times that it has happened.
    pub done: u32,
}

impl From<&Event> for ScheduledEvent {
    fn from(event: &Event) -> Self {
        Self { due: event.at.map(Seconds::get), is_waiting: event.when.is_some(), done: 0 }
    }
}
