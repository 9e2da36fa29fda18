//! Level of detail: fewer substeps and particles for bodies far from every viewer.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::detail::LevelOfDetail;
//! use bevy_drape::viewer::Viewer;
//!
//! fn setup(mut commands: Commands) {
//!     // The farther from the nearest viewer, the less work.
//!     commands.spawn((Viewer, Transform::default()));
//!     commands.spawn((Cloth::new(1.5, 1.0).with_pins(ClothPins::Left), LevelOfDetail::default()));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! Imports the descriptions and ties below. The plugin runs the system at the start of a step; `render/` swaps meshes to fit.
//!
//! Design: `docs/design/level_of_detail.md`.

pub(crate) mod change;
pub(crate) mod level;
pub(crate) mod plugin;
pub(crate) mod resampling;

pub use level::{CurrentDetail, DetailError, DetailLevel, LevelOfDetail};
