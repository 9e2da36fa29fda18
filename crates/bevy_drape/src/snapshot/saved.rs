//! Takes and restores a world, or a part of it.

use bevy::ecs::query::QueryFilter;
use bevy::prelude::*;

use crate::body::body_state::CreationOrder;
use crate::environment::solver_environment::SolverEnvironment;
use crate::rig::components::{InRig, RigEdits};
use crate::sleep::candidates::Candidates;
use crate::snapshot::key::SnapshotError;
use crate::snapshot::world::{chosen, members};
use crate::snapshot::{bodies, contacts, obstacles, projectiles, rigs, world};

/// The state of a running simulation, or of [a part](Self::take_of) of it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Snapshot {
    /// False for a part of a world.
    is_whole: bool,
    world: world::WorldSnapshot,
    bodies: Vec<bodies::BodySnapshot>,
    balls: Vec<projectiles::ProjectileSnapshot>,
    obstacles: obstacles::ObstacleSnapshots,
    rig_particles: Vec<rigs::RigParticleSnapshot>,
    contacts: contacts::ContactSnapshot,
}

/// Continues the order of creation after `last`. Call it before you respawn entities that were spawned while the scene
/// ran, so that a snapshot finds them.
pub fn number_from(world: &mut World, last: u64) {
    if let Some(mut order) = world.get_resource_mut::<CreationOrder>() {
        order.go_on_from(last);
    }
    if let Some(mut solver) = world.get_resource_mut::<SolverEnvironment>() {
        solver.obstacles.go_on_from(last);
    }
    // Rig particles have their own numbers, which restart at 1 if there are none.
    if world.query_filtered::<(), With<InRig>>().iter(world).next().is_none()
        && let Some(mut edits) = world.get_resource_mut::<RigEdits>()
    {
        edits.begin_anew();
    }
}

impl Snapshot {
    /// Takes a snapshot of everything, between steps.
    pub fn take(world: &mut World) -> Self {
        Self { is_whole: true, ..Self::take_of::<()>(world) }
    }

    /// Takes a snapshot of the bodies, balls and obstacles that match the filter, between steps.
    ///
    /// With a component of your own, such as `With<RolledBack>`, it saves what a game rolls back and leaves out the rest. A
    /// hand-built rig matches if one of its particles does. Pieces of torn bodies have to match like these. Whatever can touch a part belongs to it, or the part does not continue
    /// with the same bits; only an obstacle that never moves may be left out.
    pub fn take_of<F: QueryFilter>(world: &mut World) -> Self {
        let all = members(world);
        let keys = chosen::<F>(world, &all);
        Self {
            is_whole: false,
            world: world::take(world),
            bodies: bodies::take(world, &keys),
            balls: projectiles::take(world, &keys),
            obstacles: obstacles::take(world, &keys),
            rig_particles: rigs::take(world, &keys),
            contacts: contacts::take(world, &all, &keys),
        }
    }

    /// Restores the world to the snapshot, between steps. From there it continues with the same bits.
    ///
    /// # Errors
    /// [`SnapshotError`] if the world does not have the same scene, or the snapshot is of a part; then nothing is changed.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        if self.is_whole { self.restore_of::<()>(world) } else { Err(SnapshotError::PartOfWorld) }
    }

    /// Restores the entities that match the filter that the snapshot was [taken with](Self::take_of), between steps. One that matches
    /// now and is not in the snapshot is despawned. All others stay as they are. The clock, gravity, wind and settings, which
    /// everything shares, go back.
    ///
    /// A missing ball is spawned without your own components, as by [`restore`](Self::restore): an observer of `Add<Projectile>` gives
    /// it the component of the filter.
    ///
    /// # Errors
    /// As [`restore`](Self::restore).
    pub fn restore_of<F: QueryFilter>(&self, world: &mut World) -> Result<(), SnapshotError> {
        let all = members(world);
        let keys = chosen::<F>(world, &all);
        let Self { world: shared, bodies, balls, obstacles, rig_particles, contacts, .. } = self;
        world::check(shared, world)?;
        let plans = bodies::plan(bodies, world, &all, &keys)?;
        projectiles::check(balls)?;
        obstacles::check(obstacles, world, &keys)?;
        rigs::check(rig_particles, world, &keys)?;
        world::restore(shared, world);
        let vanished = world.resource::<Candidates>().left.len();
        bodies::restore(bodies, &plans, world, &keys)?;
        projectiles::restore(balls, world, &keys)?;
        // A body that is not there yet wakes nothing beside the place where it would lie.
        world.resource_mut::<Candidates>().left.truncate(vanished);
        obstacles::restore(obstacles, world, &keys)?;
        rigs::restore(rig_particles, world, &keys);
        world::go_on_counting(shared, world);
        let all = members(world);
        let is = chosen::<F>(world, &all);
        contacts::restore(contacts, world, &all, [&keys, &is]);
        Ok(())
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.world.clock.steps()
    }

    /// Simulated time in seconds.
    pub fn elapsed(&self) -> f64 {
        self.world.clock.elapsed()
    }
}
