//! Checkpoints: the state of a running world in a file, from which it continues with the same bits.
//!
//! The timeline of a scripted scene takes checkpoints that hold the scene, too; [`resume`](Checkpoint::resume)
//! continues them in any world. Any other world is saved by hand.
//!
//! A checkpoint is a [`Snapshot`] with the name of its scene. The snapshot documents its contents, and which world it
//! can be restored into.
//!
//! ```no_run
//! # use bevy::prelude::*;
//! use bevy_drape_script::checkpoint::{Checkpoint, CheckpointError};
//!
//! # fn set_up() -> App { App::new() }
//! # fn main() -> Result<(), CheckpointError> {
//! let mut app = set_up();
//! (0..100).for_each(|_| app.update());
//! Checkpoint::take(app.world_mut(), "curtain").save("curtain.checkpoint")?;
//!
//! // Later: the same scene again, and one step, so that all is built.
//! let mut app = set_up();
//! (0..2).for_each(|_| app.update());
//! Checkpoint::load("curtain.checkpoint")?.restore(app.world_mut())?;
//! # Ok(())
//! # }
//! ```

use std::io;
use std::path::{Path, PathBuf};

use bevy::prelude::World;
use bevy_drape::snapshot::{Snapshot, SnapshotError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::container::{pack, unpack};
use crate::text::SceneError;

/// The first bytes of every checkpoint.
pub const MAGIC: [u8; 8] = *b"DRAPESAV";
/// The version of the format that is written, and the only one that is read, as snapshots hold the state of one
/// version.
pub const VERSION: u32 = 12;

/// The state of a running world, with the name of its scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    scene: String,
    snapshot: Snapshot,
    /// The state of the scripted scene as text; none if there is no scripted scene.
    play: Option<String>,
}

/// A checkpoint that cannot be written, read or restored.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The state cannot be written.
    #[error("cannot encode the checkpoint: {0}")]
    Unencodable(String),
    /// The bytes are no checkpoint.
    #[error("this is no checkpoint: it does not begin with “DRAPESAV”")]
    NotACheckpoint,
    /// The checkpoint was made by another version.
    #[error("the checkpoint has version {found} of the format; this program reads {known}")]
    AnotherVersion {
        /// The version of the checkpoint.
        found: u32,
        /// The version that this program reads.
        known: u32,
    },
    /// The bytes are cut off or changed.
    #[error("the checkpoint is damaged: its state, which begins at byte {offset}, {reason}")]
    Damaged {
        /// The offset of the damaged part in bytes.
        offset: usize,
        /// The problem with it.
        reason: String,
    },
    /// The checkpoint has no scripted scene.
    #[error("the checkpoint holds no scripted scene: it was not taken by a scene's timeline")]
    NoPlay,
    /// The state of the scripted scene cannot be parsed.
    #[error("the checkpoint's scene: {0}")]
    BadPlay(SceneError),
    /// The world is another than that of the checkpoint.
    #[error("the checkpoint of scene “{scene}” cannot be restored: {source}")]
    AnotherWorld {
        /// The scene of the checkpoint.
        scene: String,
        /// The difference.
        source: SnapshotError,
    },
}

impl Checkpoint {
    /// Takes the state of `world`, between steps.
    pub fn take(world: &mut World, scene: &str) -> Self {
        Self::of(world, scene, None)
    }

    /// Takes the state of `world` and of its scripted scene.
    pub(crate) fn of(world: &mut World, scene: &str, play: Option<String>) -> Self {
        Self { scene: scene.into(), snapshot: Snapshot::take(world), play }
    }

    /// Renames its scene.
    #[must_use]
    pub fn named(self, scene: &str) -> Self {
        Self { scene: scene.into(), ..self }
    }

    /// The name of its scene.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// The state of its scripted scene as text, if it has one.
    pub(crate) fn play(&self) -> Option<&str> {
        self.play.as_deref()
    }

    /// The state.
    pub fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Restores this state in `world`.
    ///
    /// # Errors
    /// [`CheckpointError::AnotherWorld`] if `world` has another scene or has taken no step. It is unchanged then.
    pub fn restore(&self, world: &mut World) -> Result<(), CheckpointError> {
        let scene = || self.scene.clone();
        self.snapshot
            .restore(world)
            .map_err(|source| CheckpointError::AnotherWorld { scene: scene(), source })
    }

    /// Encodes it, with checksums.
    ///
    /// # Errors
    /// [`CheckpointError::Unencodable`] if it is larger than 256 MiB.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CheckpointError> {
        let packed = pack(self).map_err(CheckpointError::Unencodable)?;
        let length = packed.len() as u64;
        Ok([&MAGIC[..], &VERSION.to_le_bytes(), &length.to_le_bytes(), &packed].concat())
    }

    /// Decodes it.
    ///
    /// # Errors
    /// [`CheckpointError`] if they are no checkpoint, one of another version, cut off, or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(CheckpointError::NotACheckpoint)?;
        let offset = MAGIC.len() + size_of::<u32>() + size_of::<u64>();
        let damaged = |reason| CheckpointError::Damaged { offset, reason };
        let (version, rest) = rest.split_first_chunk().ok_or_else(|| damaged("is not there".into()))?;
        let found = u32::from_le_bytes(*version);
        if found != VERSION {
            return Err(CheckpointError::AnotherVersion { found, known: VERSION });
        }
        let (length, packed) = rest.split_first_chunk().ok_or_else(|| damaged("is not there".into()))?;
        let length = u64::from_le_bytes(*length);
        if packed.len() as u64 != length {
            return Err(damaged(format!("has {} bytes instead of {length}", packed.len())));
        }
        unpack(packed).map_err(damaged)
    }

    /// Writes it to a file.
    ///
    /// # Errors
    /// [`CheckpointError`] as [`to_bytes`](Self::to_bytes), or if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), CheckpointError> {
        let path = path.as_ref();
        let written = std::fs::write(path, self.to_bytes()?);
        written.map_err(|source| CheckpointError::File { path: path.to_path_buf(), source })
    }

    /// Reads it from a file.
    ///
    /// # Errors
    /// [`CheckpointError`] as [`from_bytes`](Self::from_bytes), or if the file cannot be read.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, CheckpointError> {
        let path = path.as_ref();
        let read = std::fs::read(path);
        let bytes = read.map_err(|source| CheckpointError::File { path: path.to_path_buf(), source })?;
        Self::from_bytes(&bytes)
    }
}
