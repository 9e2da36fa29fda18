//! The named scenes, as data that every solver can load.
//!
//! Imports `random`. Called by all floors above.

pub mod mesh;
pub mod model;
pub mod rope;
pub mod scene;
pub mod sheet;
pub mod world;
