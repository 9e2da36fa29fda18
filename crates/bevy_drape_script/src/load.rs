//! From files to a scene: parsing, fragments, overrides, checks.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use crate::SceneError;
use crate::check::check;
use crate::mesh_file::MeshFiles;
use crate::overriding::{self, Override};
use crate::scene::{MeshSource, Named, SceneScript, Settings};
use crate::text;

/// The texts of a scene and of all that it includes, by their paths.
pub(crate) type Texts = BTreeMap<PathBuf, String>;

pub(crate) fn from_file(path: &Path, overrides: &[Override]) -> Result<SceneScript, SceneError> {
    let mut texts = Texts::new();
    let mut unread = vec![normal(path)];
    while let Some(path) = unread.pop() {
        if texts.contains_key(&path) {
            continue;
        }
        let text = std::fs::read_to_string(&path)
            .map_err(|error| SceneError::new(format!("cannot be read: {error}")).in_file(&path))?;
        unread.extend(included(&path, &text)?);
        texts.insert(path, text);
    }
    let path = normal(path);
    let script = from_texts(&path, &texts, overrides)?;
    let mut files = MeshFiles::default();
    for (field, file) in mesh_files(&script) {
        let bytes = std::fs::read(beside(&path, &file));
        note_meshes(&mut files, &file, bytes.map_err(|error| error.to_string()))
            .map_err(|problem| located_among(SceneError::of_field(field, problem), &path, &texts))?;
    }
    finish(script, files, &path, &texts, overrides)
}

/// The files of meshes that a scene names, each once, with the field that names it.
pub(crate) fn mesh_files(script: &SceneScript) -> Vec<(String, String)> {
    let mut files: Vec<(String, String)> = Vec::new();
    for (name, body) in script.bodies.iter() {
        if let Some(file) = body.mesh().and_then(MeshSource::file)
            && files.iter().all(|(_, known)| known != file)
        {
            files.push((format!("bodies.{name}.mesh.path"), file.to_string()));
        }
    }
    files
}

/// Adds what was read from a file of meshes, if it could be.
pub(crate) fn note_meshes(
    files: &mut MeshFiles,
    path: &str,
    bytes: Result<Vec<u8>, String>,
) -> Result<(), String> {
    let bytes = bytes.map_err(|error| format!("`{path}` cannot be read: {error}"))?;
    files.add(path, &bytes)
}

pub(crate) fn from_text(text: &str) -> Result<SceneScript, SceneError> {
    let script = parse(text)?;
    if !script.include.is_empty() {
        return Err(SceneError::of_field("include", "a scene that is no file cannot include others"));
    }
    if let Some((field, _)) = mesh_files(&script).into_iter().next() {
        let error = SceneError::of_field(field, "a scene that is no file cannot name others");
        return Err(located(error, text));
    }
    let script = overriding::apply(script, &[]).map_err(|error| located(error, text))?;
    check(&script).map_err(|error| located(overriding::blame(&script, &[], error), text))?;
    Ok(script)
}

fn parse(text: &str) -> Result<SceneScript, SceneError> {
    text::parse(text)
}

/// The scene at `path`, all of whose texts have been read, as it stands there.
pub(crate) fn from_texts(
    path: &Path,
    texts: &Texts,
    overrides: &[Override],
) -> Result<SceneScript, SceneError> {
    let script = with_fragments(path, texts, &mut Vec::new())?;
    overriding::apply(script, overrides).map_err(|error| located_among(error, path, texts))
}

/// The same, once the meshes that it names have been read: checked as a whole.
pub(crate) fn finish(
    script: SceneScript,
    meshes: MeshFiles,
    path: &Path,
    texts: &Texts,
    overrides: &[Override],
) -> Result<SceneScript, SceneError> {
    let script = SceneScript { meshes, ..script };
    check(&script)
        .map_err(|error| located_among(overriding::blame(&script, overrides, error), path, texts))?;
    Ok(script)
}

fn located(error: SceneError, text: &str) -> SceneError {
    match text::locate(text, &error.field) {
        Some((place, _)) if error.origin.is_none() => error.at(place),
        _ => error,
    }
}

/// The same error with the place of its field, be it in the scene at `path` or in a fragment of it.
pub(crate) fn located_among(error: SceneError, path: &Path, texts: &Texts) -> SceneError {
    if error.origin.is_some() {
        return error.in_file(path);
    }
    // Where most of the path is found; in the scene itself, if that is as good as any.
    let own = texts.get_key_value(path).into_iter();
    let places = own.chain(texts.iter()).filter_map(|(file, text)| {
        let (place, depth) = text::locate(text, &error.field)?;
        Some((depth, place, file))
    });
    let best = places.reduce(|best, next| if next.0 > best.0 { next } else { best });
    match best {
        Some((_, place, file)) => error.at(place).in_file(file),
        None => error.in_file(path),
    }
}

/// The paths of the fragments that the scene at `path` includes.
pub(crate) fn included(path: &Path, text: &str) -> Result<Vec<PathBuf>, SceneError> {
    let script = parse(text).map_err(|error| error.in_file(path))?;
    Ok(script.include.iter().map(|fragment| beside(path, fragment)).collect())
}

fn with_fragments(path: &Path, texts: &Texts, within: &mut Vec<PathBuf>) -> Result<SceneScript, SceneError> {
    let in_file = |error: SceneError| error.in_file(path);
    let text = texts.get(path).ok_or_else(|| in_file(SceneError::new("has not been read")))?;
    let mut script = parse(text).map_err(in_file)?;
    within.push(path.to_path_buf());
    for (index, name) in script.include.clone().iter().enumerate() {
        let field = format!("include[{index}]");
        let refuse = |problem: String| in_file(located(SceneError::of_field(field.clone(), problem), text));
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
            return Err(located(error, text).in_file(&from));
        }
        let taken = [
            merge(&mut script.parameters, fragment.parameters),
            merge(&mut script.materials, fragment.materials),
            merge(&mut script.bodies, fragment.bodies),
            merge(&mut script.obstacles, fragment.obstacles),
            merge(&mut script.winds, fragment.winds),
            merge(&mut script.cannons, fragment.cannons),
            merge(&mut script.cameras, fragment.cameras),
        ];
        if let Some(taken) = taken.into_iter().flatten().next() {
            return Err(refuse(format!("`{taken}` of `{name}` is defined here already")));
        }
        script.timeline.extend(fragment.timeline);
        script.expectations.extend(fragment.expectations);
    }
    within.pop();
    Ok(script)
}

/// Adds what is in `from`; the first name that is taken already.
fn merge<T>(into: &mut Named<T>, from: Named<T>) -> Option<String> {
    for (name, value) in from.0 {
        if into.contains_key(&name) {
            return Some(name);
        }
        into.insert(name, value);
    }
    None
}

/// The path of a file that is named from the folder of `path`.
pub(crate) fn beside(path: &Path, fragment: &str) -> PathBuf {
    normal(&path.parent().unwrap_or(Path::new("")).join(fragment))
}

/// The path without `.` and `..` where it can do without, so that one file has one path.
pub(crate) fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(normal.components().next_back(), Some(Component::Normal(_))) => {
                normal.pop();
            }
            other => normal.push(other),
        }
    }
    normal
}
