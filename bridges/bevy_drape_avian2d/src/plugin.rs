//! The plugin.

use avian2d::schedule::PhysicsSystems;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeStep};
use bevy_drape_bridge::{BridgePlugin, BridgeSystems};

use crate::changes::{note_colliders, watch};
use crate::obstacles::update_colliders;

/// Makes an obstacle of every collider of Avian 2D, for ropes and cloth in the XY plane. They take their step after the physics
/// has, in the same fixed step, and push nothing:
///
/// ```text
/// FixedPostUpdate   PhysicsSystems   bodies move; their transforms are written
///                   DrapeStep        DrapeSchedule: obstacles of colliders -> cloth moves while all bodies make their way
///                                    from their last places to the new ones
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Avian2dDrapePlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl Avian2dDrapePlugin {
    /// For apps that step physics and cloth in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Default for Avian2dDrapePlugin {
    /// Physics and cloth step in `FixedPostUpdate`, as both do by default.
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

impl Plugin for Avian2dDrapePlugin {
    fn build(&self, app: &mut App) {
        watch(app);
        app.add_plugins(BridgePlugin { schedule: self.schedule })
            .configure_sets(self.schedule, DrapeStep.after(PhysicsSystems::Last))
            .add_systems(
                DrapeSchedule,
                (note_colliders, update_colliders).chain().in_set(BridgeSystems::ReadColliders),
            );
    }
}
