//! Where two runs part.

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
    /// What differs in it.
    pub what: Parting,
}

/// What differs in the first frame that does.
#[derive(Clone, Debug, PartialEq)]
pub enum Parting {
    /// Something is at two places, or turned or scaled in two ways.
    Place {
        /// What it is: a body, ball or obstacle.
        noun: &'static str,
        /// Its name.
        name: String,
        /// The first of its particles at two places, if it is a body.
        particle: Option<usize>,
        /// Where it is in the first recording, in metres.
        first: Vec3,
        /// Where it is in the second.
        second: Vec3,
        /// How many places differ in this frame: particles, balls and obstacles.
        count: usize,
    },
    /// Something is there in one of them only.
    Presence {
        /// What it is.
        noun: &'static str,
        /// Its name.
        name: String,
        /// Whether it is there in the first recording.
        is_in_first: bool,
    },
    /// A body has another number of particles.
    Size {
        /// Its name.
        name: String,
        /// The number in each.
        particles: [usize; 2],
    },
    /// The clocks show two times, in seconds.
    Time([f64; 2]),
    /// One of them ends here; these are the numbers of their frames.
    End([usize; 2]),
}

impl Difference {
    /// How far apart the two places are, in metres; 0 where no place differs. It may be 0 where one does, too: what differs
    /// is then the sign of a zero, a rotation, or something below the precision of a world coordinate.
    pub fn distance(&self) -> f32 {
        match self.what {
            Parting::Place { first, second, .. } => first.distance(second),
            _ => 0.0,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frame, time, what } = self;
        write!(f, "the runs part at frame {frame} ({time:.6} s): ")?;
        match what {
            Parting::Place { noun, name, particle, first, second, count } => {
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
            Parting::Presence { noun, name, is_in_first } => {
                let which = if *is_in_first { "first" } else { "second" };
                write!(f, "{noun} “{name}” is in the {which} only")
            }
            Parting::Size { name, particles: [first, second] } => {
                write!(f, "body “{name}” has {first} particles in the first and {second} in the second")
            }
            Parting::Time([first, second]) => {
                write!(f, "it is at {first} s in the first and at {second} s in the second")
            }
            Parting::End([first, second]) => {
                write!(f, "the first has {first} frames and the second {second}")
            }
        }
    }
}

/// Where two recordings part; none if they are the same to the last bit. Things are compared by their names.
///
/// # Errors
/// [`RecordingError`] if a frame cannot be decoded; none that was loaded is such.
pub fn diff(first: &Recording, second: &Recording) -> Result<Option<Difference>, RecordingError> {
    let partner = partners(first.tracks(), second.tracks());
    let mut cursors = [first.cursor(), second.cursor()];
    let counts = [first.frame_count(), second.frame_count()];
    let mut time = 0.0;
    for frame in 0..counts[0].min(counts[1]) {
        let [one, other] = &mut cursors;
        let (one, other) = (one.seek(frame)?, other.seek(frame)?);
        time = one.time;
        if let Some(what) = parting([first.tracks(), second.tracks()], &partner, one, other) {
            return Ok(Some(Difference { frame, time, what }));
        }
    }
    let end = Difference { frame: counts[0].min(counts[1]), time, what: Parting::End(counts) };
    Ok((counts[0] != counts[1]).then_some(end))
}

/// For each track of the first the one of the second that has the same name: of several of a name, the first with the
/// first, and so on.
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

fn parting(
    tracks: [&[Track]; 2],
    partner: &[Option<usize>],
    first: &Frame,
    second: &Frame,
) -> Option<Parting> {
    if first.time.to_bits() != second.time.to_bits() {
        return Some(Parting::Time([first.time, second.time]));
    }
    let mut found: Option<Parting> = None;
    let mut paired = Vec::with_capacity(first.states.len());
    for one in &first.states {
        let Track { name, kind } = &tracks[0][one.track];
        let Some(other) = partner[one.track].and_then(|other| second.state(other)) else {
            return Some(Parting::Presence { noun: kind.noun(), name: name.clone(), is_in_first: true });
        };
        paired.push(other.track);
        if one.values.len() != other.values.len() {
            let particles = [one, other].map(|state| state.positions().len());
            return Some(Parting::Size { name: name.clone(), particles });
        }
        let places = differing_places(kind, one, other);
        match (&mut found, places.first()) {
            (Some(Parting::Place { count, .. }), _) => *count += places.len(),
            (_, Some(&place)) => {
                let is_body = matches!(kind, TrackKind::Body { .. });
                let [first, second] = [one, other].map(|state| {
                    if is_body {
                        state.positions().nth(place).unwrap_or(Vec3::NAN)
                    } else {
                        state.places(kind).first().copied().unwrap_or(Vec3::NAN)
                    }
                });
                found = Some(Parting::Place {
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
        return Some(Parting::Presence { noun: kind.noun(), name: name.clone(), is_in_first: false });
    }
    found
}

/// Indices of particles that differ; 0 for a ball or obstacle that does. All of a body's, where its origin does.
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
