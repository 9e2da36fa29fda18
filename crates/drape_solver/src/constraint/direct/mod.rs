//! Direct solves: rows, columns and ropes as chains, whose sticks are solved all at once.
//!
//! Imports: `state` and below. Callers: `substep`.

pub(crate) mod bent_chain;
pub(crate) mod bundle;
pub(crate) mod chain;
pub(crate) mod grid_lines;
pub(crate) mod line;
mod line_storage;
pub(crate) mod lone_chain;
mod resistance;
mod rotated_bundle;
mod shared_bundles;
mod square_bundle;
mod strip_widths;
pub(crate) mod taut_chain;
#[cfg(test)]
mod testing;
pub(crate) mod thread_friction;
mod torn_lines;
mod transposed_bundle;
