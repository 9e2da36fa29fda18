//! Changes of obstacles that change ticks do not show.

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;

use crate::environment::obstacle::Obstacle;

/// Changes of obstacles that change ticks do not show.
#[derive(Resource, Default)]
pub(crate) struct ObstacleChanges {
    /// Those that were despawned, disabled or lost their [`Obstacle`].
    pub gone: Vec<Entity>,
    /// Those that were enabled, or gained or lost a component that matters.
    pub recheck: Vec<Entity>,
    /// Those that moved in the last step, and may have stopped.
    pub moving: Vec<Entity>,
    /// Those to bring up to date in this step.
    pub outdated: Vec<Entity>,
    /// Those that only move in this step, and where to.
    pub moved: Vec<(Entity, GlobalTransform)>,
}

impl ObstacleChanges {
    /// Sets those of the members that moved in the last step, and those that were disabled or enabled since.
    pub fn restore(&mut self, members: &EntityHashSet, moving: Vec<Entity>, changed: Vec<Entity>) {
        self.moving.retain(|obstacle| !members.contains(obstacle));
        self.moving.extend(moving);
        self.gone.extend(&changed);
        self.recheck.extend(changed);
    }
}

pub(crate) fn note_gone_obstacle(gone: On<Remove<Obstacle>>, mut changes: ResMut<ObstacleChanges>) {
    changes.gone.push(gone.entity);
}

pub(crate) fn note_disabled_obstacle(disabled: On<Add<Disabled>>, mut changes: ResMut<ObstacleChanges>) {
    changes.gone.push(disabled.entity);
}

/// Checks an entity in the next step, in case it is an obstacle.
pub(crate) fn recheck_obstacle<P: EventPattern<Event: EntityEvent>>(
    event: On<P>,
    mut changes: ResMut<ObstacleChanges>,
) {
    changes.recheck.push(event.event_target());
}
