//! Moves obstacles with their transforms.
//!
//! Most of those that a game moves are far from all cloth. They are only put where they are now, out of reach of all searches.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_solver::world::bounds_list::BoundsList;

use crate::body::on_gpu::OnGpu;
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::environment::sync_obstacles::Syncing;
use crate::sleep::reach::DrapeReach;

/// The boxes of all that obstacles could touch in this step.
#[derive(Resource, Default)]
pub(crate) struct Reached {
    boxes: BoundsList,
    /// True if some are not known.
    is_everywhere: bool,
}

/// Looks what the obstacles that move in this step could touch, if any moves. Pins have moved by now.
pub(crate) fn note_reached(
    reach: DrapeReach,
    on_gpu: Query<(), (With<OnGpu>, Allow<Disabled>)>,
    changes: Res<ObstacleChanges>,
    mut reached: ResMut<Reached>,
) {
    if !changes.moved.is_empty() {
        reached.is_everywhere = !on_gpu.is_empty();
        reached.boxes.replace(reach.boxes());
    }
}

/// Moves the obstacles of which nothing has changed but the place.
pub(crate) fn move_obstacles(
    mut syncing: Syncing,
    mut changes: ResMut<ObstacleChanges>,
    reached: Res<Reached>,
) {
    let ObstacleChanges { moved, moving, .. } = &mut *changes;
    for (entity, transform) in moved.drain(..) {
        let is_near =
            |radius, place| reached.is_everywhere || reached.boxes.is_any_within(radius + MARGIN, place);
        if syncing.move_one(entity, &transform, is_near) {
            moving.push(entity);
        }
    }
}

/// Distance in metres that an obstacle keeps from all boxes if it is far: forces of the step may still speed bodies up.
const MARGIN: f32 = 1.0;
