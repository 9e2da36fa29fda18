//! Errors in scene files.

use core::fmt;
use std::path::{Path, PathBuf};

use super::find::locate;

/// An error in a scene file: its place, the field, and what was expected there.
///
/// ```text
/// assets/scenes/curtain.scene.ron:12:19: bodies.curtain.size: expected a number from 0.000001 to 1000000, found -1
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The override that caused it, such as `--set curtain.pins=Tip`; none if the file itself did.
    pub origin: Option<String>,
    /// The file; none if the scene was not loaded from one.
    pub file: Option<PathBuf>,
    /// Line, counted from 1; none if no place in the file is at fault.
    pub line: Option<u32>,
    /// Column, counted in characters from 1.
    pub column: Option<u32>,
    /// The path of the field, such as `bodies.curtain.size`; empty if the whole file is at fault.
    pub field: String,
    /// The problem, and what was expected.
    pub problem: String,
}

impl SceneError {
    /// A problem with the field at a path.
    pub(crate) fn of_field(field: impl Into<String>, problem: impl fmt::Display) -> Self {
        let (field, problem) = (field.into(), problem.to_string());
        Self { origin: None, file: None, line: None, column: None, field, problem }
    }

    /// A problem with the whole scene.
    pub(crate) fn new(problem: impl fmt::Display) -> Self {
        Self::of_field("", problem)
    }

    /// The same, in this file.
    pub(crate) fn in_file(mut self, file: &Path) -> Self {
        self.file.get_or_insert_with(|| file.to_path_buf());
        self
    }

    /// The same, with line and column of its field in `text`, unless it is about an override.
    pub(crate) fn located_in(self, text: &str) -> Self {
        match locate(text, &self.field) {
            Some((place, _)) if self.origin.is_none() => self.at(place),
            _ => self,
        }
    }

    /// The same, at this line and column.
    pub(crate) fn at(mut self, (line, column): (usize, usize)) -> Self {
        (self.line, self.column) = (Some(line as u32), Some(column as u32));
        self
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(origin) = &self.origin {
            write!(f, "{origin}: ")?;
        } else if let Some(file) = &self.file {
            write!(f, "{}:", file.display())?;
        }
        if let (Some(line), Some(column), None) = (self.line, self.column, &self.origin) {
            write!(f, "{line}:{column}:")?;
        }
        if self.origin.is_none() && (self.file.is_some() || self.line.is_some()) {
            f.write_str(" ")?;
        }
        if !self.field.is_empty() {
            write!(f, "{}: ", self.field)?;
        }
        f.write_str(&self.problem)
    }
}

impl core::error::Error for SceneError {}
