//! The JSON schema of scene files.

use serde_json::Value;

use super::SceneScript;
use crate::text::{SceneError, Schema};

/// The schema that explains errors in scene files.
pub(crate) static SCHEMA: Schema =
    Schema::new(|| serde_json::to_value(schemars::schema_for!(SceneScript)).unwrap_or_default());

/// The JSON schema of scene files: every field with its meaning, unit, range and default. Scene files are RON, whose
/// values have the same structure as JSON.
///
/// # Errors
/// [`SceneError`] if it cannot be written as JSON.
pub fn schema() -> Result<String, SceneError> {
    let mut schema = serde_json::to_value(schemars::schema_for!(SceneScript)).map_err(SceneError::new)?;
    join_lines(&mut schema);
    let mut text = serde_json::to_string_pretty(&schema).map_err(SceneError::new)?;
    text.push('\n');
    Ok(text)
}

/// Joins the lines of each description, as line breaks of the source mean nothing there.
fn join_lines(value: &mut Value) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                match value {
                    Value::String(text) if key == "description" => {
                        *text = text.split_whitespace().collect::<Vec<_>>().join(" ");
                    }
                    other => join_lines(other),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(join_lines),
        _ => {}
    }
}
