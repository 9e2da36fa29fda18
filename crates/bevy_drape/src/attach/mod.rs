//! Ties between particles and entities: pins, attachments, skinned poses, hands, winches, inherited motion.
//!
//! Imports the bodies and obstacles below. The plugin runs these systems before waking and stepping.
//!
//! Design: `docs/design/characters.md`, `docs/design/interaction.md` and `docs/design/ropes.md`.

pub(crate) mod animated_pose;
pub mod attachment;
pub(crate) mod attachment_state;
pub(crate) mod follow_attachment;
pub mod follow_particle;
pub(crate) mod follow_pose;
pub mod grab;
pub(crate) mod pins;
pub mod plane_lock;
pub(crate) mod plugin;
pub(crate) mod teleport;
pub mod winch;
pub mod world_motion;
