//! Conflicts of motion limits with obstacles.

use bevy::prelude::*;

/// Number of particles that a motion limit keeps in an obstacle. If both cannot hold, the limit wins, and the particle
/// is counted here.
///
/// Limits are painted on a [`ClothMesh`](crate::render::from_mesh::cloth_mesh::ClothMesh), or set by
/// [`set_motion_limit`](drape_solver::Particles::set_motion_limit). Constant conflicts call for longer limits, or
/// thinner obstacles.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct MotionLimitCounts {
    /// Particles with more than a millimetre of penetration depth at the end of the last step.
    pub conflicts: usize,
    /// The same, added up over all steps.
    pub total_conflicts: u64,
}
