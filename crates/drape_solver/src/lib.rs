#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! Folders are layers: a file imports from its own floor and from the floors below it, which `.ci/floors` checks.
//!
//! ```text
//! world/       bodies, balls and obstacles by name: islands, sleep, wake and culling
//! drape_test   Cusick's drape test, and stretch by weight
//! step         the whole step, phase by phase: start here
//! stages       the stages of a substep, one by one
//! island       bodies and balls that are stepped together, with their scratch
//! tearing/     sticks tear, blades cut, bodies fall into pieces
//! build/       builders of cloths, ropes, soft bodies, ragdolls; cloth from meshes
//! substep/     the order of a substep, and the ways to walk it
//! contact/     the narrow phase: a file for each kind of contact, and helpers
//! broad_phase/ the pairs that could touch
//! constraint/  sticks, direct solves, tethers, volume, limits on motion, backstops
//! motion/      forces, wind, Verlet integration, drives, rest
//! state/       bodies, particles, topology, balls, obstacles, settings, state hashes
//! geometry/    shapes, poses, nearest points
//! parallel/    threads and workers
//! simd/        columns, lanes, instruction sets
//! union_find   groups of what hangs together
//! splitmix     numbers that look random
//! error        typed errors
//! constants    tolerances, bounds and tuning constants, with units and reasons
//! ```
// Same input, same bits, on every machine: `clippy.toml` lists the methods that round differently.
#![warn(clippy::disallowed_methods)]

pub(crate) mod broad_phase;
pub mod build;
pub mod constants;
pub mod constraint;
pub mod contact;
pub mod drape_test;
pub mod error;
pub mod geometry;
pub mod island;
pub mod motion;
pub mod parallel;
#[cfg(test)]
mod random;
pub mod simd;
pub mod splitmix;
pub(crate) mod stages;
pub mod state;
pub mod step;
pub(crate) mod substep;
pub mod tearing;
pub(crate) mod union_find;
pub mod world;

pub use build::cloth::{ClothBuilder, ClothMaterial, Edge};
pub use build::embedding::Embedding;
pub use build::measured_fabric::MeasuredFabric;
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
pub use contact::ball_cloth_query::BallClothContact;
pub use contact::event::{Contact, Feature, Other, Party, Touch};
pub use contact::surface::counts::SelfContactCounts;
pub use error::{BuildError, StepError};
pub use geometry::pose::Placement;
pub use geometry::shape::Shape;
pub use island::{BodyScratch, Island};
pub use motion::environment::Environment;
pub use motion::wind::{Turbulence, Wind, WindFlow, WindRegion, WindZone};
pub use parallel::threads::{Alone, Threads};
pub use simd::isa::Isa;
pub use state::backstops::Backstop;
pub use state::ball::{Ball, BallMaterial};
pub use state::bending_friction::BendingFriction;
pub use state::bends::BendingRigidity;
pub use state::body::{Body, BodyContext};
pub use state::combine_rule::CombineRule;
pub use state::face_part::FacePart;
pub use state::frame_motion::FrameMotion;
pub use state::hash::StateHasher;
pub use state::layers::Layers;
pub use state::membrane::MembraneStiffness;
pub use state::obstacle::Obstacle;
pub use state::obstacle_motion::MovedObstacle;
pub use state::obstacle_motion::Reaction;
pub use state::obstacles::Obstacles;
pub use state::particles::Particles;
pub use state::pose_drives::PoseDrive;
pub use state::rigid_body::RigidBody;
pub use state::settings::{BodySettings, Quality, SelfContact, StickProjection, StructuralSolve};
pub use state::snapshot::{BallSnapshot, ParticlesSnapshot};
pub use state::tethers::Tethers;
pub use state::topology::{
    EmbeddedPoint, GridFamily, StickBatch, StickBound, StickKind, StickMaterial, Topology,
};
pub use state::volume::volume;
pub use step::{step, step_on};
pub use tearing::frayed_edges::{FacePoint, FrayedEdges, TornPast};
pub use tearing::pieces::Piece;
pub use tearing::tear::{TearLimits, Torn, TornStick};
pub use tearing::torn_topology::TornTopology;
pub use world::World;
pub use world::activity::{Activity, ActivityCounts};
pub use world::activity_rules::ActivityRules;
pub use world::events::{Events, Fault};
pub use world::id::{BallId, BodyId, MemberId, ObstacleId, WorldId};

pub use glam;
pub use parry3d;
