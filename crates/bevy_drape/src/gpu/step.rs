//! Steps the bodies on the GPU.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_gpu::GpuError;

use crate::clock::DrapeClock;
use crate::environment::solver_environment::SolverEnvironment;
use crate::gpu::bodies::{GpuBodies, Renderer};
use crate::gpu::components::GpuBody;
use crate::gpu::moves::bring_back_by;

/// Starts a step of all bodies on the GPU, and does not wait for it. If that fails, the processor takes all of them over.
pub(crate) fn step_on_gpu(
    mut commands: Commands,
    on_gpu: Query<Entity, (With<GpuBody>, Allow<Disabled>)>,
    solver: Res<SolverEnvironment>,
    mut bodies: ResMut<GpuBodies>,
) {
    let GpuBodies { world, known_gaps, .. } = &mut *bodies;
    let Some(world) = world.as_mut().filter(|world| !world.is_empty()) else { return };
    if let Err(error) = world.step(&solver.environment) {
        on_gpu.iter().for_each(|entity| bring_back_by(&mut commands, entity, true));
        commands.queue(move |world: &mut World| {
            world.resource_mut::<GpuBodies>().close(Some(error.to_string()));
        });
        return;
    }
    for &(slot, ref reason) in world.left_out() {
        let entity = solver.obstacles.entity(slot);
        if matches!(reason, GpuError::Unsupported(_)) && known_gaps.insert(entity) {
            warn!("bodies on the GPU pass through obstacle {entity}: {reason}");
        }
    }
    if let Some((_, reason)) =
        world.left_out().iter().find(|(_, reason)| matches!(reason, GpuError::Limit { .. }))
    {
        warn_once!("bodies on the GPU pass through some obstacles: {reason}");
    }
}

/// Notes whether this tick took a step. While the clock stands still, bodies are shown as they are, not between two steps.
pub(crate) fn note_motion(clock: Res<DrapeClock>, mut bodies: ResMut<GpuBodies>, mut steps: Local<u64>) {
    bodies.is_moving = clock.steps() != *steps;
    *steps = clock.steps();
}

/// Begins a frame that is drawn: its steps leave alone what the renderer may still draw the last one from. If the renderer has another device, as after
/// a loss, bodies go there in the next step. Nothing on the old one may be waited for.
pub(crate) fn begin_frame(
    mut commands: Commands,
    on_gpu: Query<Entity, (With<GpuBody>, Allow<Disabled>)>,
    renderer: Renderer,
    mut bodies: ResMut<GpuBodies>,
) {
    if renderer.is_new() && bodies.is_on_renderer() {
        on_gpu.iter().for_each(|entity| bring_back_by(&mut commands, entity, false));
        commands.queue(|world: &mut World| world.resource_mut::<GpuBodies>().close(None));
    } else if let Some(world) = bodies.world.as_mut() {
        world.begin_frame();
    }
}
