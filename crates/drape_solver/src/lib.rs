#![doc = include_str!("../README.md")]
// Same input, same bits, on every machine: `clippy.toml` lists what rounds differently.
#![warn(clippy::disallowed_methods)]

pub mod broad_phase;
pub mod build;
pub mod constants;
pub mod constraint;
pub mod contact;
pub mod drape_test;
pub mod error;
pub mod geometry;
pub mod motion;
pub mod parallel;
pub mod simd;
pub mod state;
pub mod step;
pub mod substep;
pub mod tearing;

pub use build::cloth::{ClothBuilder, ClothMaterial, Edge};
pub use build::embedding::Embedding;
pub use build::mesh::cloth::{MeshCloth, MeshClothBuilder};
pub use build::mesh::error::{MeshError, MeshRepairs};
pub use build::preset::Preset;
pub use build::ragdoll::{RagdollBuilder, RagdollStick};
pub use build::rigid_tetrahedron::RigidTetrahedronBuilder;
pub use build::rope::RopeBuilder;
pub use build::soft_ball::SoftBallBuilder;
pub use build::soft_body::{SoftBodyBuilder, SoftSolid};
pub use build::soft_lattice::SoftLattice;
pub use build::topology_builder::TopologyBuilder;
pub use build::weave::Weave;
pub use constraint::tether::Tethers;
pub use constraint::volume::volume;
pub use contact::ball_cloth_query::BallClothContact;
pub use contact::dynamic_obstacle::MovedObstacle;
pub use contact::event::{Contact, Feature, Other, Party, Touch};
pub use contact::reaction::Reaction;
pub use error::{BuildError, StepError};
pub use geometry::pose::Placement;
pub use geometry::shape::Shape;
pub use motion::frame_motion::FrameMotion;
pub use motion::wind::{Turbulence, Wind, WindFlow, WindRegion, WindZone};
pub use parallel::threads::{Alone, Threads};
pub use simd::isa::Isa;
pub use state::ball::{Ball, BallMaterial};
pub use state::body::{Body, BodyContext};
pub use state::hash::StateHasher;
pub use state::island::{Environment, Island};
pub use state::layers::Layers;
pub use state::obstacle::Obstacle;
pub use state::obstacles::Obstacles;
pub use state::particles::Particles;
pub use state::rigid_body::RigidBody;
pub use state::settings::{Quality, SelfContact, SolverSettings, StickProjection, StructuralSolve};
pub use state::snapshot::{BallSnapshot, ParticlesSnapshot};
pub use state::topology::{EmbeddedPoint, StickBatch, StickBound, StickKind, StickMaterial, Topology};
pub use step::{step, step_on};
pub use tearing::pieces::Piece;
pub use tearing::tear::{TearLimits, Torn, TornStick};

pub use glam;
pub use parry3d;
