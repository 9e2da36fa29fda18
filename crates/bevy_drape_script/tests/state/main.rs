//! State that outlives a run: recordings and checkpoints.

mod checkpoint;
#[path = "../random/mod.rs"]
mod random;
mod recording;
mod scenes;
