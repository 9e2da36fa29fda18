//! The components of bodies on the GPU.

use bevy::prelude::*;
use drape_gpu::GpuBodyId;

/// Solves and draws a [`Cloth`](crate::build::cloth::Cloth) or [`SoftBall`](crate::build::soft_ball::SoftBall) on the GPU: for cloth by the
/// thousand, and for sheets of hundreds of thousands of particles. Removed again, the processor goes on from where the body is, at rest.
///
/// A body on the GPU has a [`GpuBody`], and no [`Particles`](crate::body::particles::Particles), [`Sticks`](crate::body::particles::Sticks) and
/// [`Activity`](crate::body::activity::Activity): queries for these, ray casts, pointers, gizmos, snapshots and messages do not know it. Obstacles,
/// gravity, wind, and pins that follow the entity's [`Transform`] act on it as on other bodies; balls, other bodies, wind zones, shelter
/// and forces do not. It never sleeps. Its settings, surface and layers are those from when it went there. A leap of its entity by more than
/// 50 m/s brings it to its first shape there.
///
/// The processor keeps a body, and the log says why, if it has self-contact, a rigidity, pressure, damped or rigid parts, is torn, tied, grabbed,
/// locked to a plane, carried along, watched, shown by a mesh of another number of vertices, or if there is no device.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct SolveOnGpu;

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
