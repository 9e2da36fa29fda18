//! The scene file: what can be said in it.
//!
//! One type a file, each a plain value that serde reads and writes. Numbers know their range, so that what is out of it is
//! refused where it stands.

mod action;
mod balls;
mod body;
mod camera;
mod cannon;
mod cloth;
mod cloth_mesh;
mod copies;
mod event;
mod expectation;
mod layers;
mod literal;
mod material;
mod mesh_source;
mod motion;
mod named;
mod number;
mod obstacle;
mod paint_channel;
mod parameter;
mod probe;
mod rig;
mod rope;
mod script;
mod settings;
mod shape;
mod soft_ball;
mod soft_body;
mod solver;
mod tearable;
mod turn;
mod wind_zone;

pub use action::{Action, Selection};
pub use balls::Balls;
pub use body::Body;
pub use camera::Camera;
pub use cannon::{Aim, Cannon};
pub use cloth::{Cloth, Pins};
pub use cloth_mesh::ClothMesh;
pub use copies::Copies;
pub use event::{Event, Repeat, Trigger};
pub use expectation::{Expectation, Expected, Measured, When};
pub use layers::Layers;
pub use literal::Literal;
pub use material::Material;
pub use mesh_source::MeshSource;
pub use motion::{Dynamic, Keyframe, Keyframes, Motion, Steady};
pub(crate) use named::whole;
pub use named::{Named, Names};
pub(crate) use number::range_in_words;
pub use number::{
    Bound, Fraction, NonNegative, Number, OutOfRange, Positive, Pressure, Seconds, StepLength, Tolerance,
    Vector, Whole,
};
pub use obstacle::Obstacle;
pub use paint_channel::PaintChannel;
pub use parameter::Parameter;
pub use probe::{Axis, Counted, Energy, Measure, Place, Point, Probe};
pub use rig::{Rig, RigParticle, RigStick, StickBound, StickKind};
pub use rope::Rope;
pub use script::{FORMAT_VERSION, SceneScript};
pub use settings::{Gusts, Settings, Wind};
pub use shape::{Part, Shape};
pub use soft_ball::SoftBall;
pub use soft_body::SoftBody;
pub use solver::{Quality, SelfContact, Solver, StickProjection, StructuralSolve};
pub use tearable::Tearable;
pub use turn::Turn;
pub use wind_zone::{WindFlow, WindRegion, WindZone};
