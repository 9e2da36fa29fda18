//! All examples of features in one window.
//!
//! Imports `feature` and `view`. The example `showcase` calls it.

mod film;
mod panel;
mod selection;
pub mod window;
