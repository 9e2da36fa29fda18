//! Bodies on the GPU that rest: steps leave them alone until an obstacle, the wind or a pin moves them.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_solver::world::kind::Kind;
use drape_solver::world::waking::{Proxy, Waking};

use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::GpuBody;
use crate::gpu::report::LastReport;
use crate::sleep::waking::EntityKey;

/// Wakes bodies where an obstacle moved, appeared or vanished, and all of them if gravity or wind changed; then tells the GPU which bodies rest.
pub(crate) fn wake_on_gpu(
    mut on_gpu: Query<(Entity, &GpuBody, &OnGpu, &mut LastReport, &mut Activity), Allow<Disabled>>,
    solver: Res<SolverEnvironment>,
    wake_regions: Res<WakeRegions>,
    mut bodies: ResMut<GpuBodies>,
    mut resting: Local<Waking<EntityKey>>,
    mut woken: Local<Vec<EntityKey>>,
) {
    let Some(world) = bodies.world.as_mut() else { return };
    if solver.air_changed {
        for (.., mut activity) in on_gpu.iter_mut().filter(|(.., activity)| **activity == Activity::Resting) {
            *activity = Activity::Active;
        }
    }
    wake_regions.0.iter().for_each(|&region| resting.disturb(region));
    let sleeper = |EntityKey(entity): EntityKey| {
        let (.., body, last, activity) = on_gpu.get(entity).ok()?;
        (*activity == Activity::Resting).then(|| Proxy {
            bounds: last.bounds.grown(body.state.settings.thickness),
            layers: body.state.layers,
            kind: Kind::Body { has_self_contact: false },
        })
    };
    resting.wake(sleeper, &mut woken);
    for EntityKey(entity) in woken.drain(..) {
        if let Ok((.., mut activity)) = on_gpu.get_mut(entity) {
            *activity = Activity::Active;
        }
    }
    for (entity, body, parts, mut last, activity) in &mut on_gpu {
        if !activity.is_changed() {
            continue;
        }
        let is_resting = *activity != Activity::Active;
        // It is there, as its component is.
        let _ = world.set_resting(body.id(), is_resting);
        if is_resting {
            resting.rest_body(EntityKey(entity), last.bounds.grown(parts.state.settings.thickness));
        } else {
            resting.remove_body(EntityKey(entity));
            last.still_since = None;
        }
    }
}
