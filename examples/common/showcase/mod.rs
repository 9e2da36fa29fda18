//! All examples of features in one window.
//!
//! Imports `feature` and `view`. The example `showcase` calls it.

#[cfg(feature = "window")]
mod film;
#[cfg(feature = "window")]
mod panel;
#[cfg(feature = "window")]
mod selection;
#[cfg(feature = "window")]
pub mod window;
