//! Bodies that are not solved here.

use std::sync::Arc;

#[cfg(feature = "mesh")]
use bevy::ecs::query::QueryData;
use bevy::math::Affine3A;
use bevy::prelude::*;
#[cfg(feature = "gpu")]
use drape_solver::Body;
use drape_solver::Topology;

#[cfg(feature = "gpu")]
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
#[cfg(feature = "mesh")]
use crate::body::particles::{Particles, Sticks};
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

    /// The transform of the entity in which the body is seen. A frozen body with pins moves rigidly with its entity: it is seen as when it froze.
    pub fn seen_from(&self, activity: Activity, now: &GlobalTransform) -> GlobalTransform {
        if self.follows_entity(activity) { self.state.anchor.into() } else { *now }
    }

    /// True if the body is frozen and moves rigidly with its entity.
    pub fn follows_entity(&self, activity: Activity) -> bool {
        activity == Activity::Frozen && !self.state.pins.is_empty()
    }

    /// Moves the particles rigidly to where the entity is now.
    pub fn follow(&mut self) {
        if self.anchor == self.state.anchor {
            return;
        }
        if let (Some(from), Some(to)) = (placement(&self.anchor), placement(&self.state.anchor)) {
            self.particles.teleport(&from, &to);
            self.anchor = self.state.anchor;
        }
    }
}

/// The parts of a body, wherever it is solved.
#[cfg(feature = "mesh")]
#[derive(QueryData)]
pub(crate) struct AnyParts {
    here: Option<(&'static Particles, &'static Sticks)>,
    on_gpu: Option<&'static OnGpu>,
}

#[cfg(feature = "mesh")]
impl AnyPartsItem<'_, '_> {
    /// Particles and topology; those of a body on the GPU are as they were when it went there. None before the body is built.
    pub fn get(&self) -> Option<(&drape_solver::Particles, &Arc<Topology>)> {
        let here = self.here.map(|(particles, sticks)| (&particles.0, &sticks.0));
        here.or(self.on_gpu.map(|body| (&body.particles, &body.topology)))
    }
}
