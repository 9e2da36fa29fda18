//! Bodies made from meshes: cloths, soft solids and meshes that follow a cloth; and obstacles, of meshes as they are or of the skins of
//! characters.
//!
//! Reads a mesh, builds the body, and shows it by a copy of the mesh.
//!
//! Design: `docs/design/cloth_from_meshes.md`.

pub(crate) mod body;
pub(crate) mod body_colliders;
pub(crate) mod capsule_fit;
pub(crate) mod cloth_mesh;
pub(crate) mod driven_mesh;
pub(crate) mod obstacle_hierarchy;
pub(crate) mod obstacle_mesh;
pub(crate) mod paint;
pub(crate) mod pose_paint;
pub(crate) mod reading;
pub(crate) mod skin;
pub(crate) mod soft_body;
pub(crate) mod source;
pub(crate) mod spawn_colliders;
