//! Writes a recording, step by step.

use std::io::Write;

use super::block::{Block, Progress};
use super::error::RecordingError;
use super::packet::{Header, Packet, write, write_beginning};
use super::track::Track;

/// Frames in a block: to show one, at most as many have to be decoded.
const FRAMES_PER_BLOCK: usize = 64;
/// A block ends early once it has about so many bytes.
const BLOCK_BYTES: usize = 8 << 20;

/// Writes a recording to a file, or to any other writer, as the steps are taken. It keeps no more than a block.
///
/// A recording that was not [finished](Self::finish) is refused by [`Recording`](super::Recording).
#[derive(Debug)]
pub struct Recorder<W: Write> {
    writer: W,
    progress: Progress,
    block: Block,
    block_bytes: usize,
    frames: u64,
    track_count: u32,
    /// What was there in the last frame, by id.
    known: Vec<Known>,
}

/// Something that was there in the last frame.
#[derive(Debug)]
struct Known {
    id: u64,
    track: u32,
    value_count: usize,
}

/// Something to be recorded as it is now.
pub struct Seen<'a> {
    /// What tells it from all others while it is there.
    pub id: u64,
    /// Describes it; asked once, when it has just come.
    pub describe: Box<dyn FnOnce() -> Track + 'a>,
    /// Its numbers, as many as the [kind](super::TrackKind) of its track has.
    pub values: Vec<f32>,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// [`RecordingError::Unwritable`] if the writer fails.
    pub fn new(mut writer: W, header: Header) -> Result<Self, RecordingError> {
        write_beginning(&mut writer)?;
        write(&mut writer, &Packet::Header(header))?;
        Ok(Self {
            writer,
            progress: Progress::default(),
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

    /// Appends a frame: all that is there at `time` (simulated, in seconds).
    ///
    /// # Errors
    /// [`RecordingError::Unencodable`] if something does not have as many numbers as its kind tells, or two things have the
    /// same id;
    /// [`RecordingError::Unwritable`] if the writer fails.
    pub fn push(&mut self, time: f64, seen: Vec<Seen>) -> Result<(), RecordingError> {
        let mut come = Vec::new();
        let mut states = Vec::with_capacity(seen.len());
        let mut there = Vec::with_capacity(seen.len());
        let first = self.track_count;
        let mut next = first;
        for Seen { id, describe, values } in seen {
            let value_count = values.len();
            let known = self.known.binary_search_by_key(&id, |known| known.id).ok();
            let known =
                known.map(|place| &self.known[place]).filter(|known| known.value_count == value_count);
            let track = match known {
                Some(known) => known.track,
                None => {
                    let track = describe();
                    check(&track, value_count)?;
                    come.push(track);
                    next += 1;
                    next - 1
                }
            };
            there.push(Known { id, track, value_count });
            states.push((track, values));
        }
        there.sort_unstable_by_key(|known| known.id);
        if let Some(pair) = there.windows(2).find(|pair| pair[0].id == pair[1].id) {
            let what = format!("a frame at {time} s");
            let reason = format!("two things in it have the id {}", pair[0].id);
            return Err(RecordingError::Unencodable { what, reason });
        }
        states.sort_unstable_by_key(|&(track, _)| track);
        let is_here = |track| states.binary_search_by_key(&track, |&(track, _)| track).is_ok();
        let mut gone: Vec<u32> =
            self.known.iter().map(|known| known.track).filter(|&track| !is_here(track)).collect();
        gone.sort_unstable();
        self.known = there;
        self.track_count = next;
        let states = states.into_iter().map(|(_, values)| values).collect();
        let (frame, bytes) = self.progress.encode(time, gone, come, first, states);
        self.block.frames.push(frame);
        self.block_bytes += bytes;
        self.frames += 1;
        if self.block.frames.len() >= FRAMES_PER_BLOCK || self.block_bytes >= BLOCK_BYTES {
            self.flush_block()?;
        }
        Ok(())
    }

    /// Writes what is left, and the end.
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
        let block = core::mem::replace(&mut self.block, self.progress.begin_block());
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

impl<'a> Seen<'a> {
    /// A body with these particles' `origin` and `places` relative to it.
    pub fn body(
        id: u64,
        describe: impl FnOnce() -> Track + 'a,
        origin: [f32; 3],
        places: impl Iterator<Item = [f32; 3]>,
    ) -> Self {
        let values = core::iter::once(origin).chain(places).flatten().collect();
        Self { id, describe: Box::new(describe), values }
    }
}
