//! Keeps the obstacles of dynamic bodies enabled only while cloth, a rope or a ball is near them, so that all others cost
//! nearly nothing.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;
use bevy_drape::drape_solver::world::bounds_list::BoundsList;
use bevy_drape::environment::MovedByObstacle;
use bevy_drape::prelude::Attachment;
use bevy_drape::reach::DrapeReach;

use crate::body::BodyReach;
use crate::frame::InertialFrame;
use crate::load::Load;
use crate::marks::{BodyObstacle, ObstacleOf};
use crate::motion::EngineBody;

/// The boxes of all that can touch a body in this step, and the bodies that come near them or leave them.
#[derive(Resource, Default, Debug)]
pub struct Surroundings {
    boxes: BoundsList,
    /// Obstacles of bodies that something is tied to, however far it is, in their order.
    tied: Vec<Entity>,
    changes: Vec<Change>,
}

/// The obstacle of a body that is near from now on, or no longer.
#[derive(Debug)]
struct Change {
    obstacle: Entity,
    is_near: bool,
    /// Place of the body where the engine's step began.
    start: Placement,
}

impl Surroundings {
    /// Looks at a body that the engine's step has brought to `place`, with a velocity in m/s. `seconds` is the length of the
    /// step, 0 if the engine is paused.
    pub fn look_at(
        &mut self,
        obstacle: &BodyObstacle,
        reach: &mut Mut<BodyReach>,
        place: Placement,
        velocity: Vec3,
        seconds: f32,
    ) {
        if reach.is_new {
            // The plugin numbers obstacles when it first sees them.
            reach.bypass_change_detection().is_new = false;
            return;
        }
        let margin = if reach.is_near { LEAVING } else { COMING };
        let radius = reach.radius + margin + 2.0 * velocity.length() * seconds;
        let is_near = self.boxes.is_any_within(radius, place.translation)
            || self.tied.binary_search(&obstacle.entity()).is_ok();
        if is_near != reach.is_near {
            let translation = place.translation - velocity * seconds;
            let start = Placement { translation, ..place };
            self.changes.push(Change { obstacle: obstacle.entity(), is_near, start });
        }
    }
}

/// Collects the boxes of all that can touch a body in this step.
pub(crate) fn look_around(
    reach: DrapeReach,
    mut surroundings: ResMut<Surroundings>,
    bodies: Query<&MovedByObstacle>,
    attachments: Query<&Attachment>,
) {
    if bodies.is_empty() {
        return;
    }
    let Surroundings { boxes, tied, .. } = &mut *surroundings;
    boxes.replace(reach.boxes());
    tied.clear();
    let ties = attachments.iter().flat_map(|attachment| &attachment.ties);
    tied.extend(ties.filter_map(|tie| Some(bodies.get(tie.entity).ok()?.obstacle)));
    tied.sort_unstable();
}

/// Enables the obstacles of bodies that have come near, where the engine's step began, and disables those of bodies that have
/// left.
pub(crate) fn switch_obstacles(
    mut surroundings: ResMut<Surroundings>,
    mut obstacles: Query<
        (&ObstacleOf, &InertialFrame, &mut EngineBody, &mut Transform, &mut GlobalTransform, &mut Load),
        Allow<Disabled>,
    >,
    mut commands: Commands,
) {
    for Change { obstacle, is_near, start } in surroundings.changes.drain(..) {
        let Ok((of, frame, mut body, mut transform, mut global, mut load)) = obstacles.get_mut(obstacle)
        else {
            continue;
        };
        if is_near {
            let Placement { translation, rotation } = frame.of_body(start);
            *transform = Transform { translation, rotation, ..*transform };
            *global = GlobalTransform::from(*transform);
            (body.place, body.left) = (start, start);
            commands.entity(obstacle).remove::<Disabled>();
        } else {
            // Cloth that held it has been taken elsewhere.
            load.wake_if_carried(of.0, &body, &mut commands);
            *load = Load::default();
            commands.entity(obstacle).insert(Disabled);
        }
    }
}

/// Notes that an obstacle was enabled, here or by a snapshot that was restored.
pub(crate) fn note_enabled(
    enabled: On<Remove<Disabled>>,
    obstacles: Query<&ObstacleOf, Allow<Disabled>>,
    mut bodies: Query<&mut BodyReach>,
) {
    if let Ok(mut reach) = obstacles.get(enabled.entity).and_then(|of| bodies.get_mut(of.0)) {
        reach.is_near = true;
    }
}

/// Notes that an obstacle was disabled.
pub(crate) fn note_disabled(
    disabled: On<Add<Disabled>>,
    obstacles: Query<&ObstacleOf, Allow<Disabled>>,
    mut bodies: Query<&mut BodyReach>,
) {
    if let Ok(mut reach) = obstacles.get(disabled.entity).and_then(|of| bodies.get_mut(of.0)) {
        reach.is_near = false;
    }
}

/// A body comes near at this distance in metres, besides twice its way in a step.
const COMING: f32 = 0.5;

/// It leaves at this one: no obstacle is switched in each step.
const LEAVING: f32 = 1.0;
