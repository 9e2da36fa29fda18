//! A recording without a window: what is in it, and where it parts from another.

use std::path::{Path, PathBuf};

use bevy_drape_script::recording::{Recording, RecordingError, diff};
use thiserror::Error;

/// Why a recording cannot be replayed.
#[derive(Debug, Error)]
#[error("{}: {source}", path.display())]
pub struct ReplayError {
    path: PathBuf,
    source: RecordingError,
}

/// The recording in a file.
///
/// # Errors
/// [`ReplayError`] if it cannot be read, or is damaged.
pub fn load(path: &Path) -> Result<Recording, ReplayError> {
    Recording::load(path).map_err(|source| ReplayError { path: path.to_path_buf(), source })
}

/// Prints what is in a recording, and where `other` parts from it; true if it does not.
///
/// # Errors
/// [`ReplayError`] if one of them cannot be read, or is damaged.
pub fn run(path: &Path, other: Option<&Path>) -> Result<bool, ReplayError> {
    let recording = load(path)?;
    let Some(other) = other else {
        let failed = |source| ReplayError { path: path.to_path_buf(), source };
        print!("{}", summary(&recording).map_err(failed)?);
        return Ok(true);
    };
    let second = load(other)?;
    let parted = diff(&recording, &second);
    match parted.map_err(|source| ReplayError { path: other.to_path_buf(), source })? {
        None => {
            println!("the runs are the same to the last bit, in {} frames", recording.frame_count());
            Ok(true)
        }
        Some(difference) => {
            println!("{difference}");
            Ok(false)
        }
    }
}

/// What is in it, in a few lines.
fn summary(recording: &Recording) -> Result<String, RecordingError> {
    let (header, frames) = (recording.header(), recording.frame_count());
    let mut cursor = recording.cursor();
    let mut values = 0;
    let mut times = [0.0; 2];
    // For each track its frames, the first and the last of them, and the distance that its first place has moved.
    let mut spans = vec![(0_usize, 0, 0, None, 0.0_f32); recording.tracks().len()];
    for index in 0..frames {
        let frame = cursor.seek(index)?;
        times = [if index == 0 { frame.time } else { times[0] }, frame.time];
        for state in &frame.states {
            values += state.values().len();
            let place = state.place(&recording.tracks()[state.track].kind);
            let (count, first, last, start, moved) = &mut spans[state.track];
            *first = if *count == 0 { index } else { *first };
            *last = index;
            *count += 1;
            let start = *start.get_or_insert(place);
            *moved = moved.max(place.distance(start));
        }
    }
    let (plain, bytes) = (4 * values, recording.byte_count());
    let ratio = plain as f64 / bytes.max(1) as f64;
    let mut text = format!(
        "scene “{}”, {frames} frames of {} s, from {:.3} s to {:.3} s\n{bytes} bytes, {ratio:.1} times less than the plain numbers\n",
        header.scene, header.dt, times[0], times[1],
    );
    for (track, (_, first, last, _, moved)) in recording.tracks().iter().zip(spans) {
        let kind = &track.kind;
        let size = kind.particles().map_or_else(String::new, |count| format!(", {count} particles"));
        let mover = if kind.particles().is_some() { "its first particle" } else { "it" };
        text += &format!(
            "{} “{}”{size}: frames {first} to {last}, {mover} moves up to {moved:.3} m\n",
            kind.noun(),
            track.name
        );
    }
    Ok(text)
}
