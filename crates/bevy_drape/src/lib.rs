#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin             the plugin group, and the features in the order of a step
//! origin             shifts the origin of the world
//! gpu/               bodies that are solved and drawn on the GPU
//! snapshot/          saves and restores a running world
//! tools/             picking, gestures, spatial queries, gizmos, diagnostics
//! tear/              parts bodies, and makes entities of the pieces
//! render/            meshes that show bodies, and bodies made from meshes
//! bones/             joints of skinned meshes, solved as ropes and cloth
//! transform/         interpolation between fixed steps and between frames
//! contact/           messages about contacts and hits, reactions of obstacles
//! sleep/             sleeping, waking, culling, reach
//! step/              takes islands of bodies and balls through the solver
//! detail/            level of detail
//! attach/            ties between particles and entities
//! rig/               bodies whose particles are entities
//! ball/              cannon balls and cannons
//! environment/       obstacles, gravity, wind
//! build/             descriptions of bodies, and the bodies built from them
//! body/              components of bodies
//! schedule           labels of a step: schedules, sets, times
//! viewer             viewers, and distances from them
//! pending_messages   messages that wait for the next step
//! entity_events      messages that observers hear of too
//! change_detection   change ticks read as columns
//! rigid_motion       placements, and rigid motions between them
//! clock              simulated time
//! refusal            components that cannot be used, and why
//! serde_vector       vectors written as three numbers
//! ```

pub mod attach;
pub mod ball;
pub mod body;
pub mod bones;
pub mod build;
pub mod change_detection;
pub mod clock;
pub mod contact;
pub mod detail;
mod entity_events;
pub mod environment;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod origin;
mod pending_messages;
pub mod plugin;
pub mod refusal;
#[cfg(feature = "mesh")]
pub mod render;
pub mod rig;
mod rigid_motion;
pub mod schedule;
#[cfg(feature = "serde")]
mod serde_vector;
pub mod sleep;
pub mod snapshot;
pub mod step;
pub mod tear;
mod tools;
pub mod transform;
pub mod viewer;

pub use ball::cannon;
pub use drape_solver;
pub use plugin::DrapePlugins;
pub use sleep::reach;
#[cfg(feature = "gizmos")]
pub use tools::gizmos;
#[cfg(feature = "picking")]
pub use tools::picking;
pub use tools::{diagnostics, gestures, ray_cast, spatial_query};

/// The names that a first app with cloth in it needs. The rest is in the modules of its subject: [`rig`], [`cannon`], [`tear`], ..
///
/// ```
/// # use bevy_drape::prelude::*;
/// ```
pub mod prelude {
    #[cfg(feature = "gizmos")]
    #[doc(inline)]
    pub use crate::gizmos::DrapeGizmos;
    #[cfg(feature = "picking")]
    #[doc(inline)]
    pub use crate::picking::Draggable;
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::render::{
        BodyColliders, ClothMesh, ClothPaint, ObstacleHierarchy, RopeMesh, SoftBodyMesh,
    };
    #[doc(inline)]
    pub use crate::{
        attach::{Attachment, FollowParticle, Tie, WorldMotion},
        ball::Projectile,
        body::{
            BendingRigidity, BodySurface, ContactEvents, DrapeLayers, Fabric, Particles, Quality,
            SelfContact, SolverSettings, Tearable,
        },
        build::{Cloth, ClothPins, Rope, SoftBall},
        environment::{DrapeGravity, DynamicObstacle, Obstacle, ObstacleShape, Wind, WindZone},
        plugin::DrapePlugins,
        refusal::Refusals,
        schedule::DrapeSystems,
        transform::Interpolated,
    };
}
