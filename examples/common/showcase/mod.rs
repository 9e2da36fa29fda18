//! All examples of features in one window.
//!
//! Imports `feature` and `view`. The example `showcase` calls it.

mod film;
#[cfg(all(feature = "web", target_family = "wasm"))]
mod page;
mod panel;
mod selection;
pub mod window;
