//! Recordings: where everything was, step by step, to the last bit.
//!
//! A [`Recorder`] writes what moves as it moves, to a file or any other writer; a [`Recording`] is read back, checked as a
//! whole, and shows any frame; [`diff`] tells where two runs part. In an app,
//! [`RecordSteps`] does the writing.
//!
//! ```
//! use bevy_drape_script::recording::{Header, Recorder, Recording, Seen, Track, TrackKind};
//!
//! # fn main() -> Result<(), bevy_drape_script::recording::RecordingError> {
//! let mut recorder = Recorder::new(Vec::new(), Header { scene: "a falling point".into(), dt: 0.1 })?;
//! for step in 0..10 {
//!     let track = || Track {
//!         name: "point".into(),
//!         kind: TrackKind::Body { particles: 1, faces: vec![], sticks: vec![] },
//!     };
//!     let time = 0.1 * f64::from(step);
//!     let height = 10.0 - 4.9 * (time * time) as f32;
//!     recorder.push(time, vec![Seen::body(7, track, [0.0; 3], [[0.0, height, 0.0]].into_iter())])?;
//! }
//! let recording = Recording::from_bytes(recorder.finish()?)?;
//! let mut cursor = recording.cursor();
//! let place = cursor.seek(5)?.states[0].positions().next();
//! assert!(place.is_some_and(|place| (place.y - 8.775).abs() < 1e-6));
//! # Ok(())
//! # }
//! ```
//!
//! # The format
//!
//! After the magic `DRAPEREC` and a version come packets: a header, blocks, an end. Each is encoded by `postcard` and
//! compressed as an LZ4 frame, with the checksums of that format. A block holds up to 64 frames and can be read without
//! those before it. What has not moved costs a byte a frame, if that; what moves is kept as the difference from what its
//! last places let expect (`residual.rs`). Whatever the bytes of a file are, reading them ends with a recording or a
//! [`RecordingError`].

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

pub use difference::{Difference, Parting, diff};
pub use error::RecordingError;
pub use frame::{Frame, State};
pub use packet::Header;
pub use reader::{Cursor, Recording};
pub use recorder::{Recorder, Seen};
pub use steps::RecordSteps;
pub use track::{Form, Track, TrackKind};
