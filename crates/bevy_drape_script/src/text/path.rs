//! Paths of fields, such as `bodies.curtain.pins[1]`.

use serde_path_to_error::{Path, Segment};

/// A step of a path: into a field or map entry, to an item of a list, or into the content of a variant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum PathStep {
    Key(String),
    Index(usize),
    Variant(String),
}

pub(super) fn steps_of(path: &Path) -> Vec<PathStep> {
    let step = |segment: &Segment| match segment {
        Segment::Seq { index } => Some(PathStep::Index(*index)),
        Segment::Map { key } => Some(PathStep::Key(key.clone())),
        Segment::Enum { variant } => Some(PathStep::Variant(variant.clone())),
        Segment::Unknown => None,
    };
    path.iter().filter_map(step).collect()
}

/// The path as the author of a file thinks of it: `bodies.curtain.size`, without the names of variants.
pub(crate) fn field_path(steps: &[PathStep]) -> String {
    let mut text = String::new();
    for step in steps {
        match step {
            PathStep::Index(index) => text.push_str(&format!("[{index}]")),
            PathStep::Key(key) => {
                if !text.is_empty() {
                    text.push('.');
                }
                text.push_str(key);
            }
            PathStep::Variant(_) => {}
        }
    }
    text
}

/// Parses a path such as `timeline[2].do`.
pub(crate) fn path_steps(path: &str) -> Vec<PathStep> {
    let mut steps = Vec::new();
    for part in path.split('.').filter(|part| !part.is_empty()) {
        let mut pieces = part.split('[');
        if let Some(key) = pieces.next().filter(|key| !key.is_empty()) {
            steps.push(PathStep::Key(key.to_string()));
        }
        for piece in pieces {
            let inside = piece.strip_suffix(']').unwrap_or(piece);
            steps.push(inside.parse().map_or_else(|_| PathStep::Key(inside.to_string()), PathStep::Index));
        }
    }
    steps
}
