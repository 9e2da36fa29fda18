//! The components of a simulated body.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands) {
//!     // What it is, what it is made of, how it is solved, and what it does under load.
//!     let settings = SolverSettings::from(Quality::High);
//!     commands.spawn((Cloth::new(2.0, 1.5), Fabric::SILK, settings, Tearable::default()));
//! }
//!
//! fn push(mut bodies: Query<&mut Particles>) {
//!     for mut particles in &mut bodies {
//!         let moved = particles.velocity(0) + Vec3::Z;
//!         particles.set_velocity(0, moved);
//!     }
//! }
//! # App::new().add_systems(Startup, setup).add_systems(Update, push).update();
//! ```
//!
//! Data only: particles, settings, layers and marks. Imports root files such as `clock` and `refusal`; every feature above
//! reads these components.

pub(crate) mod activity;
pub(crate) mod body_state;
pub(crate) mod contact_events;
pub(crate) mod defaults;
pub(crate) mod fabric;
pub(crate) mod layers;
pub(crate) mod on_gpu;
pub(crate) mod particles;
pub(crate) mod plugin;
pub(crate) mod pressure;
pub(crate) mod settings;
pub(crate) mod surface;
pub(crate) mod tearable;
pub(crate) mod torn_from;

pub use activity::Activity;
pub use contact_events::ContactEvents;
pub use drape_solver::{BendingFriction, BendingRigidity, MembraneStiffness};
pub use fabric::Fabric;
pub use layers::DrapeLayers;
pub use particles::{BodyParts, Particles, Sticks};
pub use pressure::Pressure;
pub use settings::{
    DefaultSolverSettings, Quality, SelfContact, SolverSettings, StickProjection, StructuralSolve,
};
pub use surface::{BodySurface, DefaultBodySurface};
pub use tearable::Tearable;
