//! Tears and cuts: stretched sticks tear, blades cut, and bodies separate into pieces.
//!
//! Imports: `build` and everything below. Callers: users and the plugin, between steps.

pub mod cut;
pub(crate) mod piece_topology;
pub mod pieces;
pub(crate) mod split;
pub mod tear;
pub(crate) mod tether_crossing;
