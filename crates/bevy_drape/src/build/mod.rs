//! Descriptions of bodies (cloth, rope, soft ball, rigid tetrahedron) and the systems that build bodies from them.
//!
//! A body is the components of `body/` on an entity: `insert_body` (`description.rs`) inserts them. The solver's `Body` is made
//! of them in each step (`step/island_run.rs`).
//!
//! Imports `body/`. The plugin runs the systems at the start of a step; `render/` and `tear/` look at the descriptions.
//!
//! Design: `docs/design/presets.md`, `docs/design/ropes.md` and `docs/design/rigs.md`.

pub mod cloth;
pub(crate) mod description;
pub(crate) mod plugin;
pub mod preset;
pub mod rigid_tetrahedron;
pub mod rope;
pub mod soft_ball;
