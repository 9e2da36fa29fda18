//! Recordings: the positions of everything, step by step, to the last bit.
//!
//! A [`Recorder`] writes frames to a file or any other writer; [`RecordSteps`] does so in an app. A [`Recording`] is read back
//! and checked as a whole, and shows any frame. [`diff`] finds the first frame in which two runs differ.
//!
//! ```
//! use bevy_drape_script::recording::{Header, RecordSteps, Recording};
//! use bevy_drape_script::{SceneRunner, SceneScript};
//!
//! let scene = r#"(version: 1, settings: (duration: 0.5), bodies: { "ball": Balls(at: (0, 2, 0)) })"#;
//! let path = std::env::temp_dir().join(format!("falling-{}.drape", std::process::id()));
//! let mut runner = SceneRunner::headless(SceneScript::parse(scene)?);
//! RecordSteps::create(&path, Header { scene: "falling".into(), dt: 1.0 / 60.0 })?.start(runner.app_mut());
//! while runner.step() {}
//! RecordSteps::finish(runner.world_mut())?;
//!
//! let recording = Recording::load(&path)?;
//! assert_eq!((recording.tracks()[0].name.as_str(), recording.frame_count()), ("ball#1", 30));
//! # std::fs::remove_file(path)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
