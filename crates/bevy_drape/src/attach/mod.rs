//! Ties between particles and entities: pins, attachments, skinned poses, hands, winches, inherited motion.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands) {
//!     // A rope between a post and a boat, and a lamp that hangs at its end.
//!     let post = commands.spawn(Transform::from_xyz(0.0, 2.0, 0.0)).id();
//!     let boat = commands.spawn(Transform::from_xyz(1.0, 2.0, 0.0)).id();
//!     let rope = Rope::new(Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0), 32);
//!     let rope = commands.spawn((rope, Attachment::first(post).and(Tie::last(boat)))).id();
//!     commands.spawn(FollowParticle::last(rope));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! Imports the bodies and obstacles below. The plugin runs these systems before waking and stepping.
//!
//! Design: `docs/design/characters.md`, `docs/design/joints.md`, `docs/design/interaction.md` and `docs/design/ropes.md`.

pub(crate) mod animated_pose;
pub(crate) mod attachment;
pub(crate) mod attachment_state;
pub(crate) mod follow_attachment;
pub(crate) mod follow_particle;
pub(crate) mod follow_pose;
pub(crate) mod grab;
pub(crate) mod pins;
pub(crate) mod plane_lock;
pub(crate) mod plugin;
pub(crate) mod pull_obstacles;
pub(crate) mod teleport;
pub(crate) mod winch;
pub(crate) mod world_motion;

pub use attachment::{Attachment, Tie, TiedParticles};
pub use follow_particle::{FollowParticle, FollowedParticle, ParticleFollowers};
pub use grab::{Grab, Hand, Pick, pick};
pub use plane_lock::PlaneLock;
pub use winch::{Winch, rest_length};
pub use world_motion::{TeleportCloth, WorldMotion};
