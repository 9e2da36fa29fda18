//! Bodies whose particles are entities: particles and sticks of any shape, and ragdolls.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::rig::{Particle, Stick};
//!
//! fn setup(mut commands: Commands) {
//!     // A pendulum: two particles and the stick between them, each an entity.
//!     let hook = commands.spawn((Particle::pinned(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
//!     let bob = commands.spawn((Particle::new(1.0), Transform::from_xyz(0.0, 1.0, 0.0))).id();
//!     commands.spawn(Stick::new(hook, bob));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! Imports `body/`. The plugin compiles rigs at the start of a step and writes their transforms at its end.
//!
//! Design: `docs/design/rigs.md`.

pub(crate) mod body;
pub(crate) mod compile;
pub(crate) mod components;
pub(crate) mod plugin;
pub(crate) mod ragdoll;
pub(crate) mod transforms;

pub use components::{InRig, Particle, Rig, Stick, StickBound, StickKind};
pub use ragdoll::{Ragdoll, RagdollEntities};
