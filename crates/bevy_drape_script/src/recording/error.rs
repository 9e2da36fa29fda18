//! What can be wrong with a recording.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

/// Why a recording cannot be written, or is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened or read.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The recording cannot be written.
    #[error("cannot write the recording: {0}")]
    Unwritable(#[from] io::Error),
    /// Something cannot be written in this format.
    #[error("cannot encode {what}: {reason}")]
    Unencodable {
        /// What was to be written.
        what: String,
        /// What is wrong with it.
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
        /// The last version that is known here.
        known: u32,
    },
    /// The bytes end too early: the file was cut off, or its recorder was not finished.
    #[error("the recording breaks off at byte {offset}, within {part}: it was cut off, or never finished")]
    Truncated {
        /// The number of bytes that are there.
        offset: usize,
        /// The part that is not complete.
        part: String,
    },
    /// The bytes are not what a recorder writes.
    #[error("the recording is damaged: {part}, which begins at byte {offset}, {reason}")]
    Damaged {
        /// Where the part begins.
        offset: usize,
        /// The part that is at fault.
        part: String,
        /// What is wrong with it.
        reason: String,
    },
    /// There is no such frame.
    #[error("there is no frame {index}: the recording has {count}")]
    NoSuchFrame {
        /// The frame asked for, from 0.
        index: usize,
        /// The number of frames.
        count: usize,
    },
}
