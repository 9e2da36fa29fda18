//! Bounds of bodies on the GPU, from what it reports some frames later.
//!
//! ```text
//!                    2 reach
//!     +-------------------------------+   the bounds that are kept: they hold the
//!     |    reach                      |   box that is needed, and are at most twice
//!     |  +-----------------------+    |   as large
//!     |  |   +---------------+   |    |
//!     |  |   | as reported   |   |    |   reach: the way that the fastest particle
//!     |  |   +---------------+   |    |   goes until the next report
//!     |  +-----------------------+    |
//!     +-------------------------------+
//! ```

use bevy::camera::primitives::Aabb;
use bevy::math::Vec3A;
use bevy::prelude::*;
use drape_gpu::{BodyStatus, GpuBodyId};

use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::{GpuBody, SolveOnGpu};
use crate::refusal::Refusals;
use crate::render::surface::{EntitySpace, Surface};

/// Seconds that a report is old when the next one comes, at most: some frames.
const LATENESS: f32 = 0.1;

/// Metres per second by which a body may become faster meanwhile.
const SURPRISE: f32 = 1.0;

/// Gives bodies new bounds when the GPU has reported, and asks for the next report. A change of bounds costs the renderer something: they stay
/// while they are good enough.
pub(crate) fn follow_bounds(
    mut on_gpu: Query<(Entity, &GpuBody, &GlobalTransform, &mut Aabb), With<Surface>>,
    mut bodies: ResMut<GpuBodies>,
    mut refusals: ResMut<Refusals>,
) {
    let GpuBodies { world, report, .. } = &mut *bodies;
    let Some(world) = world else { return };
    let mut statuses = Vec::new();
    if let Some(pending) = report.take() {
        match pending.try_take() {
            Ok(Ok(reported)) => statuses = reported,
            Ok(Err(later)) => {
                *report = Some(later);
                return;
            }
            // The next step notices it too.
            Err(_) => return,
        }
    }
    *report = world.request_statuses().ok();
    for (entity, body, transform, mut bounds) in &mut on_gpu {
        let (Some(status), Some(space)) = (status_of(&statuses, body.id()), EntitySpace::new(transform))
        else {
            continue;
        };
        if status.has_fault {
            refusals.entity(
                entity,
                SolveOnGpu::NAME,
                "a particle is nowhere, or farther away than anything may be",
            );
        }
        let grown = |reach: f32| {
            let corners = [status.low - reach, status.high + reach];
            let [low, high] = corners.map(|corner| corner - transform.translation());
            space.bounds(low, high)
        };
        let reach = (status.greatest_speed + SURPRISE) * LATENESS;
        let needed = grown(reach);
        if !is_good(&bounds, &needed) {
            *bounds = grown(2.0 * reach);
        }
    }
}

/// The status of a body in a list that is ordered by ids.
fn status_of(statuses: &[(GpuBodyId, BodyStatus)], id: GpuBodyId) -> Option<&BodyStatus> {
    let found = statuses.binary_search_by_key(&id, |(id, _)| *id).ok()?;
    Some(&statuses[found].1)
}

/// True if `bounds` hold what is needed, and not much more.
fn is_good(bounds: &Aabb, needed: &Aabb) -> bool {
    let is_within = bounds.min().cmple(needed.min()).all() && bounds.max().cmpge(needed.max()).all();
    let most: Vec3A = needed.half_extents * 2.0;
    is_within && bounds.half_extents.cmple(most).all()
}
