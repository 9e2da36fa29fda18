#![doc = include_str!("../README.md")]

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
pub mod schedule;
#[cfg(feature = "serde")]
mod serde_vector;
pub mod sleep;
pub mod snapshot;
pub mod step;
pub mod tear;
pub mod tools;
pub mod transform;

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
    pub use crate::render::from_mesh::cloth_mesh::{
        ClothMesh, ClothPaint, ClothWeave, PaintChannel, WeldedVertices,
    };
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::render::from_mesh::driven_mesh::DrivenMesh;
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::render::from_mesh::soft_body::SoftBody;
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
            activity::{Activity, ActivityCounts},
            layers::DrapeLayers,
            particles::{Particles, Sticks},
            pressure::Pressure,
            settings::{
                DefaultSolverSettings, Quality, SelfContact, SolverSettings, StickProjection, StructuralSolve,
            },
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
                ContactEvents, ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded,
                DrapeContactHit, DrapeContactSettings, DrapeContactStarted,
            },
            hit::{BallHit, HitTarget},
        },
        detail::level::{CurrentDetail, DetailLevel, LevelOfDetail},
        environment::{
            dynamic_obstacle::{DynamicObstacle, ObstacleReaction},
            obstacle::{Obstacle, ObstacleShape, TeleportObstacle},
            solver_environment::{DrapeGravity, Gusts, Wind},
            wind_zone::{WindFlow, WindRegion, WindZone},
        },
        plugin::DrapePlugins,
        refusal::Refusals,
        rig::{
            components::{InRig, Particle, Rig, Stick, StickBound, StickKind},
            ragdoll::{Ragdoll, RagdollEntities},
        },
        schedule::{DrapeSchedule, DrapeSubsteps, DrapeSystems},
        sleep::scene_manager::{SceneManager, Viewer},
        step::motion_limits::MotionLimitCounts,
        tear::tearing::{BodySplit, CutCloth, StickTorn, Tearable},
        tools::{diagnostics::DrapeDiagnosticsPlugin, gestures::Gestures},
        transform::{interpolation::Interpolated, moved_by_frame::MovedByFrame},
    };
}
