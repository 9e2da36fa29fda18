//! Messages that wait for the next step.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;

/// What was asked for since the last step. Bevy forgets messages after two ticks, and a game may be paused for longer.
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

/// Keeps what was sent since it last ran. Runs in every tick, and once more in a step, for what systems of the step send.
pub(crate) fn collect_pending<M: Message + Clone>(
    messages: Res<Messages<M>>,
    mut pending: ResMut<Pending<M>>,
) {
    let Pending { cursor, waiting } = &mut *pending;
    waiting.extend(cursor.read(&messages).cloned());
}
