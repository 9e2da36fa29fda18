//! Reads recordings, checks them as a whole, and shows any frame.

use core::borrow::Borrow;
use core::ops::Range;
use std::path::Path;

use super::block::{Block, FrameCodec};
use super::error::RecordingError;
use super::frame::Frame;
use super::packet::{Header, Packet, Packets};
use super::track::Track;
use crate::container::unpack;

/// A recording in memory, compressed as in its file. It was checked as a whole.
#[derive(Clone, Debug)]
pub struct Recording {
    header: Header,
    tracks: Vec<Track>,
    bytes: Vec<u8>,
    blocks: Vec<BlockEntry>,
    frame_count: usize,
}

/// The place of a block in its recording.
#[derive(Clone, Debug)]
struct BlockEntry {
    /// The range of its compressed bytes.
    range: Range<usize>,
    /// The number of frames before it.
    first_frame: usize,
    /// The number of tracks that begin before it.
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

    /// Takes the bytes of a recording, and decodes them once to check them.
    ///
    /// # Errors
    /// [`RecordingError`] if they are no recording, one of a later version, cut off, or damaged.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, RecordingError> {
        let mut packets = Packets::new(&bytes)?;
        let start = packets.offset();
        let Packet::Header(header) = packets.next("its header")? else {
            return Err(packets.damaged(start, "its header", "is something else".into()));
        };
        let mut tracks = Vec::new();
        let mut blocks = Vec::new();
        let mut frame_count = 0;
        let mut codec = FrameCodec::default();
        loop {
            let start = packets.offset();
            let part = format!("block {}", blocks.len());
            match packets.next(&part)? {
                Packet::Block(block) => {
                    // Its length stands in front of it.
                    let range = start + size_of::<u32>()..packets.offset();
                    blocks.push(BlockEntry { range, first_frame: frame_count, first_track: tracks.len() });
                    check(&block, &mut codec, &mut tracks)
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

    /// The scene and the length of a step.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Everything that was recorded, in the order of appearance.
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

    /// A cursor on its frames. Frames in order cost the least, but any can be shown at any time.
    pub fn cursor(&self) -> Cursor<&Self> {
        Cursor::new(self)
    }

    /// A cursor that owns the recording.
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

/// Decodes a block with all its frames, and appends the tracks that begin with it.
fn check(block: &Block, codec: &mut FrameCodec, tracks: &mut Vec<Track>) -> Result<(), String> {
    if !codec.agrees_with(block) {
        return Err("does not begin with what the one before it ended with".into());
    }
    if block.frames.is_empty() {
        return Err("has no frames".into());
    }
    codec.enter_block(block, tracks)?;
    for frame in &block.frames {
        let first = tracks.len();
        codec.decode(frame, first, tracks)?;
    }
    Ok(())
}

/// Shows the frames of a recording.
#[derive(Debug)]
pub struct Cursor<R> {
    recording: R,
    /// The index and content of the block that is being decoded.
    block: Option<(usize, Block)>,
    /// The number of its frames that have been decoded.
    decoded: usize,
    /// The number of tracks that have begun until then.
    begun: usize,
    codec: FrameCodec,
    frame: Frame,
}

impl<R: Borrow<Recording>> Cursor<R> {
    fn new(recording: R) -> Self {
        Self {
            recording,
            block: None,
            decoded: 0,
            begun: 0,
            codec: FrameCodec::default(),
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
        let Self { recording, block: current, decoded, begun, codec, frame } = self;
        let recording: &Recording = (*recording).borrow();
        let count = recording.frame_count;
        if index >= count {
            return Err(RecordingError::NoSuchFrame { index, count });
        }
        let wanted = recording.blocks.partition_point(|entry| entry.first_frame <= index) - 1;
        let entry = &recording.blocks[wanted];
        let damaged = |reason| RecordingError::Damaged {
            offset: entry.range.start,
            part: format!("block {wanted}"),
            reason,
        };
        let goal = index - entry.first_frame;
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
            codec.enter_block(&block, &recording.tracks).map_err(damaged)?;
            *begun = entry.first_track;
        }
        // All tracks are known already, so none is added.
        let mut none = Vec::new();
        while *decoded <= goal {
            let coded = &block.frames[*decoded];
            none.clear();
            codec.decode(coded, *begun, &mut none).map_err(damaged)?;
            *begun += coded.begun();
            *decoded += 1;
        }
        codec.show(&block.frames[goal], frame);
        *current = Some((wanted, block));
        Ok(frame)
    }
}
