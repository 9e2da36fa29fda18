//! State that outlives a run: recordings and checkpoints.

mod checkpoint;
mod recording;
mod scenes;
