//! Steps the bodies on the GPU.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;

use crate::clock::DrapeClock;
use crate::environment::solver_environment::SolverEnvironment;
use crate::gpu::bodies::{GpuBodies, Renderer};
use crate::gpu::components::GpuBody;
use crate::gpu::moves::bring_back;

/// Starts a step of all bodies on the GPU, and does not wait for it. If that fails, the processor takes all of them over; if the renderer
/// has another device, they go there in the next step.
pub(crate) fn step_on_gpu(
    mut commands: Commands,
    on_gpu: Query<Entity, (With<GpuBody>, Allow<Disabled>)>,
    solver: Res<SolverEnvironment>,
    renderer: Renderer,
    mut bodies: ResMut<GpuBodies>,
) {
    let is_orphaned = bodies.is_orphaned(&renderer);
    let GpuBodies { world, known_gaps, .. } = &mut *bodies;
    let Some(world) = world else { return };
    let failure = if is_orphaned {
        None
    } else if world.is_empty() {
        return;
    } else if let Err(error) = world.step(&solver.environment) {
        Some(error.to_string())
    } else {
        for &(slot, ref reason) in world.left_out() {
            let entity = solver.obstacles.entity(slot);
            if known_gaps.insert(entity) {
                warn!("bodies on the GPU pass through obstacle {entity}: {reason}");
            }
        }
        return;
    };
    for entity in &on_gpu {
        commands
            .entity(entity)
            .queue_silenced(move |entity: EntityWorldMut| bring_back(entity, !is_orphaned));
    }
    commands.queue(move |world: &mut World| world.resource_mut::<GpuBodies>().close(failure));
}

/// Notes whether this tick took a step. While the clock stands still, bodies are shown as they are, not between two steps.
pub(crate) fn note_motion(clock: Res<DrapeClock>, mut bodies: ResMut<GpuBodies>, mut steps: Local<u64>) {
    bodies.is_moving = clock.steps() != *steps;
    *steps = clock.steps();
}

/// Begins a frame that is drawn: its steps leave alone what the renderer may still draw the last one from.
pub(crate) fn begin_frame(mut bodies: ResMut<GpuBodies>) {
    if let Some(world) = bodies.world_mut() {
        world.begin_frame();
    }
}
