//! Paths of files, as scenes write them.

use std::path::{Component, Path, PathBuf};

/// The path of `file` as seen from the folder of `path`.
pub(super) fn beside(path: &Path, file: &str) -> PathBuf {
    normal(&path.parent().unwrap_or(Path::new("")).join(file))
}

/// The path without `.` and `..` wherever possible, so that one file has one path.
pub(super) fn normal(path: &Path) -> PathBuf {
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
