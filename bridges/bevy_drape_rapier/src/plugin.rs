//! The plugin.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeStep};
use bevy_drape_bridge::{BridgePlugin, BridgeSystems, is_any_pushed};
use bevy_rapier3d::plugin::PhysicsSet;
use bevy_rapier3d::plugin::systems::writeback_rigid_bodies;

use crate::changes::{note_bodies, watch};
use crate::motion::{find_near, read, wake, write};
use crate::obstacles::{update_bodies, update_colliders};

/// Makes an obstacle of every collider of Rapier, and lets cloth, ropes and balls push dynamic bodies. They take their step
/// after the physics has, so Rapier must step in a fixed schedule, too:
///
/// ```text
/// FixedUpdate       PhysicsSet   bodies move; their transforms are written
/// FixedPostUpdate   DrapeStep    DrapeSchedule: obstacles of colliders -> cloth moves while all bodies make their
///                                way once more, from their last places to the new ones; dynamic bodies are
///                                pushed aside -> these get their new places and velocities
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RapierDrapePlugin {
    schedule: Interned<dyn ScheduleLabel>,
}

impl RapierDrapePlugin {
    /// For apps that run `RapierPhysicsPlugin` in `schedule`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self { schedule: schedule.intern() }
    }
}

impl Default for RapierDrapePlugin {
    /// Physics steps in `FixedUpdate`: `RapierPhysicsPlugin::in_fixed_schedule`.
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl Plugin for RapierDrapePlugin {
    fn build(&self, app: &mut App) {
        watch(app);
        app.add_plugins(BridgePlugin { schedule: self.schedule })
            .add_observer(wake)
            .configure_sets(self.schedule, DrapeStep.after(PhysicsSet::Writeback))
            .configure_sets(self.schedule, BridgeSystems::ReadStarts.after(PhysicsSet::SyncBackend))
            .configure_sets(self.schedule, BridgeSystems::Start.before(PhysicsSet::StepSimulation))
            .add_systems(self.schedule, read.in_set(BridgeSystems::ReadStarts))
            .add_systems(
                DrapeSchedule,
                (
                    (note_bodies, update_colliders, update_bodies)
                        .chain()
                        .in_set(BridgeSystems::ReadColliders),
                    find_near.in_set(BridgeSystems::FindNear),
                    read.in_set(BridgeSystems::ReadEnds),
                    // Rapier's own system once more, for the bodies that cloth has pushed. It looks at all.
                    (write, writeback_rigid_bodies)
                        .chain()
                        .run_if(is_any_pushed)
                        .in_set(BridgeSystems::Write),
                ),
            );
    }
}
