//! Applies parameters and overrides to a scene, and tells which of them an error comes from.

use super::overrides::Override;
use super::replace::{replaced, whole_path};
use crate::scene::SceneScript;
use crate::text::{SceneError, field_path};

/// `script` with its parameters applied, at their overridden values or else their defaults, and then the other overrides.
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

/// The same error, attributed to the default of a parameter.
fn of_default(parameter: &str, error: SceneError) -> SceneError {
    let SceneError { field, problem, .. } = error;
    SceneError::of_field(format!("parameters.{parameter}.default"), format!("{field}: {problem}"))
}

/// The same error, attributed to the override or parameter that set the wrong value, if one did.
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
