//! What the examples are made of.
//!
//! Modules that begin with `scene_` are the runner of scripted scenes, those that begin with `feature` what the examples of
//! single features share; the others are the cannon demo: scene, recorder, report, and the ways to watch it.
//!
//! The demo is the founding experiment of the method (Liu Yuan 2019): a cannon bombards a curtain; the ball flies,
//! hits, and the curtain finds its rest again.

#[cfg(feature = "render")]
pub mod adapter;
pub mod arguments;
#[cfg(feature = "render")]
mod cannon_model;
pub mod character;
pub mod character_model;
#[cfg(feature = "window")]
mod clock_keys;
#[cfg(feature = "window")]
pub mod controls;
#[cfg(feature = "render")]
mod cords;
pub mod feature;
#[cfg(feature = "render")]
mod feature_dress;
pub mod feature_files;
#[cfg(feature = "render")]
mod feature_picture;
#[cfg(feature = "window")]
mod feature_window;
#[cfg(feature = "window")]
mod frame_recorder;
#[cfg(feature = "render")]
pub mod frames;
pub mod headless;
#[cfg(feature = "render")]
pub mod moments;
#[cfg(feature = "window")]
pub mod orbit;
pub mod output;
#[cfg(feature = "window")]
pub mod overlay;
pub mod plot;
#[cfg(feature = "window")]
pub mod pointer;
pub mod recorder;
pub mod report;
pub mod scene;
pub mod scene_arguments;
#[cfg(feature = "render")]
mod scene_dress;
#[cfg(feature = "render")]
mod scene_forms;
#[cfg(feature = "render")]
mod scene_frames;
#[cfg(feature = "window")]
mod scene_panel;
mod scene_plot;
pub mod scene_replay;
#[cfg(feature = "window")]
pub mod scene_replay_window;
pub mod scene_suite;
#[cfg(feature = "render")]
mod scene_view;
#[cfg(feature = "window")]
pub mod scene_window;
#[cfg(feature = "window")]
mod showcase_panel;
#[cfg(feature = "window")]
pub mod showcase_window;
#[cfg(feature = "window")]
pub mod slider;
pub mod soak;
#[cfg(feature = "render")]
pub mod studio;
pub mod table1;
#[cfg(feature = "render")]
mod textures;
#[cfg(feature = "render")]
pub mod visuals;
#[cfg(feature = "window")]
pub mod window;

/// Compiles the example of the repository's README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// Compiles the examples of the guide, which draw.
#[cfg(all(doctest, feature = "render"))]
#[doc = include_str!("../../docs/guide.md")]
pub struct Guide;
