//! Folders of scenes.

use std::path::{Path, PathBuf};

use crate::SceneError;
use crate::runner::SCENE_SUFFIX;

/// The scene files in `folder` and in the folders in it, in the order of their paths.
///
/// # Errors
/// [`SceneError`] if the folder cannot be read, or has no scenes.
pub fn scene_files(folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, SceneError> {
    let folder = folder.as_ref();
    let mut files = Vec::new();
    let mut unread = vec![folder.to_path_buf()];
    while let Some(folder) = unread.pop() {
        let told =
            |error: std::io::Error| SceneError::new(format!("cannot be read: {error}")).in_file(&folder);
        for entry in std::fs::read_dir(&folder).map_err(told)? {
            let path = entry.map_err(told)?.path();
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
