//! Reads a recording: checks all of it, and shows any frame.

use core::borrow::Borrow;
use core::ops::Range;
use std::path::Path;

use super::block::{Block, Progress};
use super::error::RecordingError;
use super::frame::Frame;
use super::packet::{Header, Packet, Packets};
use super::track::Track;
use crate::container::unpack;

/// A recording in memory, compressed as it is in its file. All of it has been checked.
#[derive(Clone, Debug)]
pub struct Recording {
    header: Header,
    tracks: Vec<Track>,
    bytes: Vec<u8>,
    blocks: Vec<Place>,
    frame_count: usize,
}

/// Where a block is.
#[derive(Clone, Debug)]
struct Place {
    /// Its compressed bytes.
    range: Range<usize>,
    /// The number of frames before it.
    first_frame: usize,
    /// The number of tracks that come before it.
    first_track: usize,
}

impl Recording {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`RecordingError::Unreadable`] if the file cannot be read; else as [`from_bytes`](Self::from_bytes).
    pub fn load(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path)
            .map_err(|source| RecordingError::Unreadable { path: path.to_path_buf(), source })?;
        Self::from_bytes(bytes)
    }

    /// Takes the bytes of a recording, and decodes them once to check that all is well.
    ///
    /// # Errors
    /// [`RecordingError`] if they are no recording, or one of a later version, or cut off, or damaged.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, RecordingError> {
        let mut packets = Packets::new(&bytes)?;
        let start = packets.offset();
        let Packet::Header(header) = packets.next("its header")? else {
            return Err(packets.damaged(start, "its header", "is something else".into()));
        };
        let mut tracks = Vec::new();
        let mut blocks = Vec::new();
        let mut frame_count = 0;
        let mut progress = Progress::default();
        loop {
            let start = packets.offset();
            let part = format!("block {}", blocks.len());
            match packets.next(&part)? {
                Packet::Block(block) => {
                    // Its length is in front of it.
                    let range = start + size_of::<u32>()..packets.offset();
                    blocks.push(Place { range, first_frame: frame_count, first_track: tracks.len() });
                    check(&block, &mut progress, &mut tracks)
                        .map_err(|reason| packets.damaged(start, &part, reason))?;
                    frame_count += block.frames.len();
                }
                Packet::End { frames } if frames == frame_count as u64 && packets.is_at_end() => break,
                Packet::End { frames } if frames == frame_count as u64 => {
                    let reason = "is followed by bytes that belong to nothing".into();
                    return Err(packets.damaged(start, "its end", reason));
                }
                Packet::End { frames } => {
                    let reason = format!("says that there are {frames} frames instead of {frame_count}");
                    return Err(packets.damaged(start, "its end", reason));
                }
                Packet::Header(_) => {
                    return Err(packets.damaged(start, &part, "is a second header".into()));
                }
            }
        }
        Ok(Self { header, tracks, bytes, blocks, frame_count })
    }

    /// What it is of.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Everything that is recorded, in the order in which it came.
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// The number of frames.
    pub fn frame_count(&self) -> usize {
        self.frame_count
    }

    /// Its size in bytes.
    pub fn byte_count(&self) -> usize {
        self.bytes.len()
    }

    /// What shows frames of it. Frames in order cost the least, but any can be shown at any time.
    pub fn cursor(&self) -> Cursor<&Self> {
        Cursor::new(self)
    }

    /// The same, and keeps the recording.
    pub fn into_cursor(self) -> Cursor<Self> {
        Cursor::new(self)
    }

    fn block(&self, index: usize) -> Result<Block, RecordingError> {
        let range = self.blocks[index].range.clone();
        let offset = range.start;
        let damaged = |reason| RecordingError::Damaged { offset, part: format!("block {index}"), reason };
        match unpack(&self.bytes[range]) {
            Ok(Packet::Block(block)) => Ok(block),
            Ok(_) => Err(damaged("is something else".into())),
            Err(reason) => Err(damaged(reason)),
        }
    }
}

/// Decodes a block with all its frames, and appends the tracks that come with it.
fn check(block: &Block, progress: &mut Progress, tracks: &mut Vec<Track>) -> Result<(), String> {
    if !progress.agrees_with(block) {
        return Err("does not begin with what the one before it ended with".into());
    }
    if block.frames.is_empty() {
        return Err("has no frames".into());
    }
    progress.enter_block(block, tracks)?;
    for frame in &block.frames {
        let first = tracks.len();
        progress.decode(frame, first, tracks)?;
    }
    Ok(())
}

/// Shows one frame of a recording after another.
#[derive(Debug)]
pub struct Cursor<R> {
    recording: R,
    /// The block that is decoded, by index.
    block: Option<(usize, Block)>,
    /// The number of its frames that have been decoded, and of the tracks that have come until then.
    decoded: usize,
    come: usize,
    progress: Progress,
    frame: Frame,
}

impl<R: Borrow<Recording>> Cursor<R> {
    fn new(recording: R) -> Self {
        Self {
            recording,
            block: None,
            decoded: 0,
            come: 0,
            progress: Progress::default(),
            frame: Frame::default(),
        }
    }

    /// The recording that it shows.
    pub fn recording(&self) -> &Recording {
        self.recording.borrow()
    }

    /// Shows frame `index`, from 0.
    ///
    /// # Errors
    /// [`RecordingError::NoSuchFrame`] beyond the last.
    pub fn seek(&mut self, index: usize) -> Result<&Frame, RecordingError> {
        let Self { recording, block: current, decoded, come, progress, frame } = self;
        let recording: &Recording = (*recording).borrow();
        let count = recording.frame_count;
        if index >= count {
            return Err(RecordingError::NoSuchFrame { index, count });
        }
        let wanted = recording.blocks.partition_point(|place| place.first_frame <= index) - 1;
        let place = &recording.blocks[wanted];
        let damaged = |reason| RecordingError::Damaged {
            offset: place.range.start,
            part: format!("block {wanted}"),
            reason,
        };
        let goal = index - place.first_frame;
        let block = match current.take() {
            Some((at, block)) if at == wanted && *decoded <= goal + 1 => block,
            Some((at, block)) if at == wanted => {
                *decoded = 0;
                block
            }
            _ => {
                *decoded = 0;
                recording.block(wanted)?
            }
        };
        if *decoded == 0 {
            progress.enter_block(&block, &recording.tracks).map_err(damaged)?;
            *come = place.first_track;
        }
        // All tracks are known, so that none is added.
        let mut none = Vec::new();
        while *decoded <= goal {
            let coded = &block.frames[*decoded];
            none.clear();
            progress.decode(coded, *come, &mut none).map_err(damaged)?;
            *come += coded.come();
            *decoded += 1;
        }
        progress.show(&block.frames[goal], frame);
        *current = Some((wanted, block));
        Ok(frame)
    }
}
