//! Transforms between frames and fixed steps: interpolation, and propagation within the fixed loop.
//!
//! Imports `step/` for its order only. Balls, and anything else that moves, may use it.
//!
//! Design: `docs/design/schedule.md` and `docs/design/characters.md`.

pub mod interpolation;
pub mod moved_by_frame;
pub(crate) mod plugin;
pub(crate) mod propagation;
