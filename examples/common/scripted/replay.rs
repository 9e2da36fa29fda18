//! A recording without a window: its contents, and the first difference from another.

use core::fmt;
use std::path::{Path, PathBuf};

use bevy::math::Vec3;
use bevy_drape_script::recording::{Recording, RecordingError, diff};
use thiserror::Error;

use crate::scripted::suite::tell;

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

/// Prints the contents of a recording, and the first difference from `other`. Returns true if there is none.
///
/// # Errors
/// [`ReplayError`] if one of them cannot be read, or is damaged.
pub fn run(path: &Path, other: Option<&Path>) -> Result<bool, ReplayError> {
    let recording = load(path)?;
    let Some(other) = other else {
        let failed = |source| ReplayError { path: path.to_path_buf(), source };
        tell(&summary(&recording).map_err(failed)?);
        return Ok(true);
    };
    let second = load(other)?;
    let parted = diff(&recording, &second);
    match parted.map_err(|source| ReplayError { path: other.to_path_buf(), source })? {
        None => {
            tell(&format_args!(
                "the runs are the same to the last bit, in {} frames\n",
                recording.frame_count()
            ));
            Ok(true)
        }
        Some(difference) => {
            tell(&format_args!("{difference}\n"));
            Ok(false)
        }
    }
}

/// The motion of a track.
#[derive(Default)]
struct Span {
    /// Its first and last frame.
    frames: Option<(usize, usize)>,
    /// The first positions, one for each particle.
    start: Vec<Vec3>,
    /// The corners of the box in which it always was.
    bounds: Option<(Vec3, Vec3)>,
    /// The farthest that any particle was from where it was first, in metres.
    displacement: f32,
}

impl Span {
    fn note(&mut self, frame: usize, places: Vec<Vec3>) {
        self.frames = Some((self.frames.map_or(frame, |(first, _)| first), frame));
        for (index, &place) in places.iter().enumerate() {
            let (least, greatest) = self.bounds.unwrap_or((place, place));
            self.bounds = Some((least.min(place), greatest.max(place)));
            let start = self.start.get(index).copied().unwrap_or(place);
            self.displacement = self.displacement.max(place.distance(start));
        }
        if self.start.is_empty() {
            self.start = places;
        }
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some((first, last)), Some((least, greatest))) = (self.frames, self.bounds) else {
            return f.write_str("in no frame");
        };
        let displacement = self.displacement;
        write!(
            f,
            "frames {first} to {last}, moves up to {displacement:.3} m, between {least:.3} and {greatest:.3}"
        )
    }
}

/// The contents of a recording, in a few lines.
fn summary(recording: &Recording) -> Result<String, RecordingError> {
    let (header, frames) = (recording.header(), recording.frame_count());
    let mut cursor = recording.cursor();
    let mut values = 0;
    let mut times = [0.0; 2];
    let mut spans: Vec<Span> = recording.tracks().iter().map(|_| Span::default()).collect();
    for index in 0..frames {
        let frame = cursor.seek(index)?;
        times = [if index == 0 { frame.time } else { times[0] }, frame.time];
        for state in &frame.states {
            values += state.values().len();
            spans[state.track].note(index, state.places(&recording.tracks()[state.track].kind));
        }
    }
    let (plain, bytes) = (4 * values, recording.byte_count());
    let ratio = plain as f64 / bytes.max(1) as f64;
    let mut text = format!(
        "scene “{}”, {frames} frames of {} s, from {:.3} s to {:.3} s\n{bytes} bytes, {ratio:.1} times less than the plain numbers\n",
        header.scene, header.dt, times[0], times[1],
    );
    for (track, span) in recording.tracks().iter().zip(spans) {
        let kind = &track.kind;
        let size = kind.particles().map_or_else(String::new, |count| format!(", {count} particles"));
        text += &format!("{} “{}”{size}: {span}\n", kind.noun(), track.name);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_that_of_all_particles() {
        let mut span = Span::default();
        span.note(3, vec![Vec3::ZERO, Vec3::X]);
        span.note(4, vec![Vec3::ZERO, Vec3::new(1.0, -2.0, 0.0)]);
        span.note(5, vec![Vec3::ZERO, Vec3::X]);
        let told = span.to_string();
        assert_eq!(
            told,
            "frames 3 to 5, moves up to 2.000 m, between [0.000, -2.000, 0.000] and [1.000, 0.000, 0.000]"
        );
        assert_eq!(Span::default().to_string(), "in no frame");
    }
}
