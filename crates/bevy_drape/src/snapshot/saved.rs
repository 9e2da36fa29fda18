//! Takes and restores a whole world.

use bevy::prelude::*;

use crate::body::body_state::CreationOrder;
use crate::environment::solver_environment::SolverEnvironment;
use crate::rig::components::{InRig, RigEdits};
use crate::snapshot::key::SnapshotError;
use crate::snapshot::world::members;
use crate::snapshot::{bodies, contacts, obstacles, projectiles, rigs, world};

/// All that decides what a running world does next.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Snapshot {
    world: world::WorldSnapshot,
    bodies: Vec<bodies::BodySnapshot>,
    balls: Vec<projectiles::ProjectileSnapshot>,
    obstacles: Vec<obstacles::ObstacleSnapshot>,
    rig_particles: Vec<rigs::RigParticleSnapshot>,
    contacts: contacts::ContactSnapshot,
}

/// Has the next step that sees something new give out the numbers after `last`: to spawn again what was spawned while the scene
/// ran, so that a snapshot of that finds it.
pub fn number_from(world: &mut World, last: u64) {
    if let Some(mut order) = world.get_resource_mut::<CreationOrder>() {
        order.go_on_from(last);
    }
    if let Some(mut solver) = world.get_resource_mut::<SolverEnvironment>() {
        solver.obstacles.go_on_from(last);
    }
    // Particles of rigs are numbered among themselves: from the first, where there are none.
    if world.query_filtered::<(), With<InRig>>().iter(world).next().is_none()
        && let Some(mut edits) = world.get_resource_mut::<RigEdits>()
    {
        edits.begin_anew();
    }
}

impl Snapshot {
    /// Takes a snapshot, between steps.
    pub fn take(world: &mut World) -> Self {
        let keys = members(world);
        Self {
            world: world::take(world),
            bodies: bodies::take(world, &keys),
            balls: projectiles::take(world, &keys),
            obstacles: obstacles::take(world, &keys),
            rig_particles: rigs::take(world),
            contacts: contacts::take(world, &keys),
        }
    }

    /// Puts the world back to where it was, between steps. From there it goes on with the same bits.
    ///
    /// # Errors
    /// [`SnapshotError`] if the world is not one of the same scene; nothing has changed then.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        let keys = members(world);
        let Self { world: shared, bodies, balls, obstacles, rig_particles, contacts } = self;
        world::check(shared, world)?;
        bodies::check(bodies, world, &keys)?;
        projectiles::check(balls)?;
        obstacles::check(obstacles, world, &keys)?;
        rigs::check(rig_particles, world)?;
        world::restore(shared, world);
        bodies::restore(bodies, world, &keys)?;
        projectiles::restore(balls, world, &keys)?;
        obstacles::restore(obstacles, world, &keys)?;
        rigs::restore(rig_particles, world);
        let keys = members(world);
        contacts::restore(contacts, world, &keys);
        world::have_all_looked_at(world, &keys);
        Ok(())
    }

    /// Number of steps that had been taken.
    pub fn steps(&self) -> u64 {
        self.world.clock.steps()
    }

    /// Simulated time in seconds.
    pub fn elapsed(&self) -> f64 {
        self.world.clock.elapsed()
    }
}
