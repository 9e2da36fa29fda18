//! Times that meshes take.

use core::time::Duration;

use bevy::prelude::*;

/// Wall times of the work that meshes of bodies cause in the main world, besides steps.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
pub struct MeshTimes {
    /// To record the particles of cloths and soft balls after the last step, whichever frame that was in.
    pub record: Duration,
    /// To write the vertices, normals and bounds of the last frame.
    pub write: Duration,
}
