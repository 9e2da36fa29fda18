//! Merges the fragments that a scene includes into it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::paths::beside;
use crate::scene::{Named, SceneScript, Settings};
use crate::text::SceneError;

/// The scene at `path` of `texts`, with its fragments. `within` are the files that include it.
pub(super) fn with_fragments(
    path: &Path,
    texts: &BTreeMap<PathBuf, String>,
    within: &mut Vec<PathBuf>,
) -> Result<SceneScript, SceneError> {
    let in_file = |error: SceneError| error.in_file(path);
    let text = texts.get(path).ok_or_else(|| in_file(SceneError::new("has not been read")))?;
    let mut script = SceneScript::from_ron(text).map_err(in_file)?;
    within.push(path.to_path_buf());
    for (index, name) in script.include.clone().iter().enumerate() {
        let field = format!("include[{index}]");
        let refuse = |problem: String| in_file(SceneError::of_field(field.clone(), problem).located_in(text));
        let from = beside(path, name);
        if within.contains(&from) {
            return Err(refuse(format!("`{name}` includes itself, by way of this file")));
        }
        let fragment = with_fragments(&from, texts, within)?;
        if fragment.settings != Settings::default() {
            let error = SceneError::of_field(
                "settings",
                "expected none, as settings belong to the scene, and this is included",
            );
            let text = texts.get(&from).map_or("", String::as_str);
            return Err(error.located_in(text).in_file(&from));
        }
        if let Some(taken) = add(&mut script, fragment) {
            return Err(refuse(format!("`{taken}` of `{name}` is defined here already")));
        }
    }
    within.pop();
    Ok(script)
}

/// Adds a fragment to a scene. Returns a name that both have, if there is one.
fn add(script: &mut SceneScript, fragment: SceneScript) -> Option<String> {
    script.timeline.extend(fragment.timeline);
    script.expectations.extend(fragment.expectations);
    let taken = [
        merge(&mut script.parameters, fragment.parameters),
        merge(&mut script.materials, fragment.materials),
        merge(&mut script.bodies, fragment.bodies),
        merge(&mut script.obstacles, fragment.obstacles),
        merge(&mut script.winds, fragment.winds),
        merge(&mut script.cannons, fragment.cannons),
        merge(&mut script.cameras, fragment.cameras),
    ];
    taken.into_iter().flatten().next()
}

/// Moves the entries of `from` into `into`, up to the first whose name is taken.
fn merge<T>(into: &mut Named<T>, from: Named<T>) -> Option<String> {
    for (name, value) in from.0 {
        if into.contains_key(&name) {
            return Some(name);
        }
        into.insert(name, value);
    }
    None
}
