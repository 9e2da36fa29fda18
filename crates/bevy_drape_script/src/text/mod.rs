//! The text of scene files: RON parsed to values, paths and positions in it, errors in the author's words.
//!
//! Knows no type of a scene: callers pass the schema that describes theirs. Imports nothing of this crate.
//! Called by `mesh`, `scene`, `load` and `play`; [`SceneError`] is the error type of the whole crate.

mod error;
mod explain;
mod find;
mod parse;
mod path;
mod position;
mod range;
mod ron_options;
mod schema;
mod suggest;
mod token;

pub use error::SceneError;
pub(crate) use explain::explain;
pub(crate) use find::{Missing, find, locate};
pub(crate) use parse::{parse, write};
pub(crate) use path::{PathStep, field_path, path_steps};
pub(crate) use range::{ENDLESS, range_in_words};
pub(crate) use schema::Schema;
pub(crate) use suggest::unknown;
