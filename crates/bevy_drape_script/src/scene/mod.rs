//! The scene file format as types: one noun per file, each a plain value that serde reads and writes.
//!
//! Numbers know their range, so that the parser rejects a number where it stands. Conversions to the plugin's components
//! live beside the types. Imports `text` and `mesh`; `load` reads and checks scenes, `play` brings them into a world.
//!
//! ```
//! use bevy_drape_script::SceneScript;
//! use bevy_drape_script::scene::Body;
//!
//! let text = r#"(version: 1, bodies: { "flag": Cloth(size: (1.5, 1), pins: Left) })"#;
//! let script = SceneScript::parse(text)?;
//! assert!(matches!(script.bodies["flag"], Body::Cloth(_)));
//! // What is wrong is told in the words of the file.
//! let error = SceneScript::parse(&text.replace("pins", "pin")).expect_err("there is no such field");
//! assert!(error.to_string().contains("did you mean `pins`?"));
//! # Ok::<(), bevy_drape_script::SceneError>(())
//! ```

mod bodies;
mod camera;
mod cannon;
mod layers;
mod material;
mod obstacles;
mod parameter;
mod scene_script;
mod schema;
mod settings;
mod solver;
mod surface;
mod timeline;
mod value;
mod wind_zone;

pub use bodies::{
    Balls, Body, Cloth, ClothMesh, Copies, MeshSource, PaintChannel, Pins, Rig, RigParticle, RigStick, Rope,
    SoftBall, SoftBody, StickBound, StickKind, Tearable,
};
pub use camera::Camera;
pub use cannon::{Aim, Cannon};
pub use layers::Layers;
pub use material::Material;
pub use obstacles::{Dynamic, Keyframe, Keyframes, Motion, Obstacle, Part, Shape, Steady};
pub use parameter::Parameter;
pub use scene_script::{FORMAT_VERSION, SceneScript};
pub(crate) use schema::SCHEMA;
pub use schema::schema;
pub use settings::{Gusts, Settings, Wind};
pub use solver::{Quality, SelfContact, Solver, StickProjection, StructuralSolve};
pub use surface::Surface;
pub use timeline::{
    Action, Axis, Counted, Energy, Event, Expectation, Expected, Measure, Measured, Place, Point, Probe,
    Repeat, Selection, Trigger, When,
};
pub use value::{
    Bound, Fraction, Literal, Named, Names, NonNegative, Number, OutOfRange, Positive, Pressure, Seconds,
    StepLength, Tolerance, Turn, Vector, Whole,
};
pub(crate) use value::{bracketed, whole};
pub use wind_zone::{WindFlow, WindRegion, WindZone};
