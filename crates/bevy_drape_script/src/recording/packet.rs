//! The packets of a recording: a preamble that names the format, then a header, blocks of frames, and an end.
//!
//! ```text
//! "DRAPEREC" | version, u32 | packet | packet | ... | end packet
//!
//! packet:  length of the frame in bytes, u32 | LZ4 frame with the checksums of its header, blocks and content
//! ```
//!
//! Numbers are little-endian, the contents of packets encoded by `postcard`. The end packet marks a complete file: without
//! it, one that was cut off between two packets would go unnoticed. Reading ends with a recording or a
//! [`RecordingError`], whatever the bytes are.

use std::io::Write;

use serde::{Deserialize, Serialize};

use super::block::Block;
use super::error::RecordingError;
use crate::container::{pack, unpack};

/// The first bytes of every recording.
const MAGIC: [u8; 8] = *b"DRAPEREC";
/// The version of the format that is written, and the latest that is read.
const VERSION: u32 = 1;

/// The scene and the step of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// The name of the scene.
    pub scene: String,
    /// Length of a step in seconds.
    pub dt: f32,
}

/// A part of a recording.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Packet {
    /// The first packet.
    Header(Header),
    /// Some frames.
    Block(Block),
    /// The last packet.
    End {
        /// The number of frames in all blocks.
        frames: u64,
    },
}

/// Writes magic and version.
pub(super) fn write_preamble(to: &mut impl Write) -> Result<(), RecordingError> {
    to.write_all(&MAGIC)?;
    to.write_all(&VERSION.to_le_bytes())?;
    Ok(())
}

/// Appends a packet.
pub(super) fn write(to: &mut impl Write, packet: &Packet) -> Result<(), RecordingError> {
    let unencodable = |reason| RecordingError::Unencodable { what: "a packet".into(), reason };
    let frame = pack(packet).map_err(unencodable)?;
    let length = u32::try_from(frame.len()).map_err(|error| unencodable(error.to_string()))?;
    to.write_all(&length.to_le_bytes())?;
    to.write_all(&frame)?;
    Ok(())
}

/// Reads a recording packet by packet.
pub(super) struct Packets<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Packets<'a> {
    /// Checks magic and version.
    pub fn new(bytes: &'a [u8]) -> Result<Self, RecordingError> {
        let mut packets = Self { bytes, offset: 0 };
        let magic = &bytes[..bytes.len().min(MAGIC.len())];
        if magic.is_empty() || !MAGIC.starts_with(magic) {
            return Err(RecordingError::NotARecording);
        }
        packets.take(MAGIC.len(), "its beginning")?;
        let version = packets.take_u32("its beginning")?;
        if version > VERSION {
            return Err(RecordingError::NewerVersion { found: version, known: VERSION });
        }
        if version == 0 {
            return Err(packets.damaged(MAGIC.len(), "its version", "is 0, which never was".into()));
        }
        Ok(packets)
    }

    /// The offset of the next packet in bytes.
    pub fn offset(&self) -> usize {
        self.offset
    }

    /// True once all bytes have been read.
    pub fn is_at_end(&self) -> bool {
        self.offset == self.bytes.len()
    }

    /// The next packet, called `part` in errors.
    pub fn next(&mut self, part: &str) -> Result<Packet, RecordingError> {
        let start = self.offset;
        let length = self.take_u32(part)?;
        let frame = self.take(length as usize, part)?;
        unpack(frame).map_err(|reason| self.damaged(start, part, reason))
    }

    /// An error about a part that begins at `offset`.
    pub fn damaged(&self, offset: usize, part: &str, reason: String) -> RecordingError {
        RecordingError::Damaged { offset, part: part.into(), reason }
    }

    fn take_u32(&mut self, part: &str) -> Result<u32, RecordingError> {
        let bytes = self.take(4, part)?;
        // Four bytes, so nothing is shifted out.
        Ok(bytes.iter().rev().fold(0, |number, &byte| (number << 8) | u32::from(byte)))
    }

    fn take(&mut self, count: usize, part: &str) -> Result<&'a [u8], RecordingError> {
        let rest = &self.bytes[self.offset..];
        let Some(taken) = rest.get(..count) else {
            return Err(RecordingError::Truncated { offset: self.bytes.len(), part: part.into() });
        };
        self.offset += count;
        Ok(taken)
    }
}
