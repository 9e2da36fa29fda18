//! Snapshots: the complete state of a running simulation, to continue from there later, or in another world.
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
//! A snapshot holds the state of bodies, balls and obstacles, the clock, gravity, wind and settings, and the known
//! touches, so that none is reported twice. It does not hold the scene: descriptions of bodies, meshes, your own
//! components, whatever moves the obstacles, and messages that no step has read yet. Restore it into the same world, or
//! into another one in which the same scene was spawned and has taken a step. Entities are found by their
//! [order of creation](Key). Entities that are not in the snapshot are despawned, also those that had not taken a step
//! when it was taken. Missing balls are spawned without your own components: add them when they appear, as you do when a cannon
//! fires. A missing body or obstacle is an error: disable what may have to come back, as a snapshot holds also what is
//! [disabled](bevy::ecs::entity_disabling::Disabled).
//!
//! Tears and cuts go back, too. What was whole is whole again, with its mesh. A missing piece is spawned as a clone of the whole body, or
//! of the oldest piece that is left of it; observers of [`BodySplit`](crate::tear::BodySplit) are not told again.
//!
//! A game that rolls back takes [a part](Snapshot::take_of) of the world back and leaves the rest.
//!
//! The feature `serde` writes snapshots in any format.
//!
//! Design: `docs/design/snapshots.md`.

pub(crate) mod attachments;
pub(crate) mod bodies;
pub(crate) mod contacts;
pub mod key;
pub(crate) mod motions;
pub(crate) mod obstacles;
pub(crate) mod projectiles;
pub(crate) mod rigs;
pub mod saved;
pub(crate) mod tears;
pub mod world;

pub use key::{Key, SnapshotError};
pub use saved::{Snapshot, number_from};
pub use world::members;
