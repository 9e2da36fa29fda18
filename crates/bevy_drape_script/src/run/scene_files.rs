//! Names of scene files, and folders of them.

use std::path::{Path, PathBuf};

use crate::text::SceneError;

/// The ending of the names of scene files.
pub const SCENE_SUFFIX: &str = ".scene.ron";

/// The name of the scene in a file: `curtain` for `assets/scenes/curtain.scene.ron`.
pub fn scene_name(path: &Path) -> String {
    let file = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    file.strip_suffix(SCENE_SUFFIX).unwrap_or(&file).to_string()
}

/// The scene files in `folder` and in the folders in it, in the order of their paths.
///
/// # Errors
/// [`SceneError`] if the folder cannot be read, or has no scenes.
pub fn scene_files(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, SceneError> {
    let folder = folder.as_ref();
    let mut files = Vec::new();
    let mut unread = vec![folder.to_path_buf()];
    while let Some(folder) = unread.pop() {
        let unreadable =
            |error: std::io::Error| SceneError::new(format!("cannot be read: {error}")).in_file(&folder);
        for entry in std::fs::read_dir(&folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if path.is_dir() {
                unread.push(path);
            } else if path.to_string_lossy().ends_with(SCENE_SUFFIX) {
                files.push(path);
            }
        }
    }
    if files.is_empty() {
        return Err(SceneError::new(format!("no file in here ends with {SCENE_SUFFIX}")).in_file(folder));
    }
    files.sort_unstable();
    Ok(files)
}
