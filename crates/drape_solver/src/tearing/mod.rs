//! Tears and cuts: stretched sticks tear, blades cut, and bodies separate into pieces.
//!
//! `tear.rs` and `cut.rs` choose the cracks, `split.rs` splits particles there and decides which sticks stay (`joined`),
//! `pieces.rs` and `piece_topology.rs` build the bodies.
//!
//! Imports: `build` and everything below. Callers: users and the plugin, between steps.

pub mod cut;
pub(crate) mod piece_topology;
pub mod pieces;
pub(crate) mod split;
pub mod tear;
pub(crate) mod tether_crossing;
