//! Joints of skinned meshes that hang and swing: hair, tails, ears, and skirts of low-poly characters.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::bones::BoneCloth;
//!
//! // Once the character is there: a ponytail from the joint "hair" down to the last of its children.
//! fn dress(joints: Query<(Entity, &Name), Added<Name>>, mut commands: Commands) {
//!     for (joint, name) in &joints {
//!         if name.as_str() == "hair" {
//!             commands.spawn(BoneCloth { drive_frequency: 8.0, ..BoneCloth::new([joint]) });
//!         }
//!     }
//! }
//! # App::new().add_systems(Update, dress).update();
//! ```
//!
//! Imports `attach/` for poses and `transform/` for the time between steps. The plugin builds the bodies with all others, and turns
//! the joints in `PostUpdate`, after animations.
//!
//! Design: `docs/design/bones.md`.

pub(crate) mod bone_cloth;
pub(crate) mod build;
pub(crate) mod chain;
pub(crate) mod plugin;
pub(crate) mod show;
pub(crate) mod spring_bones;
pub(crate) mod springs;
pub(crate) mod swing;
#[cfg(feature = "gltf")]
pub(crate) mod vrm;

pub use bone_cloth::{BoneCloth, BoneWeave};
pub use plugin::BoneSystems;
pub use spring_bones::{SpringBones, SpringCollider, SpringJoint};
