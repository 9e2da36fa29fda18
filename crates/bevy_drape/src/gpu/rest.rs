//! Bodies on the GPU that rest: steps leave them alone until an obstacle, gravity, the wind or a pin moves them.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_solver::world::kind::Kind;
use drape_solver::world::waking::{Proxy, Waking};

use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::clock::DrapeClock;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::GpuBody;
use crate::gpu::report::LastReport;
use crate::sleep::waking::EntityKey;

/// Metres by which a body's box is grown, as what it lies on touches it but for rounding.
const MARGIN: f32 = 1e-3;

/// Wakes bodies where an obstacle moved, appeared or vanished, and all of them if gravity or wind changed; then tells the GPU which bodies rest.
pub(crate) fn wake_on_gpu(
    mut on_gpu: Query<(Entity, &GpuBody, &OnGpu, &mut LastReport, &mut Activity), Allow<Disabled>>,
    solver: Res<SolverEnvironment>,
    wake_regions: Res<WakeRegions>,
    clock: Res<DrapeClock>,
    mut bodies: ResMut<GpuBodies>,
    mut resting: Local<Waking<EntityKey>>,
    mut woken: Local<Vec<EntityKey>>,
    mut last_time: Local<f64>,
) {
    let GpuBodies { world: Some(world), disturbances, .. } = &mut *bodies else { return };
    // When the time goes back, a snapshot was restored, which brings another scene.
    let is_everywhere = solver.air_changed || clock.elapsed() <= *last_time;
    *last_time = clock.elapsed();
    disturbances.add(is_everywhere, &wake_regions.0);

    // Bodies that fell asleep since the last step come first: they may lose their support in this one.
    for (entity, _, parts, last, activity) in &mut on_gpu {
        if *activity == Activity::Resting && activity.is_changed() {
            resting.rest_body(EntityKey(entity), sleeper(parts, &last).bounds);
        }
    }
    wake_regions.0.iter().for_each(|&region| resting.disturb(region));
    let proxy = |EntityKey(entity): EntityKey| {
        let (.., parts, last, activity) = on_gpu.get(entity).ok()?;
        (*activity == Activity::Resting).then(|| sleeper(parts, last))
    };
    resting.wake(proxy, &mut woken);
    for EntityKey(entity) in woken.drain(..) {
        if let Ok((.., mut activity)) = on_gpu.get_mut(entity) {
            *activity = Activity::Active;
        }
    }
    for (entity, body, _, mut last, mut activity) in &mut on_gpu {
        if is_everywhere && *activity == Activity::Resting {
            *activity = Activity::Active;
        }
        if !activity.is_changed() {
            continue;
        }
        // It is there, as its component is.
        let _ = world.set_resting(body.id(), *activity != Activity::Active);
        if *activity != Activity::Resting {
            resting.remove_body(EntityKey(entity));
            last.still_since = None;
        }
    }
}

/// A body that rests, as the search for what wakes it sees it.
pub(super) fn sleeper(parts: &OnGpu, last: &LastReport) -> Proxy {
    Proxy {
        bounds: last.bounds.grown(parts.state.settings.thickness + MARGIN),
        layers: parts.state.layers,
        kind: Kind::Body { has_self_contact: false },
    }
}
