//! Registers balls and cannons.

use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

use crate::ball::cannon::{Cannon, CannonFired, FireCannon, fire_cannons};
use crate::ball::projectile::{
    Projectile, ProjectileState, build_projectiles, remove_ball, teleport_projectiles,
    write_projectile_transforms,
};
use crate::pending_messages::{Pending, collect_pending};
use crate::refusal::forget_removed;
use crate::schedule::{CollectRequests, DrapeSchedule, FinishPhase, ScenePhase};

/// Balls.
pub(crate) struct BallPlugin;

impl Plugin for BallPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Projectile, ProjectileState)>()
            .add_observer(remove_ball)
            .add_observer(forget_removed::<Projectile>)
            .add_systems(
                DrapeSchedule,
                (
                    build_projectiles.in_set(ScenePhase::BuildBalls),
                    teleport_projectiles.in_set(ScenePhase::TeleportBalls),
                    write_projectile_transforms.in_set(FinishPhase::WriteBalls),
                ),
            );
    }
}

/// Cannons that fire balls, on request.
pub(crate) struct CannonPlugin {
    /// The schedule that takes steps.
    pub schedule: Interned<dyn ScheduleLabel>,
}

impl Plugin for CannonPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<(Cannon, FireCannon, CannonFired)>()
            .init_resource::<Pending<FireCannon>>()
            .add_message::<CannonFired>()
            .add_message::<FireCannon>()
            .add_observer(forget_removed::<Cannon>)
            .add_systems(self.schedule, collect_pending::<FireCannon>.in_set(CollectRequests))
            .add_systems(
                DrapeSchedule,
                (collect_pending::<FireCannon>, fire_cannons).chain().in_set(ScenePhase::FireCannons),
            );
    }
}
