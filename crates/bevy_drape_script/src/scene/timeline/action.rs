//! Actions: what an event does.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Aim, Literal, Names, NonNegative, Point, Positive, Seconds, Vector};

/// What an event does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Action {
    /// The cannon of this name fires.
    Fire(String),
    /// A cannon is aimed.
    Aim {
        /// Its name.
        cannon: String,
        /// Where it aims from now on.
        aim: Aim,
        /// Speed of its balls from now on, in m/s; as before if left out.
        #[serde(default)]
        speed: Option<NonNegative>,
    },
    /// The wind has this velocity in m/s from now on.
    SetWind(Vector),
    /// Particles are held where they are.
    Pin {
        /// Of which body.
        of: String,
        /// Which; all by default.
        #[serde(default)]
        particles: Selection,
    },
    /// Particles are let go.
    Unpin {
        /// Of which body.
        of: String,
        /// Which; all by default.
        #[serde(default)]
        particles: Selection,
    },
    /// A particle and those around it are dragged along a path, and let go at its end.
    Drag {
        /// Of which body.
        of: String,
        /// Which particle: `First`, `Middle`, `Last` or `Particle(number)`.
        point: Point,
        /// How far from that particle others are held too, in metres; 0.1 by default.
        #[serde(default = "arm")]
        radius: NonNegative,
        /// Where to: seconds since the beginning of the drag, and metres from where the particle was then; evenly in between.
        path: Vec<(Seconds, Vector)>,
        /// Whether the path is places of the scene instead, reached evenly from where the particle was; false by default.
        #[serde(default)]
        absolute: bool,
        /// The greatest force of the hand in newtons; none by default: what it holds is where it is, whatever that takes.
        #[serde(default)]
        greatest_force: Option<Positive>,
    },
    /// A blade cuts what it passes through: a straight edge that moves from one place to another in no time.
    Cut {
        /// Of which bodies, with their pieces; of all if left out.
        #[serde(default)]
        of: Names,
        /// Hilt and tip at the beginning of the stroke, in metres.
        from: (Vector, Vector),
        /// Hilt and tip at its end, in metres.
        to: (Vector, Vector),
    },
    /// Something gets an impulse in newton seconds, its particles each their part by mass.
    Push {
        /// What.
        of: String,
        /// The impulse in newton seconds.
        impulse: Vector,
        /// Which particles; all by default.
        #[serde(default)]
        particles: Selection,
    },
    /// A value of the scene is changed by its path, as from a command line: `Set("ground.friction", 0)`. A body whose form is
    /// changed by this is built anew.
    Set(String, Literal),
    /// Something that was not present, or was despawned, appears.
    Spawn(String),
    /// Something vanishes.
    Despawn(String),
    /// The simulation stands still for a while, in seconds.
    Pause(Seconds),
    /// A picture is taken by the camera of this name, where there is something to draw it with.
    Picture(String),
    /// The state is saved under this name, as it is before all that happens at this time. What has torn by then cannot be gone on
    /// from.
    Checkpoint(String),
    /// The scene ends.
    Stop,
}

fn arm() -> NonNegative {
    NonNegative::known(0.1)
}

/// Which particles of a body.
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
    /// Everything in the scene that it names.
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
