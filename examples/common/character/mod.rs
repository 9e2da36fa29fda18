//! A character made in code, with a cape: for the examples `cape` and `cape_gltf`, their model file, and tests of skinned cloth.
//!
//! Imports no other folder.

pub mod bone_meshes;
mod cape_mesh;
pub mod gltf_file;
mod outfit;
mod skeleton;
mod walk_cycle;

pub use cape_mesh::{CAPE, FULL_DISTANCE, cape, cape_mesh};
pub use outfit::spawn_outfit;
pub use skeleton::{ARMS, BONES, CHEST, HEAD, HIPS, SHINS, THIGHS, capsule, inverse_bind_poses};
pub use walk_cycle::{Character, SPRINT, WALK, spawn, spawn_figure};
