//! The packing of binary files: values encoded by `postcard`, compressed as LZ4 frames.

use std::io::{Read, Write};

use lz4_flex::frame::{BlockMode, FrameDecoder, FrameEncoder, FrameInfo};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The greatest size of a value in bytes before compression, which bounds the memory that a damaged file can cost.
const MAX_BYTES: u64 = 256 << 20;

/// Packs a value, with LZ4's checksums of header, blocks and content.
pub(crate) fn pack(value: &impl Serialize) -> Result<Vec<u8>, String> {
    let plain = postcard::to_stdvec(value).map_err(|error| error.to_string())?;
    if plain.len() as u64 > MAX_BYTES {
        return Err(format!("it has {} bytes; the limit is {MAX_BYTES}", plain.len()));
    }
    let info = FrameInfo::new()
        .block_mode(BlockMode::Linked)
        .block_checksums(true)
        .content_checksum(true)
        .content_size(Some(plain.len() as u64));
    let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
    encoder.write_all(&plain).map_err(|error| error.to_string())?;
    encoder.finish().map_err(|error| error.to_string())
}

/// Unpacks a value that fills all of `bytes`. The error message completes a sentence about them.
pub(crate) fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    // The decoder accepts the end of its input as the end of the frame, even without the checksum.
    let is_whole = bytes.len().checked_sub(8).is_some_and(|end| bytes[end..].starts_with(&[0; 4]));
    if !is_whole {
        return Err("does not end with a checksum".into());
    }
    let mut decoder = FrameDecoder::new(bytes);
    let mut plain = Vec::new();
    // Grows with the decoded bytes, whatever size the frame claims to have.
    let read = decoder.by_ref().take(MAX_BYTES + 1).read_to_end(&mut plain);
    read.map_err(|error| format!("cannot be decompressed: {error}"))?;
    if plain.len() as u64 > MAX_BYTES {
        return Err(format!("holds more than {MAX_BYTES} bytes"));
    }
    if !decoder.get_ref().is_empty() {
        return Err("is followed by bytes that belong to nothing".into());
    }
    let (value, rest) = postcard::take_from_bytes(&plain)
        .map_err(|error| format!("holds something that cannot be decoded: {error}"))?;
    if rest.is_empty() { Ok(value) } else { Err("holds more than belongs to it".into()) }
}
