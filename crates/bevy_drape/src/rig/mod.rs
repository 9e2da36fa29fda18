//! Bodies whose particles are entities: particles and sticks of any shape, and ragdolls.
//!
//! Imports `body/`. The plugin compiles rigs at the start of a step and writes their transforms at its end.
//!
//! Design: `docs/design/rigs.md`.

pub(crate) mod body;
pub(crate) mod compile;
pub mod components;
pub(crate) mod plugin;
pub mod ragdoll;
pub(crate) mod transforms;
