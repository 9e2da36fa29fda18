//! The simulated state of a body, as components.

use std::sync::Arc;

use bevy::prelude::*;
use drape_solver::Topology;

use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::refusal::Refusals;

/// Positions and motion of a body's particles: the solver's columns, in world coordinates.
///
/// Read it for positions and velocities; write to it (forces, impulses, pins) at any time outside the substeps.
#[derive(Component, Reflect, Clone, Debug, Default, Deref, DerefMut)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Activity, BodyState)]
pub struct Particles(pub drape_solver::Particles);

/// The particles of a body, and how they are joined.
pub type BodyParts = (drape_solver::Particles, Arc<Topology>);

/// Sticks, faces and tethers that join a body's particles. Shared: equal bodies may hold the same ones.
#[derive(Component, Reflect, Clone, Debug, Default, Deref)]
#[reflect(opaque)]
#[reflect(Component, Default, Debug, Clone)]
pub struct Sticks(pub Arc<Topology>);

impl Sticks {
    /// True if the sticks join these particles, and there are any particles.
    pub(crate) fn fit(&self, particles: &drape_solver::Particles) -> bool {
        !particles.is_empty() && particles.len() == self.particle_count()
    }
}

/// Forgets the faults of a despawned body.
pub(crate) fn forget_despawned_body(despawned: On<Despawn<Particles>>, mut refusals: ResMut<Refusals>) {
    refusals.forget(despawned.entity);
}
