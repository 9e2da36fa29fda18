//! Actions: what an event does.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Aim, Literal, Names, NonNegative, Point, Positive, Seconds, Vector};

/// The action of an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Action {
    /// The cannon of this name fires.
    Fire(String),
    /// A cannon is aimed.
    Aim {
        /// Its name.
        cannon: String,
        /// Its aim from now on.
        aim: Aim,
        /// Speed of its balls from now on, in m/s; as before if left out.
        #[serde(default)]
        speed: Option<NonNegative>,
    },
    /// The wind has this velocity in m/s from now on.
    SetWind(Vector),
    /// Particles are fixed where they are.
    Pin {
        /// Name of the body.
        of: String,
        /// The particles; all by default.
        #[serde(default)]
        particles: Selection,
    },
    /// Particles are let go.
    Unpin {
        /// Name of the body.
        of: String,
        /// The particles; all by default.
        #[serde(default)]
        particles: Selection,
    },
    /// A particle and those around it are dragged along a path, and let go at its end.
    Drag {
        /// Name of the body.
        of: String,
        /// The particle: `First`, `Middle`, `Last` or `Particle(number)`.
        point: Point,
        /// Radius around that particle in metres, within which others are held too; 0.1 by default.
        #[serde(default = "arm")]
        radius: NonNegative,
        /// Path: seconds since the beginning of the drag, and metres relative to the particle's position then; linear
        /// in between.
        path: Vec<(Seconds, Vector)>,
        /// True if the path gives positions in the scene instead; false by default.
        #[serde(default)]
        absolute: bool,
        /// Greatest force of the hand in newtons; none by default: the particles follow it, whatever force that takes.
        #[serde(default)]
        greatest_force: Option<Positive>,
    },
    /// A blade cuts everything that it passes through: a straight edge that moves at once from one place to another.
    Cut {
        /// Names of the bodies, which stand for their pieces, too; all bodies if left out.
        #[serde(default)]
        of: Names,
        /// Hilt and tip at the beginning of the stroke, in metres.
        from: (Vector, Vector),
        /// Hilt and tip at its end, in metres.
        to: (Vector, Vector),
    },
    /// An impulse in newton seconds, distributed over particles by their mass.
    Push {
        /// Name of the body, ball or obstacle.
        of: String,
        /// The impulse in newton seconds.
        impulse: Vector,
        /// The particles; all by default.
        #[serde(default)]
        particles: Selection,
    },
    /// A value of the scene is replaced by its path, as on the command line: `Set("ground.friction", 0)`. A body whose
    /// shape this changes is rebuilt.
    Set(String, Literal),
    /// Something that was not present, or was despawned, is spawned.
    Spawn(String),
    /// Something is despawned.
    Despawn(String),
    /// The simulation pauses for this time in seconds.
    Pause(Seconds),
    /// The camera of this name takes a picture, if the app can render.
    Picture(String),
    /// A checkpoint of this name is taken, before all other events of this time. A checkpoint of torn bodies cannot be
    /// resumed.
    Checkpoint(String),
    /// The scene ends.
    Stop,
}

fn arm() -> NonNegative {
    NonNegative::known(0.1)
}

/// Particles of a body.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Selection {
    /// All.
    #[default]
    All,
    /// Those that are pinned now.
    Pinned,
    /// These, by their numbers.
    Particles(Vec<u32>),
}

impl Action {
    /// All names of the scene that it uses.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::Fire(name) | Self::Spawn(name) | Self::Despawn(name) | Self::Picture(name) => vec![name],
            Self::Aim { cannon, .. } => vec![cannon],
            Self::Pin { of, .. } | Self::Unpin { of, .. } | Self::Drag { of, .. } | Self::Push { of, .. } => {
                vec![of]
            }
            Self::Cut { of, .. } => of.iter().map(String::as_str).collect(),
            Self::SetWind(_) | Self::Set(..) | Self::Pause(_) | Self::Checkpoint(_) | Self::Stop => {
                Vec::new()
            }
        }
    }
}
