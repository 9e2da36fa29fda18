//! Tells which bodies and balls have fallen asleep, and which have woken.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;

use crate::body::activity::Activity;
use crate::change_detection::collect_changed;
use crate::entity_events::EntityMessage;

/// Written in the step in which a body or ball falls asleep, and triggered on it.
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BodySlept {
    /// The body or ball.
    #[event_target]
    pub body: Entity,
}

/// Written in the step in which a body or ball that slept is simulated again, and triggered on it.
#[derive(EntityEvent, Message, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct BodyWoken {
    /// The body or ball.
    #[event_target]
    pub body: Entity,
}

impl EntityMessage for BodySlept {}
impl EntityMessage for BodyWoken {}

/// The bodies and balls that slept at the end of the last step.
#[derive(Resource, Default)]
pub(crate) struct Sleepers(EntityHashSet);

/// Compares activities with those after the last step.
pub(crate) fn report_sleep(
    activities: Query<(Entity, Ref<Activity>)>,
    mut sleepers: ResMut<Sleepers>,
    mut slept: MessageWriter<BodySlept>,
    mut woken: MessageWriter<BodyWoken>,
    mut changed: Local<Vec<Entity>>,
) {
    collect_changed(&activities, &mut changed);
    for body in changed.drain(..) {
        let Ok((_, activity)) = activities.get(body) else { continue };
        if *activity == Activity::Resting {
            if sleepers.0.insert(body) {
                slept.write(BodySlept { body });
            }
        } else if sleepers.0.remove(&body) && *activity == Activity::Active {
            woken.write(BodyWoken { body });
        }
    }
}

/// Forgets what is no body or ball any more.
pub(crate) fn forget_sleeper(gone: On<Remove<Activity>>, mut sleepers: ResMut<Sleepers>) {
    sleepers.0.remove(&gone.entity);
}
