//! Messages that observers hear of too.

use bevy::ecs::event::EntityTrigger;
use bevy::prelude::*;

/// An event of an entity: written as a [`Message`] for those who read all of them at once, and triggered on the entity for
/// its observers.
pub(crate) trait EntityMessage:
    Message + Clone + for<'a> EntityEvent<Trigger<'a> = EntityTrigger>
{
    /// The same as the other of two entities sees it, which hears of it as well.
    fn for_the_other(&self) -> Option<Self> {
        None
    }
}

/// Tells observers of what was written since this last ran. Observers run when the step is over: they may despawn whatever it
/// was about.
pub(crate) fn trigger_written<M: EntityMessage>(mut written: MessageReader<M>, mut commands: Commands) {
    for message in written.read() {
        commands.trigger(message.clone());
        if let Some(other) = message.for_the_other() {
            commands.trigger(other);
        }
    }
}
