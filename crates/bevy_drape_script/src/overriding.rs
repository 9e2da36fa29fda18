//! Overrides: values of a scene replaced by their paths, as by `--set curtain.particles=[128,96]`.

use core::fmt;
use std::str::FromStr;

use crate::SceneError;
use crate::scene::{Literal, SceneScript};
use crate::suggest::unknown;
use crate::text::{Instead, Step, field_path, find, parse, steps, write};

/// A value and the path of what it replaces, or the name of a parameter. Parsed from `PATH=VALUE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// A path such as `settings.duration`, `curtain.particles` or `timeline[0].at`, or the name of a parameter. What begins
    /// with the name of a body, obstacle, cannon, camera or material is within that.
    pub path: String,
    /// The new value, as it would be written in the file.
    pub value: Literal,
}

impl Override {
    /// Replaces what is at `path` by `value`.
    pub fn new(path: impl Into<String>, value: impl Into<Literal>) -> Self {
        Self { path: path.into(), value: value.into() }
    }

    /// The same error, told of this override instead of a place in a file.
    fn blamed(&self, error: SceneError) -> SceneError {
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

/// `script` with its parameters at what `overrides` make of them, or at their defaults, and then the other overrides.
pub(crate) fn apply(mut script: SceneScript, overrides: &[Override]) -> Result<SceneScript, SceneError> {
    for (name, parameter) in script.parameters.clone().iter() {
        let given = overrides.iter().rev().find(|given| given.path == *name);
        let value = given.map_or(&parameter.default, |given| &given.value);
        for path in &parameter.sets {
            script = replaced(&script, path, value).map_err(|error| match given {
                Some(given) => given.blamed(error),
                None => of_default(name, error),
            })?;
        }
    }
    for given in overrides {
        if !script.parameters.contains_key(&given.path) {
            script = replaced(&script, &given.path, &given.value).map_err(|error| given.blamed(error))?;
        }
    }
    Ok(script)
}

fn of_default(parameter: &str, error: SceneError) -> SceneError {
    let SceneError { field, problem, .. } = error;
    SceneError::of_field(format!("parameters.{parameter}.default"), format!("{field}: {problem}"))
}

/// The same error, told of the override or the default that put there what is wrong, if one did.
pub(crate) fn blame(script: &SceneScript, overrides: &[Override], error: SceneError) -> SceneError {
    let sets = |path: &str| {
        let path = field_path(&whole_path(script, path));
        error.field.strip_prefix(&path).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    };
    let is_at_fault = |given: &&Override| match script.parameters.get(&given.path) {
        Some(parameter) => parameter.sets.iter().any(|path| sets(path)),
        None => sets(&given.path),
    };
    if let Some(given) = overrides.iter().rev().find(is_at_fault) {
        return given.blamed(error);
    }
    let default =
        script.parameters.iter().find(|(_, parameter)| parameter.sets.iter().any(|path| sets(path)));
    match default {
        Some((name, _)) => of_default(name, error),
        None => error,
    }
}

/// `script` with one more value replaced.
pub(crate) fn replaced(script: &SceneScript, path: &str, value: &Literal) -> Result<SceneScript, SceneError> {
    let text = write(script)?;
    let steps = whole_path(script, path);
    if steps.is_empty() {
        return Err(SceneError::of_field(path, "expected a path"));
    }
    let place = find(&text, &steps)
        .map_err(|(depth, instead)| SceneError::of_field(path, missing(script, &steps, depth, &instead)))?;
    let mut fault = None;
    for reading in value.readings() {
        // A comment at its end shall not swallow what follows.
        match parse([&text[..place.start], &reading, "\n", &text[place.end..]].concat().as_str()) {
            Ok(read) => return Ok(SceneScript { meshes: script.meshes.clone(), ..read }),
            Err(error) => fault = fault.or(Some(error)),
        }
    }
    let fault = fault.unwrap_or_else(|| SceneError::new("expected a value"));
    Err(SceneError { line: None, column: None, ..fault })
}

/// The maps that a path may leave out.
const NAMED: [&str; 6] = ["bodies", "obstacles", "winds", "cannons", "cameras", "materials"];

/// The steps of `path`, from the scene as a whole.
fn whole_path(script: &SceneScript, path: &str) -> Vec<Step> {
    let mut steps = steps(path);
    let SceneScript { bodies, obstacles, winds, cannons, cameras, materials, .. } = script;
    if let Some(Step::Key(first)) = steps.first() {
        let holds = [
            bodies.contains_key(first),
            obstacles.contains_key(first),
            winds.contains_key(first),
            cannons.contains_key(first),
            cameras.contains_key(first),
            materials.contains_key(first),
        ];
        if let Some(holder) = holds.into_iter().position(|holds| holds) {
            steps.insert(0, Step::Key(NAMED[holder].to_string()));
        }
    }
    steps
}

/// What to say of a path of which only the first `depth` steps can be taken.
fn missing(script: &SceneScript, steps: &[Step], depth: usize, instead: &Instead) -> String {
    let wanted = match steps.get(depth) {
        Some(Step::Key(key) | Step::Variant(key)) => key.clone(),
        Some(Step::Index(index)) => format!("item {index}"),
        None => String::new(),
    };
    match instead {
        Instead::Keys(keys) => {
            let mut keys = keys.clone();
            if depth == 0 {
                keys.extend(script.names().map(str::to_string));
            }
            unknown(&format!("there is no `{wanted}` here"), &wanted, &keys)
        }
        Instead::Items(count) => format!("there is no {wanted} here, as there are {count}"),
        Instead::NoParts => format!("there is no `{wanted}` here, as this has no parts"),
    }
}
