//! The plugin.

use avian3d::physics_transform::position_to_transform;
use avian3d::schedule::{PhysicsSchedule, PhysicsStepSystems, PhysicsSystems};
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeStep};
use bevy_drape_bridge::{BridgePlugin, BridgeSystems, is_any_pushed};

use crate::changes::{note_bodies, note_colliders, watch};
use crate::motion::{find_near, read, write};
use crate::obstacles::{update_bodies, update_colliders};
use crate::sleep::{fall_asleep, wake};

/// Makes an obstacle of every collider of Avian, and lets cloth, ropes and balls push dynamic bodies. They take their step
/// after the physics has, in the same fixed step:
///
/// ```text
/// FixedPostUpdate   PhysicsSystems   bodies move; their transforms are written
///                   DrapeStep        DrapeSchedule: obstacles of colliders -> cloth moves while all bodies make their
///                                    way once more, from their last places to the new ones; dynamic bodies are
///                                    pushed aside -> these get their new places and velocities
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
        app.add_plugins(BridgePlugin { schedule: self.schedule })
            .add_observer(wake)
            .configure_sets(self.schedule, DrapeStep.after(PhysicsSystems::Last))
            .configure_sets(self.schedule, BridgeSystems::ReadStarts.after(PhysicsSystems::Prepare))
            .configure_sets(self.schedule, BridgeSystems::Start.before(PhysicsSystems::StepSimulation))
            .add_systems(
                self.schedule,
                (
                    read.in_set(BridgeSystems::ReadStarts),
                    // Avian's own system once more, for the bodies that cloth has pushed.
                    position_to_transform.after(DrapeStep).run_if(is_any_pushed),
                ),
            )
            .add_systems(
                PhysicsSchedule,
                fall_asleep.after(PhysicsStepSystems::Sleeping).before(PhysicsStepSystems::Finalize),
            )
            .add_systems(
                DrapeSchedule,
                (
                    (note_colliders, note_bodies, update_colliders, update_bodies)
                        .chain()
                        .in_set(BridgeSystems::ReadColliders),
                    find_near.in_set(BridgeSystems::FindNear),
                    read.in_set(BridgeSystems::ReadEnds),
                    write.in_set(BridgeSystems::Write),
                ),
            );
    }
}
