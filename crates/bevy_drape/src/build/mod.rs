//! Descriptions of bodies (cloth, rope, soft ball, rigid tetrahedron) and the systems that build bodies from them.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! fn setup(mut commands: Commands) {
//!     let flag = Cloth::new(1.5, 1.0).with_pins(ClothPins::Left);
//!     commands.spawn((flag, Fabric::SILK, Transform::from_xyz(0.0, 2.0, 0.0)));
//!     commands.spawn(Rope::new(Vec3::ZERO, Vec3::NEG_Y, 20));
//!     commands.spawn((SoftBall::default(), Transform::from_xyz(2.0, 1.0, 0.0)));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```
//!
//! A body is the components of `body/` on an entity: `insert_body` (`description.rs`) inserts them. The solver's `Body` is made
//! of them in each step (`step/island_run.rs`).
//!
//! Imports `body/`. The plugin runs the systems at the start of a step; `render/` and `tear/` look at the descriptions.
//!
//! Design: `docs/design/ropes.md` and `docs/design/rigs.md`.

pub(crate) mod built;
pub(crate) mod cloth;
pub(crate) mod description;
pub(crate) mod plugin;
pub(crate) mod rigid_tetrahedron;
pub(crate) mod rope;
pub(crate) mod soft_ball;

pub use built::BodyBuilt;
pub use cloth::{Cloth, ClothPins};
pub use drape_solver::{MeasuredFabric, Preset};
pub use rigid_tetrahedron::RigidTetrahedron;
pub use rope::Rope;
pub use soft_ball::SoftBall;
