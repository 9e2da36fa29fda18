//! Examples of one feature each: a scene, its command line, its run without a window, its window and its picture.
//!
//! Imports `view`. The examples and their tests use it, and `showcase`, which shows all of them.

mod command_line;
pub(crate) mod example;
mod headless;
#[cfg(feature = "render")]
pub(crate) mod materials;
#[cfg(feature = "render")]
pub(crate) mod picture;
#[cfg(feature = "render")]
mod surfaces;
#[cfg(feature = "window")]
mod window;

pub use crate::view::paint::Paint;
pub use example::{Feature, bare_app, steps_in};
pub use headless::{FeatureError, FeatureReport, Verdict};
