//! Checks of a scene as a whole: every name exists, and stands for the right kind of thing.
//!
//! Imports `scene` and `text`, and value replacement for `Set` actions. Called whenever a scene was loaded or changed.

mod bodies;
mod checker;
mod events;
mod expectations;
mod names;
mod obstacles;
mod scene;

pub(super) use scene::check;
