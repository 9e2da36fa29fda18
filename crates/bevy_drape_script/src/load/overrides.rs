//! Overrides, which replace values of a scene by their paths: `--set curtain.particles=[128,96]`.

use core::fmt;
use std::str::FromStr;

use crate::scene::{Literal, SCHEMA};
use crate::text::{SceneError, explain};

/// A path and its new value, or a parameter and its value. Parsed from `PATH=VALUE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// A path such as `settings.duration`, `curtain.particles` or `timeline[0].at`, or the name of a parameter. Paths
    /// may begin with the name of a body, obstacle, wind, cannon, camera or material.
    pub path: String,
    /// The new value, written as in the file.
    pub value: Literal,
}

impl Override {
    /// Replaces the value at `path` by `value`.
    pub fn new(path: impl Into<String>, value: impl Into<Literal>) -> Self {
        Self { path: path.into(), value: value.into() }
    }

    /// The same error, attributed to this override instead of a place in a file.
    pub(super) fn blamed(&self, error: SceneError) -> SceneError {
        SceneError { origin: Some(format!("--set {self}")), file: None, line: None, column: None, ..error }
    }
}

impl fmt::Display for Override {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{}={}", self.path, self.value)
    }
}

impl FromStr for Override {
    type Err = SceneError;

    fn from_str(text: &str) -> Result<Self, SceneError> {
        let bad =
            || SceneError::new(format!("`{text}`: expected PATH=VALUE, such as curtain.particles=[128,96]"));
        let (path, value) = text.split_once('=').ok_or_else(bad)?;
        let (path, value) = (path.trim(), value.trim());
        if path.is_empty() || value.is_empty() {
            return Err(bad());
        }
        let value = value.parse().map_err(|error| SceneError {
            origin: Some(format!("--set {text}")),
            field: path.to_string(),
            ..error
        })?;
        Ok(Self { path: path.to_string(), value })
    }
}

impl FromStr for Literal {
    type Err = SceneError;

    fn from_str(text: &str) -> Result<Self, SceneError> {
        Self::from_ron(text).map_err(|error| explain(&error, &[], text.trim(), &SCHEMA))
    }
}
