//! Recordings: the positions of everything, step by step, to the last bit.
//!
//! A [`Recorder`] writes frames to a file or any other writer; [`RecordSteps`] does so in an app. A [`Recording`] is read back
//! and checked as a whole, and shows any frame. [`diff`] finds the first frame in which two runs differ.
//!
//! Imports `container`, and of the plugin only what it records. The command line and the replay window of the examples call it.

mod block;
mod difference;
mod error;
mod frame;
mod packet;
mod reader;
mod recorder;
mod residual;
mod steps;
mod track;

pub use difference::{Difference, Mismatch, diff};
pub use error::RecordingError;
pub use frame::{Frame, State};
pub use packet::Header;
pub use reader::{Cursor, Recording};
pub use recorder::{Recorder, Sample};
pub use steps::RecordSteps;
pub use track::{Form, Track, TrackKind};
