//! Tears and cuts: parts bodies, and makes entities of the pieces.
//!
//! Imports everything that a piece inherits. The plugin runs these systems at the start and at the end of a step.
//!
//! Design: `docs/design/tears_and_cuts.md`.

pub mod messages;
pub(crate) mod part;
pub(crate) mod plugin;
pub(crate) mod tearing;
