#![doc = include_str!("../README.md")]
// Same input, same bits, on every machine: `clippy.toml` lists what rounds differently.
#![warn(clippy::disallowed_methods)]

pub mod ball;
pub mod ballistics;
pub mod body;
mod chain;
pub mod cloth;
mod columns;
pub mod constants;
mod contact_ball_ball;
mod contact_ball_cloth;
mod contact_ball_obstacle;
mod contact_particle_obstacle;
pub mod error;
pub mod force;
mod friction;
mod grid;
pub mod hash;
mod integrate;
pub mod isa;
pub mod island;
mod lanes;
mod layout;
mod line;
mod lone_chain;
pub mod measure;
mod nearest;
pub mod obstacle;
mod overlap;
pub mod particles;
mod pose;
mod rest;
pub mod rope;
pub mod settings;
pub mod shape;
pub mod step;
pub mod stick;
mod surface_lanes;
mod survey;
mod sweep;
pub mod tether;
pub mod topology;
pub mod touch;
mod transpose;

pub use ball::{Ball, BallMaterial};
pub use body::{Body, BodyContext};
pub use cloth::{ClothBuilder, ClothMaterial, Edge};
pub use error::{BuildError, StepError};
pub use force::Wind;
pub use hash::StateHasher;
pub use isa::Isa;
pub use island::{Environment, Island};
pub use obstacle::Obstacle;
pub use particles::Particles;
pub use pose::Placement;
pub use rope::RopeBuilder;
pub use settings::{SolverSettings, StickProjection, StructuralSolve};
pub use shape::Shape;
pub use step::step;
pub use tether::Tethers;
pub use topology::{StickBatch, StickKind, StickMaterial, Topology, TopologyBuilder};
pub use touch::{Other, Touch};

pub use glam;
pub use parry3d;
