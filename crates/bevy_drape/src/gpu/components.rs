//! The components of bodies on the GPU.

use bevy::prelude::*;
use drape_gpu::{BodyMesh, GpuBodyId};

/// Solves and draws a [`Cloth`](crate::build::cloth::Cloth), [`ClothMesh`](crate::render::from_mesh::cloth_mesh::ClothMesh),
/// [`Rope`](crate::build::rope::Rope) or [`SoftBall`](crate::build::soft_ball::SoftBall) on the GPU: for cloth and ropes by the thousand, and for
/// sheets of hundreds of thousands of particles. Remove it, and the processor waits for the GPU and goes on from where the body is, at rest. In
/// browsers, where nothing may wait, the body begins again where its entity is.
///
/// A body on the GPU has a [`GpuBody`], and neither [`Particles`](crate::body::particles::Particles) nor
/// [`Sticks`](crate::body::particles::Sticks): queries for these, ray casts, pointers, gizmos, snapshots and messages about contacts do not know it.
/// Obstacles, gravity, wind, and pins that follow the entity's [`Transform`] act on it as on other bodies; balls, other bodies, wind zones, shelter and
/// forces do not, sticks are not damped, lines are swept, and it pushes nothing. Its settings, surface and layers are those from when it went there. If its pins jump
/// with the entity, faster than [`TELEPORT_SPEED`](drape_solver::constants::TELEPORT_SPEED), it begins again at the new place. A disabled body is
/// solved on.
///
/// It has an [`Activity`](crate::body::activity::Activity), some frames late. At rest it falls asleep, until an obstacle nearby, gravity, the wind or
/// a pin changes, or you set its activity; it wakes without speed. Outside the play area it is culled, until its pins move or you set its activity.
/// By a [`LevelOfDetail`](crate::detail::LevelOfDetail) it has fewer substeps, or is frozen; it keeps its particles. A frozen body with pins moves
/// rigidly with its entity. It goes on without speed, and in its first shape if the entity has moved meanwhile.
///
/// The processor solves a body, and the log says why, without a device, with self-contact, a [bending rigidity](crate::body::BendingRigidity) or
/// [membrane stiffness](crate::body::MembraneStiffness), if a
/// [`DrivenMesh`](crate::render::from_mesh::driven_mesh::DrivenMesh) follows it, if it is a `ClothMesh` with a skin or with painted limits, backstops or
/// drives, and with any of these components: `Attachment`, `ContactEvents`, `Grab`, [`ParticleFollowers`](crate::attach::ParticleFollowers),
/// `PlaneLock`, `Pressure`, `Rig`, `SoftBodyMesh`, `Tearable`, `Winch`, `WorldMotion`. If one is added later, the body comes back. Insert
/// `SolveOnGpu` again once it is gone. `TeleportCloth` brings it back for one step.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct SolveOnGpu;

impl SolveOnGpu {
    /// Its name in [`Refusals`](crate::refusal::Refusals).
    pub(super) const NAME: &str = "SolveOnGpu";
}

/// A body that is on the GPU. Written by the plugin.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(opaque)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[component(clone_behavior = Ignore)]
pub struct GpuBody(pub(crate) GpuBodyId);

impl GpuBody {
    /// Its name in [`GpuBodies::world`](crate::gpu::GpuBodies::world).
    pub fn id(&self) -> GpuBodyId {
        self.0
    }
}

/// The way in which the vertices of the mesh that shows a body on the GPU lie on its particles, if not one on each.
#[derive(Component, Clone, Copy, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct GpuVertices(pub BodyMesh);
