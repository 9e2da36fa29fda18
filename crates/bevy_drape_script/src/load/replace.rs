//! Replaces one value of a scene by its path.

use crate::scene::{Literal, SceneScript};
use crate::text::{Missing, PathStep, SceneError, find, path_steps, unknown};

/// `script` with the value at `path` replaced.
pub(crate) fn replaced(script: &SceneScript, path: &str, value: &Literal) -> Result<SceneScript, SceneError> {
    let text = script.to_ron()?;
    let steps = whole_path(script, path);
    if steps.is_empty() {
        return Err(SceneError::of_field(path, "expected a path"));
    }
    let old = find(&text, &steps)
        .map_err(|(depth, end)| SceneError::of_field(path, missing(script, &steps, depth, &end)))?;
    let mut fault = None;
    for reading in value.readings() {
        // A line break, as a comment at the end of the value would swallow the rest.
        match SceneScript::from_ron([&text[..old.start], &reading, "\n", &text[old.end..]].concat().as_str())
        {
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
pub(super) fn whole_path(script: &SceneScript, path: &str) -> Vec<PathStep> {
    let mut steps = path_steps(path);
    let SceneScript { bodies, obstacles, winds, cannons, cameras, materials, .. } = script;
    if let Some(PathStep::Key(first)) = steps.first() {
        let holds = [
            bodies.contains_key(first),
            obstacles.contains_key(first),
            winds.contains_key(first),
            cannons.contains_key(first),
            cameras.contains_key(first),
            materials.contains_key(first),
        ];
        if let Some(holder) = holds.into_iter().position(|holds| holds) {
            steps.insert(0, PathStep::Key(NAMED[holder].to_string()));
        }
    }
    steps
}

/// Explains a path of which only the first `depth` steps exist.
fn missing(script: &SceneScript, steps: &[PathStep], depth: usize, end: &Missing) -> String {
    let wanted = match steps.get(depth) {
        Some(PathStep::Key(key) | PathStep::Variant(key)) => key.clone(),
        Some(PathStep::Index(index)) => format!("item {index}"),
        None => String::new(),
    };
    match end {
        Missing::Keys(keys) => {
            let mut keys = keys.clone();
            if depth == 0 {
                keys.extend(script.names().map(str::to_string));
            }
            unknown(&format!("there is no `{wanted}` here"), &wanted, &keys)
        }
        Missing::Items(count) => format!("there is no {wanted} here, as there are {count}"),
        Missing::NoParts => format!("there is no `{wanted}` here, as this has no parts"),
    }
}
