//! Overrides: values of a scene replaced by their paths, as by `--set curtain.particles=[128,96]`.

use std::str::FromStr;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::SceneError;
use crate::hint::with_hint;
use crate::scene::SceneScript;
use crate::text::{Step, field_path, parse_value, steps};

/// A value and the path of what it replaces, or the name of a parameter. Parsed from `PATH=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// A path such as `settings.duration`, `curtain.particles` or `timeline[0].at`, or the name of a parameter. What begins
    /// with the name of a body, obstacle, cannon, camera or material is within that.
    pub path: String,
    /// The new value. Choices are written as texts.
    pub value: Value,
}

impl Override {
    /// Replaces what is at `path` by `value`.
    pub fn new(path: impl Into<String>, value: impl Into<Value>) -> Self {
        Self { path: path.into(), value: value.into() }
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
        // A bare word is a choice or a text.
        let is_word = value.chars().all(|c| c.is_alphanumeric() || c == '_')
            && !value.starts_with(|c: char| c.is_ascii_digit());
        let value = if is_word && !["true", "false"].contains(&value) {
            Value::String(value.to_string())
        } else {
            parse_value(value).map_err(|error| SceneError::of_field(path, error.problem))?
        };
        Ok(Self { path: path.to_string(), value })
    }
}

/// `script` with its parameters at what `overrides` make of them, or at their defaults, and then the other overrides.
pub(crate) fn apply(mut script: SceneScript, overrides: &[Override]) -> Result<SceneScript, SceneError> {
    for (name, parameter) in script.parameters.clone().iter() {
        let given = overrides.iter().rev().find(|given| given.path == *name);
        let value = given.map_or(&parameter.default, |given| &given.value);
        for path in &parameter.sets {
            script = replaced(&script, path, value)?;
        }
    }
    for Override { path, value } in overrides {
        if !script.parameters.contains_key(path) {
            script = replaced(&script, path, value)?;
        }
    }
    Ok(script)
}

/// `script` with one more value replaced. The word `None` may also be nothing at all.
pub(crate) fn replaced(script: &SceneScript, path: &str, value: &Value) -> Result<SceneScript, SceneError> {
    let mut root = to_value(script)?;
    *place(&mut root, path)? = value.clone();
    from_value(root).or_else(|error| {
        if value == "None" {
            let mut root = to_value(script)?;
            *place(&mut root, path)? = Value::Null;
            if let Ok(script) = from_value(root) {
                return Ok(script);
            }
        }
        let error = with_hint(error);
        Err(SceneError::of_field(path, format!("cannot be {value}: {}", error.problem)))
    })
}

fn to_value<T: Serialize>(value: &T) -> Result<Value, SceneError> {
    serde_json::to_value(value).map_err(SceneError::new)
}

fn from_value<T: DeserializeOwned>(value: Value) -> Result<T, SceneError> {
    serde_path_to_error::deserialize(value)
        .map_err(|error| SceneError::of_field(field_path(error.path()), error.inner()))
}

/// The maps that a path may leave out.
const NAMED: [&str; 5] = ["bodies", "obstacles", "cannons", "cameras", "materials"];

/// The value at `path`.
fn place<'a>(root: &'a mut Value, path: &str) -> Result<&'a mut Value, SceneError> {
    let steps = steps(path);
    let mut holder = None;
    if let Some(Step::Key(first)) = steps.first()
        && root.get(first).is_none()
    {
        holder = NAMED.into_iter().find(|map| root.get(map).is_some_and(|map| map.get(first).is_some()));
    }
    let mut current = root;
    if let Some(holder) = holder {
        current = &mut current[holder];
    }
    for step in &steps {
        current = go(current, step).map_err(|problem| SceneError::of_field(path, problem))?;
    }
    if steps.is_empty() {
        return Err(SceneError::of_field(path, "expected a path"));
    }
    Ok(current)
}

fn go<'a>(mut current: &'a mut Value, step: &Step) -> Result<&'a mut Value, String> {
    match step {
        Step::Key(key) => {
            // The name of a choice need not be told.
            while let Some(choice) = only_choice(current).filter(|choice| choice != key) {
                current = &mut current[&choice];
            }
            let known = current.as_object().map(|map| map.keys().cloned().collect::<Vec<_>>());
            match known {
                Some(keys) if keys.iter().any(|known| known == key) => Ok(&mut current[key.as_str()]),
                Some(keys) => Err(format!("there is no `{key}` here; there are: {}", keys.join(", "))),
                None => Err(format!("there is no `{key}` here, as this has no fields")),
            }
        }
        Step::Index(index) => {
            while let Some(choice) = only_choice(current) {
                current = &mut current[&choice];
            }
            match current.as_array_mut() {
                Some(items) => {
                    let count = items.len();
                    items
                        .get_mut(*index)
                        .ok_or_else(|| format!("there is no item {index}, as there are {count}"))
                }
                None => Err(format!("there is no item {index}, as this is no list")),
            }
        }
    }
}

/// The name of the choice that a value is, if it is one that holds something.
fn only_choice(value: &Value) -> Option<String> {
    let map = value.as_object()?;
    let (key, _) = map.iter().next().filter(|_| map.len() == 1)?;
    key.starts_with(|c: char| c.is_uppercase()).then(|| key.clone())
}
