//! Loads scenes: reads a file and its fragments, applies overrides, checks the scene as a whole.
//!
//! Imports `scene`, `mesh` and `text`. [`SceneScript::load`](crate::SceneScript::load) is the entry; the asset loader of
//! `run` feeds [`SceneTexts`] from Bevy's asset server, and `play` replaces single values while a scene runs.

mod apply;
mod check;
mod fragments;
mod overrides;
mod paths;
mod replace;
mod scene_script;
mod scene_texts;

pub use overrides::Override;
pub(crate) use replace::replaced;
pub(crate) use scene_texts::{SceneTexts, mesh_files};
