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

pub(crate) mod attachments;
pub(crate) mod bodies;
pub(crate) mod contacts;
pub mod key;
pub(crate) mod motions;
pub(crate) mod obstacles;
pub(crate) mod projectiles;
pub(crate) mod rigs;
pub mod saved;
pub mod world;

pub use key::{Key, SnapshotError};
pub use saved::{Snapshot, number_from};
pub use world::members;
