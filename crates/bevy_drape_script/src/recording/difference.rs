//! The first difference between two recordings.

use core::fmt;
use std::collections::BTreeMap;

use bevy::math::Vec3;

use super::error::RecordingError;
use super::frame::{Frame, State};
use super::reader::Recording;
use super::track::{Track, TrackKind};

/// The first frame in which two recordings are not the same to the last bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The frame, from 0.
    pub frame: usize,
    /// Its simulated time in the first recording, in seconds.
    pub time: f64,
    /// The difference itself.
    pub what: Mismatch,
}

/// The kind of a difference between two frames.
#[derive(Clone, Debug, PartialEq)]
pub enum Mismatch {
    /// Something differs in position, rotation or scale.
    Place {
        /// "body", "ball" or "obstacle".
        noun: &'static str,
        /// Its name.
        name: String,
        /// The first of its particles that differs, if it is a body.
        particle: Option<usize>,
        /// The position in the first recording, in metres.
        first: Vec3,
        /// The position in the second recording, in metres.
        second: Vec3,
        /// The number of particles, balls and obstacles that differ in this frame.
        count: usize,
    },
    /// Something exists in one of them only.
    Presence {
        /// "body", "ball" or "obstacle".
        noun: &'static str,
        /// Its name.
        name: String,
        /// True if it exists in the first recording.
        is_in_first: bool,
    },
    /// A body has different numbers of particles.
    Size {
        /// Its name.
        name: String,
        /// The number in each.
        particles: [usize; 2],
    },
    /// The simulated times differ, in seconds.
    Time([f64; 2]),
    /// One of them ends here. These are their numbers of frames.
    End([usize; 2]),
}

impl Difference {
    /// The distance between the two positions in metres; 0 if no position differs. It may also be 0 if only the sign of a zero
    /// or the rotation differs, or less than the precision of world coordinates.
    pub fn distance(&self) -> f32 {
        match self.what {
            Mismatch::Place { first, second, .. } => first.distance(second),
            _ => 0.0,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frame, time, what } = self;
        write!(f, "the runs part at frame {frame} ({time:.6} s): ")?;
        match what {
            Mismatch::Place { noun, name, particle, first, second, count } => {
                if let Some(particle) = particle {
                    write!(f, "particle {particle} of ")?;
                }
                let distance = self.distance();
                write!(f, "{noun} “{name}” is at {first} in the first and at {second} in the second, ")?;
                if distance > 0.0 {
                    write!(f, "{distance:e} m apart")?;
                } else {
                    f.write_str("apart by less than such numbers show")?;
                }
                write!(f, "; places that differ in this frame: {count}")
            }
            Mismatch::Presence { noun, name, is_in_first } => {
                let which = if *is_in_first { "first" } else { "second" };
                write!(f, "{noun} “{name}” is in the {which} only")
            }
            Mismatch::Size { name, particles: [first, second] } => {
                write!(f, "body “{name}” has {first} particles in the first and {second} in the second")
            }
            Mismatch::Time([first, second]) => {
                write!(f, "it is at {first} s in the first and at {second} s in the second")
            }
            Mismatch::End([first, second]) => {
                write!(f, "the first has {first} frames and the second {second}")
            }
        }
    }
}

/// The first difference between two recordings; none if they are equal to the last bit. Tracks are matched by name.
///
/// # Errors
/// [`RecordingError`] if a frame cannot be decoded, which does not happen to recordings that were loaded.
pub fn diff(first: &Recording, second: &Recording) -> Result<Option<Difference>, RecordingError> {
    let partner = partners(first.tracks(), second.tracks());
    let mut cursors = [first.cursor(), second.cursor()];
    let counts = [first.frame_count(), second.frame_count()];
    let mut time = 0.0;
    for frame in 0..counts[0].min(counts[1]) {
        let [one, other] = &mut cursors;
        let (one, other) = (one.seek(frame)?, other.seek(frame)?);
        time = one.time;
        if let Some(what) = mismatch([first.tracks(), second.tracks()], &partner, one, other) {
            return Ok(Some(Difference { frame, time, what }));
        }
    }
    let end = Difference { frame: counts[0].min(counts[1]), time, what: Mismatch::End(counts) };
    Ok((counts[0] != counts[1]).then_some(end))
}

/// For each track of the first recording, the track of the second with the same name. Tracks that share a name are matched in
/// order.
fn partners(first: &[Track], second: &[Track]) -> Vec<Option<usize>> {
    fn key(track: &Track) -> (&str, &str) {
        (track.kind.noun(), &track.name)
    }
    let mut by_name: BTreeMap<(&str, &str), Vec<usize>> = BTreeMap::new();
    for (index, track) in second.iter().enumerate().rev() {
        by_name.entry(key(track)).or_default().push(index);
    }
    first.iter().map(|track| by_name.get_mut(&key(track)).and_then(Vec::pop)).collect()
}

/// The difference between two frames.
fn mismatch(
    tracks: [&[Track]; 2],
    partner: &[Option<usize>],
    first: &Frame,
    second: &Frame,
) -> Option<Mismatch> {
    if first.time.to_bits() != second.time.to_bits() {
        return Some(Mismatch::Time([first.time, second.time]));
    }
    let mut found: Option<Mismatch> = None;
    let mut paired = Vec::with_capacity(first.states.len());
    for one in &first.states {
        let Track { name, kind } = &tracks[0][one.track];
        let Some(other) = partner[one.track].and_then(|other| second.state(other)) else {
            return Some(Mismatch::Presence { noun: kind.noun(), name: name.clone(), is_in_first: true });
        };
        paired.push(other.track);
        if one.values.len() != other.values.len() {
            let particles = [one, other].map(|state| state.positions().len());
            return Some(Mismatch::Size { name: name.clone(), particles });
        }
        let places = differing_places(kind, one, other);
        match (&mut found, places.first()) {
            (Some(Mismatch::Place { count, .. }), _) => *count += places.len(),
            (_, Some(&place)) => {
                let is_body = matches!(kind, TrackKind::Body { .. });
                let [first, second] = [one, other].map(|state| {
                    if is_body {
                        state.positions().nth(place).unwrap_or(Vec3::NAN)
                    } else {
                        state.places(kind).first().copied().unwrap_or(Vec3::NAN)
                    }
                });
                found = Some(Mismatch::Place {
                    noun: kind.noun(),
                    name: name.clone(),
                    particle: is_body.then_some(place),
                    first,
                    second,
                    count: places.len(),
                });
            }
            (_, None) => {}
        }
    }
    paired.sort_unstable();
    let is_alone = |state: &&State| paired.binary_search(&state.track).is_err();
    if let Some(state) = second.states.iter().find(is_alone) {
        let Track { name, kind } = &tracks[1][state.track];
        return Some(Mismatch::Presence { noun: kind.noun(), name: name.clone(), is_in_first: false });
    }
    found
}

/// The indices of particles that differ, or 0 for a ball or obstacle. All particles differ if the origin of the body does.
fn differing_places(kind: &TrackKind, one: &State, other: &State) -> Vec<usize> {
    let differ = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
    if !matches!(kind, TrackKind::Body { .. }) {
        return if one.values.iter().zip(&other.values).any(differ) { vec![0] } else { Vec::new() };
    }
    let [of_one, of_other] = [one, other].map(|state| state.values.as_chunks::<3>().0);
    let mut places = of_one.iter().zip(of_other).map(|(a, b)| a.iter().zip(b).any(differ));
    let is_origin_moved = places.next().unwrap_or(false);
    places.enumerate().filter(|&(_, differs)| differs || is_origin_moved).map(|(place, _)| place).collect()
}
