//! RON text to values and back.

use ron::de::Deserializer;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::SceneError;
use super::explain::explain;
use super::path::steps_of;
use super::ron_options::ron_options;
use super::schema::Schema;

/// Parses `text`. Errors are explained by `schema`.
pub(crate) fn parse<T: DeserializeOwned>(text: &str, schema: &Schema) -> Result<T, SceneError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut deserializer = Deserializer::from_str_with_options(text, &ron_options())
        .map_err(|error| explain(&error, &[], text, schema))?;
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let path = steps_of(error.path());
        explain(&deserializer.span_error(error.into_inner()), &path, text, schema)
    })?;
    deserializer.end().map_err(|error| explain(&deserializer.span_error(error), &[], text, schema))?;
    Ok(value)
}

/// Writes `value` as the text of a scene file.
pub(crate) fn write<T: Serialize>(value: &T) -> Result<String, SceneError> {
    ron_options().to_string_pretty(value, ron::ser::PrettyConfig::default()).map_err(SceneError::new)
}
