#![doc = include_str!("../README.md")]
//!
//! # Floors
//!
//! A file imports from its own floor and from floors below; `.ci/floors` checks it.
//!
//! ```text
//! plugin             the plugin group, and the features in the order of a step
//! snapshot/          saves and restores a running world
//! tools/             picking, gestures, ray casts, gizmos, diagnostics
//! tear/              parts bodies, and makes entities of the pieces
//! render/            meshes that show bodies, and bodies made from meshes
//! transform/         interpolation between fixed steps and between frames
//! contact/           messages about contacts and hits, reactions of obstacles
//! sleep/             sleeping, waking and culling
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
//! change_detection   change ticks read as columns
//! rigid_motion       placements, and rigid motions between them
//! clock              simulated time
//! refusal            components that cannot be used, and why
//! serde_vector       vectors written as three numbers
//! ```

pub mod attach;
pub mod ball;
pub mod body;
pub mod build;
mod change_detection;
pub mod clock;
pub mod contact;
pub mod detail;
pub mod environment;
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
pub mod tools;
pub mod transform;
pub mod viewer;

pub use drape_solver;
pub use plugin::DrapePlugins;

/// Everything that an app with cloth in it usually needs.
///
/// ```
/// use bevy_drape::prelude::*;
/// ```
pub mod prelude {
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::render::from_mesh::{
        cloth_mesh::{ClothMesh, ClothWeave, WeldedVertices},
        driven_mesh::DrivenMesh,
        paint::{ClothPaint, PaintChannel},
        soft_body::SoftBody,
    };
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::render::rope_mesh::RopeMesh;
    #[cfg(feature = "gizmos")]
    #[doc(inline)]
    pub use crate::tools::gizmos::DrapeGizmos;
    #[cfg(feature = "picking")]
    #[doc(inline)]
    pub use crate::tools::picking::Draggable;
    #[doc(inline)]
    pub use crate::{
        attach::{
            attachment::{Attachment, Tie, TiedParticles},
            follow_particle::{FollowParticle, FollowedParticle},
            grab::{Grab, Hand},
            plane_lock::PlaneLock,
            winch::Winch,
            world_motion::{TeleportCloth, WorldMotion},
        },
        ball::{
            cannon::{Cannon, CannonFired, FireCannon},
            projectile::{Projectile, ProjectileState},
        },
        body::{
            activity::Activity,
            contact_events::ContactEvents,
            layers::DrapeLayers,
            particles::{Particles, Sticks},
            pressure::Pressure,
            settings::{
                DefaultSolverSettings, Quality, SelfContact, SolverSettings, StickProjection, StructuralSolve,
            },
            tearable::Tearable,
        },
        build::{
            cloth::{Cloth, ClothPins},
            preset::Preset,
            rigid_tetrahedron::RigidTetrahedron,
            rope::Rope,
            soft_ball::SoftBall,
        },
        clock::DrapeClock,
        contact::{
            events::{
                ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded, DrapeContactHit,
                DrapeContactSettings, DrapeContactStarted,
            },
            hit::{BallHit, HitTarget},
        },
        detail::level::{CurrentDetail, DetailLevel, LevelOfDetail},
        environment::{
            dynamic_obstacle::{DynamicObstacle, ObstacleReaction},
            gravity::DrapeGravity,
            obstacle::{Obstacle, ObstacleShape, TeleportObstacle},
            wind::{Gusts, Wind},
            wind_zone::{WindFlow, WindRegion, WindZone},
        },
        plugin::DrapePlugins,
        refusal::Refusals,
        rig::{
            components::{InRig, Particle, Rig, Stick, StickBound, StickKind},
            ragdoll::{Ragdoll, RagdollEntities},
        },
        schedule::{DrapeSchedule, DrapeSubsteps, DrapeSystems},
        sleep::{activity_counts::ActivityCounts, scene_manager::SceneManager},
        step::motion_limits::MotionLimitCounts,
        tear::messages::{BodySplit, CutCloth, StickTorn},
        tools::{diagnostics::DrapeDiagnosticsPlugin, gestures::Gestures},
        transform::{interpolation::Interpolated, moved_by_frame::MovedByFrame},
        viewer::Viewer,
    };
}
