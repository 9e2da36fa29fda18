//! Errors of recordings.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// A recording that cannot be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The recording cannot be written.
    #[error("cannot write the recording: {0}")]
    Unwritable(#[from] io::Error),
    /// Something cannot be written in this format.
    #[error("cannot encode {what}: {reason}")]
    Unencodable {
        /// The part that was to be written.
        what: String,
        /// The problem with it.
        reason: String,
    },
    /// The bytes are no recording at all.
    #[error("this is no recording: it does not begin with “DRAPEREC”")]
    NotARecording,
    /// The recording was made by a later version.
    #[error("the recording has version {found} of the format; this program reads up to {known}")]
    NewerVersion {
        /// The version of the recording.
        found: u32,
        /// The latest version that this program reads.
        known: u32,
    },
    /// The bytes end too early: the file was cut off, or its recorder did not finish.
    #[error("the recording breaks off at byte {offset}, within {part}: it was cut off, or never finished")]
    Truncated {
        /// The number of bytes of the file.
        offset: usize,
        /// The incomplete part.
        part: String,
    },
    /// The bytes are not what a recorder writes.
    #[error("the recording is damaged: {part}, which begins at byte {offset}, {reason}")]
    Damaged {
        /// The offset of the damaged part in bytes.
        offset: usize,
        /// The damaged part.
        part: String,
        /// The problem with it.
        reason: String,
    },
    /// There is no such frame.
    #[error("there is no frame {index}: the recording has {count}")]
    NoSuchFrame {
        /// The requested frame, from 0.
        index: usize,
        /// The number of frames.
        count: usize,
    },
}
