//! A world without an engine: islands, sleep, wake, culling and faults. The plugin drives the same code, and has tests of
//! its own in `tests/plugin`.

mod common;
mod culling;
mod events;
mod faults;
mod islands;
mod obstacles;
mod readme;
mod sleeping;
mod waking;
