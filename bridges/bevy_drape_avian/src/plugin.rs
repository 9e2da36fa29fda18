//! The plugin.

use avian3d::schedule::PhysicsSystems;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeStep};

use crate::marks::{ColliderObstacle, NoObstacle};
use crate::obstacles::update_obstacles;
use crate::outdated::{note_changes, watch};

/// Makes an obstacle of every collider of Avian. Cloth takes its step after the physics has, in the same fixed step:
///
/// ```text
/// FixedPostUpdate   PhysicsSystems   bodies move; their transforms are written
///                   DrapeStep        DrapeSchedule: obstacles of colliders -> cloth moves, from the last places of
///                                    all bodies to the new ones
/// ```
#[derive(Clone, Copy, Debug)]
pub struct AvianDrapePlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl AvianDrapePlugin {
    /// For apps that step physics and cloth in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Default for AvianDrapePlugin {
    /// Physics and cloth step in `FixedPostUpdate`, as both do by default.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl Plugin for AvianDrapePlugin {
    fn build(&self, app: &mut App) {
        watch(app);
        app.register_type::<(NoObstacle, ColliderObstacle)>()
            .configure_sets(self.schedule, DrapeStep.after(PhysicsSystems::Last))
            .add_systems(
                DrapeSchedule,
                (note_changes, update_obstacles).chain().before(DrapeSystems::ManageScene),
            );
    }
}
