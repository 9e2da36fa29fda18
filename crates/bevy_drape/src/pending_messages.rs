//! Messages that wait for the next step.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;

/// Requests since the last step. Bevy drops messages after two ticks, and a game may be paused for longer.
#[derive(Resource)]
pub(crate) struct Pending<M: Message> {
    cursor: MessageCursor<M>,
    pub waiting: Vec<M>,
}

impl<M: Message> Default for Pending<M> {
    fn default() -> Self {
        Self { cursor: MessageCursor::default(), waiting: Vec::new() }
    }
}

/// Keeps the messages sent since it last ran. It runs in every tick, and again within a step for messages sent by
/// systems of the step.
pub(crate) fn collect_pending<M: Message + Clone>(
    messages: Res<Messages<M>>,
    mut pending: ResMut<Pending<M>>,
) {
    let Pending { cursor, waiting } = &mut *pending;
    waiting.extend(cursor.read(&messages).cloned());
}
