//! tearing.

pub mod cut;
pub(crate) mod piece_topology;
pub mod pieces;
pub(crate) mod split;
pub mod tear;
