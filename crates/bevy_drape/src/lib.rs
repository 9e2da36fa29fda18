#![doc = include_str!("../README.md")]

pub mod activity;
pub mod attachment;
mod attachment_state;
mod attention;
pub mod cannon;
pub mod clock;
pub mod cloth;
#[cfg(feature = "mesh")]
pub mod cloth_mesh;
#[cfg(feature = "mesh")]
mod cloth_mesh_skin;
pub mod contact_events;
mod description;
pub mod detail;
mod detail_change;
#[cfg(feature = "mesh")]
mod detail_mesh;
pub mod diagnostics;
#[cfg(feature = "mesh")]
pub mod driven_mesh;
pub mod dynamic_obstacle;
pub mod environment;
pub mod follow_particle;
pub mod gestures;
#[cfg(feature = "gizmos")]
pub mod gizmos;
pub mod grab;
mod grid_resampling;
pub mod hit;
pub mod interpolation;
mod island;
mod island_systems;
mod islands;
pub mod layers;
#[cfg(feature = "mesh")]
pub mod mesh;
#[cfg(feature = "mesh")]
mod mesh_body;
#[cfg(feature = "mesh")]
pub mod mesh_reading;
#[cfg(feature = "mesh")]
mod mesh_source;
pub mod motion_limits;
pub mod moved_by_frame;
#[cfg(feature = "mesh")]
mod normals;
pub mod obstacle;
pub mod particles;
mod pending;
#[cfg(feature = "picking")]
pub mod picking;
pub mod plane_lock;
pub mod plugin;
mod posed;
pub mod preset;
pub mod pressure;
pub mod projectile;
pub mod ragdoll;
pub mod ray_cast;
pub mod refusal;
pub mod rig;
mod rig_body;
mod rig_compile;
mod rig_transforms;
pub mod rigid_tetrahedron;
pub mod rope;
#[cfg(feature = "mesh")]
pub mod rope_mesh;
mod scan;
pub mod scene_manager;
pub mod schedule;
pub mod settings;
mod sleepers;
#[cfg(feature = "mesh")]
mod smoothing;
pub mod snapshot;
pub mod soft_ball;
#[cfg(feature = "mesh")]
pub mod soft_body;
#[cfg(feature = "mesh")]
mod surface;
pub mod tear;
#[cfg(feature = "mesh")]
mod torn_mesh;
mod transforms;
#[cfg(feature = "mesh")]
mod tube;
#[cfg(feature = "mesh")]
mod vertex_map;
#[cfg(feature = "mesh")]
mod vertices;
#[cfg(feature = "mesh")]
mod visibility;
mod waking;
pub mod winch;
pub mod wind_zone;
pub mod world_motion;

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
    pub use crate::cloth_mesh::{ClothMesh, ClothPaint, ClothWeave, PaintChannel, WeldedVertices};
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::driven_mesh::DrivenMesh;
    #[cfg(feature = "gizmos")]
    #[doc(inline)]
    pub use crate::gizmos::DrapeGizmos;
    #[cfg(feature = "picking")]
    #[doc(inline)]
    pub use crate::picking::Draggable;
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::rope_mesh::RopeMesh;
    #[cfg(feature = "mesh")]
    #[doc(inline)]
    pub use crate::soft_body::SoftBody;
    #[doc(inline)]
    pub use crate::{
        activity::{Activity, ActivityCounts},
        attachment::{Attachment, Tie, TiedParticles},
        cannon::{Cannon, CannonFired, FireCannon},
        clock::DrapeClock,
        cloth::{Cloth, ClothPins},
        contact_events::{
            ContactEvents, ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded,
            DrapeContactHit, DrapeContactSettings, DrapeContactStarted,
        },
        detail::{CurrentDetail, DetailLevel, LevelOfDetail},
        diagnostics::DrapeDiagnosticsPlugin,
        dynamic_obstacle::{DynamicObstacle, ObstacleReaction},
        environment::{DrapeGravity, Gusts, Wind},
        follow_particle::{FollowParticle, FollowedParticle},
        gestures::Gestures,
        grab::{Grab, Hand},
        hit::{BallHit, HitTarget},
        interpolation::Interpolated,
        layers::DrapeLayers,
        motion_limits::MotionLimitCounts,
        moved_by_frame::MovedByFrame,
        obstacle::{Obstacle, ObstacleShape, TeleportObstacle},
        particles::{Particles, Sticks},
        plane_lock::PlaneLock,
        plugin::DrapePlugins,
        preset::Preset,
        pressure::Pressure,
        projectile::{Projectile, ProjectileState},
        ragdoll::{Ragdoll, RagdollEntities},
        refusal::Refusals,
        rig::{InRig, Particle, Rig, Stick, StickBound, StickKind},
        rigid_tetrahedron::RigidTetrahedron,
        rope::Rope,
        scene_manager::{SceneManager, Viewer},
        schedule::{DrapeSchedule, DrapeSubsteps, DrapeSystems},
        settings::{
            DefaultSolverSettings, Quality, SelfContact, SolverSettings, StickProjection, StructuralSolve,
        },
        soft_ball::SoftBall,
        tear::{BodySplit, CutCloth, StickTorn, Tearable},
        winch::Winch,
        wind_zone::{WindFlow, WindRegion, WindZone},
        world_motion::{TeleportCloth, WorldMotion},
    };
}
