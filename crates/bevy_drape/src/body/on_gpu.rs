//! Bodies that are not solved here.

use std::sync::Arc;

use bevy::math::Affine3A;
use bevy::prelude::*;
#[cfg(feature = "gpu")]
use drape_solver::Body;
use drape_solver::Topology;

use crate::body::body_state::BodyState;
#[cfg(feature = "gpu")]
use crate::rigid_motion::placement;

/// A body that the GPU solves: its parts as they were when it went there. Meanwhile the entity has no
/// [`Particles`](crate::body::particles::Particles), so that nothing takes old positions for present ones.
#[derive(Component)]
#[cfg_attr(not(feature = "gpu"), expect(dead_code, reason = "only the feature `gpu` makes one"))]
pub(crate) struct OnGpu {
    pub particles: drape_solver::Particles,
    pub topology: Arc<Topology>,
    pub state: BodyState,
    /// Transform of the entity when the particles were where they are here.
    pub anchor: Affine3A,
}

#[cfg(feature = "gpu")]
impl OnGpu {
    /// The body as it was.
    pub fn body(&self) -> Body {
        let Self { particles, topology, state, .. } = self;
        let body = Body::new(particles.clone(), Arc::clone(topology), state.settings);
        Body { layers: state.layers, ..body }
    }

    /// Moves the particles rigidly to where the entity is now.
    pub fn follow(&mut self) {
        if let (Some(from), Some(to)) = (placement(&self.anchor), placement(&self.state.anchor)) {
            self.particles.teleport(&from, &to);
            self.anchor = self.state.anchor;
        }
    }
}
