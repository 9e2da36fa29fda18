//! The state of a running world, kept: checkpoints and recordings.

mod checkpoint;
mod recording;
mod world;
