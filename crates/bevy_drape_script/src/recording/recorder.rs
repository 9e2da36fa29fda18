//! Writes recordings step by step.

use std::io::Write;

use super::block::{Block, FrameCodec};
use super::error::RecordingError;
use super::packet::{Header, Packet, write, write_preamble};
use super::track::Track;

/// Frames per block. At most as many have to be decoded to show one.
const FRAMES_PER_BLOCK: usize = 64;
/// The approximate size in bytes at which a block ends early.
const BLOCK_BYTES: usize = 8 << 20;

/// Writes a recording to a file or any other writer while the steps are taken. Keeps no more than a block in memory.
///
/// [`Recording`](super::Recording) rejects a recording that was not [finished](Self::finish).
///
/// ```
/// use bevy_drape_script::recording::{Header, Recorder, Recording, Sample, Track, TrackKind};
///
/// # fn main() -> Result<(), bevy_drape_script::recording::RecordingError> {
/// let mut recorder = Recorder::new(Vec::new(), Header { scene: "a falling point".into(), dt: 0.1 })?;
/// for step in 0..10 {
///     let track = || Track {
///         name: "point".into(),
///         kind: TrackKind::Body { particles: 1, faces: vec![], sticks: vec![] },
///     };
///     let time = 0.1 * f64::from(step);
///     let height = 10.0 - 4.9 * (time * time) as f32;
///     recorder.push(time, vec![Sample::body(7, track, [0.0; 3], [[0.0, height, 0.0]].into_iter())])?;
/// }
/// let recording = Recording::from_bytes(recorder.finish()?)?;
/// let mut cursor = recording.cursor();
/// let position = cursor.seek(5)?.states[0].positions().next();
/// assert!(position.is_some_and(|position| (position.y - 8.775).abs() < 1e-6));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Recorder<W: Write> {
    writer: W,
    codec: FrameCodec,
    block: Block,
    block_bytes: usize,
    frames: u64,
    track_count: u32,
    /// The tracks of the last frame, sorted by id.
    known: Vec<KnownTrack>,
}

/// A track of the last frame.
#[derive(Debug)]
struct KnownTrack {
    id: u64,
    track: u32,
    value_count: usize,
}

/// The current state of something that is recorded.
pub struct Sample<'a> {
    /// Identifies it while it exists.
    pub id: u64,
    /// Describes it. Called once, in its first frame.
    pub describe: Box<dyn FnOnce() -> Track + 'a>,
    /// Its numbers, as many as the [kind](super::TrackKind) of its track demands.
    pub values: Vec<f32>,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// [`RecordingError::Unwritable`] if the writer fails.
    pub fn new(mut writer: W, header: Header) -> Result<Self, RecordingError> {
        write_preamble(&mut writer)?;
        write(&mut writer, &Packet::Header(header))?;
        Ok(Self {
            writer,
            codec: FrameCodec::default(),
            block: Block::default(),
            block_bytes: 0,
            frames: 0,
            track_count: 0,
            known: Vec::new(),
        })
    }

    /// The number of frames so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Appends a frame: samples of everything that exists at `time`, the simulated time in seconds.
    ///
    /// # Errors
    /// [`RecordingError::Unencodable`] if a sample does not have as many numbers as its kind demands, or two have the same id;
    /// [`RecordingError::Unwritable`] if the writer fails.
    pub fn push(&mut self, time: f64, samples: Vec<Sample>) -> Result<(), RecordingError> {
        let mut begun = Vec::new();
        let mut states = Vec::with_capacity(samples.len());
        let mut present = Vec::with_capacity(samples.len());
        let first = self.track_count;
        let mut next = first;
        for Sample { id, describe, values } in samples {
            let value_count = values.len();
            let known = self.known.binary_search_by_key(&id, |known| known.id).ok();
            let known =
                known.map(|place| &self.known[place]).filter(|known| known.value_count == value_count);
            let track = match known {
                Some(known) => known.track,
                None => {
                    let track = describe();
                    check(&track, value_count)?;
                    begun.push(track);
                    next += 1;
                    next - 1
                }
            };
            present.push(KnownTrack { id, track, value_count });
            states.push((track, values));
        }
        present.sort_unstable_by_key(|known| known.id);
        if let Some(pair) = present.windows(2).find(|pair| pair[0].id == pair[1].id) {
            let what = format!("a frame at {time} s");
            let reason = format!("two things in it have the id {}", pair[0].id);
            return Err(RecordingError::Unencodable { what, reason });
        }
        states.sort_unstable_by_key(|&(track, _)| track);
        let is_present = |track| states.binary_search_by_key(&track, |&(track, _)| track).is_ok();
        let mut ended: Vec<u32> =
            self.known.iter().map(|known| known.track).filter(|&track| !is_present(track)).collect();
        ended.sort_unstable();
        self.known = present;
        self.track_count = next;
        let states = states.into_iter().map(|(_, values)| values).collect();
        let (frame, bytes) = self.codec.encode(time, ended, begun, first, states);
        self.block.frames.push(frame);
        self.block_bytes += bytes;
        self.frames += 1;
        if self.block.frames.len() >= FRAMES_PER_BLOCK || self.block_bytes >= BLOCK_BYTES {
            self.flush_block()?;
        }
        Ok(())
    }

    /// Writes the last block, and the end.
    ///
    /// # Errors
    /// [`RecordingError::Unwritable`] if the writer fails.
    pub fn finish(mut self) -> Result<W, RecordingError> {
        if !self.block.frames.is_empty() {
            self.flush_block()?;
        }
        write(&mut self.writer, &Packet::End { frames: self.frames })?;
        self.writer.flush()?;
        Ok(self.writer)
    }

    fn flush_block(&mut self) -> Result<(), RecordingError> {
        let block = core::mem::replace(&mut self.block, self.codec.begin_block());
        self.block_bytes = 0;
        write(&mut self.writer, &Packet::Block(block))
    }
}

fn check(track: &Track, value_count: usize) -> Result<(), RecordingError> {
    let fault = if track.kind.value_count() != value_count {
        format!("a {} has {} numbers, not {value_count}", track.kind.noun(), track.kind.value_count())
    } else if !track.kind.is_sound() {
        "it joins particles that it does not have".into()
    } else {
        return Ok(());
    };
    Err(RecordingError::Unencodable { what: format!("“{}”", track.name), reason: fault })
}

impl<'a> Sample<'a> {
    /// A body: its origin, and the positions of its particles relative to that, all in metres.
    pub fn body(
        id: u64,
        describe: impl FnOnce() -> Track + 'a,
        origin: [f32; 3],
        positions: impl Iterator<Item = [f32; 3]>,
    ) -> Self {
        let values = core::iter::once(origin).chain(positions).flatten().collect();
        Self { id, describe: Box::new(describe), values }
    }
}
