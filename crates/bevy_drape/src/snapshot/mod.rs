//! Snapshots: all that decides what a running world does next, to go on from there later, or somewhere else.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::snapshot::Snapshot;
//!
//! /// Quick save on one key, quick load on the other.
//! fn save_and_load(world: &mut World, mut saved: Local<Option<Snapshot>>) {
//!     let keys = world.resource::<ButtonInput<KeyCode>>();
//!     let (save, load) = (keys.just_pressed(KeyCode::F5), keys.just_pressed(KeyCode::F9));
//!     if save {
//!         *saved = Some(Snapshot::take(world));
//!     }
//!     if load && let Some(snapshot) = &*saved && let Err(error) = snapshot.restore(world) {
//!         error!("{error}");
//!     }
//! }
//! ```
//!
//! A snapshot holds the state of bodies, balls and obstacles, the clock, gravity, wind and settings, and what is known of
//! touches, so that none is told twice. It does not hold what a scene is made of: the description of bodies, meshes, your own
//! components, what moves the obstacles, and messages that no step has seen yet. So it is restored into the world that it was
//! taken of, or into another in which the same scene was spawned and has taken a step; there everything is found again by the
//! [number of its creation](Key). What the snapshot does not know is despawned. Balls that are missing are spawned, bare: give
//! them your own components when they appear, as you do when a cannon fires.
//!
//! With the feature `serde` a snapshot can be written in any format.

mod attachments;
mod bodies;
mod contacts;
mod motions;
mod obstacles;
mod projectiles;
mod rigs;
mod world;

use bevy::prelude::*;
use drape_solver::BuildError;
use thiserror::Error;

use crate::body::particles::CreationOrder;
use crate::environment::solver_environment::SolverEnvironment;
use crate::rig::components::{InRig, RigEdits};

pub use world::members;

/// What tells a body, ball or obstacle from all others of its scene: when it was created. It is the same in every run, as
/// entity ids need not be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Key {
    /// A cloth, rope or rig.
    Body(u64),
    /// A ball.
    Ball(u64),
    /// An obstacle.
    Obstacle(u64),
}

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

/// Why a snapshot cannot be restored into a world.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SnapshotError {
    /// The world has no plugin, or has not taken a step yet.
    #[error("the world has taken no step yet: a snapshot is restored after the first step of its scene")]
    NotStepped,
    /// A body or obstacle of the snapshot is not in the world.
    #[error("{0:?} is not in the world: it is not the scene that the snapshot was taken of")]
    Missing(Key),
    /// A body has other sticks.
    #[error("{key:?} has {found} sticks in the world and {wanted} in the snapshot")]
    AnotherBody {
        /// The body.
        key: Key,
        /// The number of sticks that it has.
        found: usize,
        /// The number of sticks that it had.
        wanted: usize,
    },
    /// The particles and sticks of a hand-built rig are not those of the snapshot.
    #[error("particle {0} of the hand-built rigs is not in the world as it was: rigs must be edited before")]
    AnotherRig(u64),
    /// A state cannot be.
    #[error("{key:?} cannot be what it was: {source}")]
    BadState {
        /// The body, ball or obstacle.
        key: Key,
        /// What is wrong with it.
        source: BuildError,
    },
    /// The same thing is in the snapshot twice, or out of order.
    #[error("{0:?} is in the snapshot twice, or out of order")]
    OutOfOrder(Key),
    /// A number of the clock, gravity, or the wind cannot be.
    #[error("{0} of the snapshot cannot be")]
    BadWorld(&'static str),
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

/// Members of the world: in order of their keys.
type Keys = [(Key, Entity)];

/// The entity of a key.
fn entity(keys: &Keys, key: Key) -> Option<Entity> {
    keys.binary_search_by_key(&key, |&(key, _)| key).ok().map(|place| keys[place].1)
}

/// The first key that is not greater than the one before it.
fn out_of_order(keys: impl Iterator<Item = Key>) -> Result<(), SnapshotError> {
    let mut last = None;
    for key in keys {
        if last >= Some(key) {
            return Err(SnapshotError::OutOfOrder(key));
        }
        last = Some(key);
    }
    Ok(())
}
