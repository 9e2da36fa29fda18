//! What limits on motion have done.

use bevy::prelude::*;

/// Particles that a limit on their motion keeps in an obstacle: where both cannot hold, the limit does, and the particle is counted here.
///
/// Limits are painted on a [`ClothMesh`](crate::render::from_mesh::cloth_mesh::ClothMesh), or set by
/// [`set_motion_limit`](drape_solver::Particles::set_motion_limit). A cloth that is counted all the time needs longer limits, or thinner
/// obstacles.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct MotionLimitCounts {
    /// Particles that were more than a millimetre too deep in an obstacle at the end of the last step.
    pub conflicts: usize,
    /// The same, summed up over all steps.
    pub total_conflicts: u64,
}
