//! Tears and cuts: parts bodies, and makes entities of the pieces.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::tear::{BodySplit, CutCloth};
//!
//! fn slash(mut cuts: MessageWriter<CutCloth>) {
//!     let (hilt, tip) = (Vec3::new(-2.0, 0.0, 0.0), Vec3::new(-2.0, 0.0, 2.0));
//!     cuts.write(CutCloth::sweep([hilt, tip], [hilt + Vec3::X * 4.0, tip + Vec3::X * 4.0]));
//! }
//!
//! fn listen(mut splits: MessageReader<BodySplit>) {
//!     splits.read().for_each(|split| println!("{} is in pieces: {:?}", split.body, split.piece));
//! }
//! # let mut app = App::new();
//! # app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
//! # app.add_systems(Startup, slash).add_systems(Update, listen).update();
//! ```
//!
//! Imports everything that a piece inherits. The plugin runs these systems at the start and at the end of a step.
//!
//! Design: `docs/design/tears_and_cuts.md`.

pub(crate) mod messages;
pub(crate) mod part;
pub(crate) mod plugin;
pub(crate) mod tearing;

pub use messages::{BodySplit, CutCloth, StickTorn};
