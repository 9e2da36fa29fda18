//! Pins of bodies on the GPU that follow the transform of their entity.

use bevy::prelude::*;
use drape_gpu::{GpuError, GpuWorld};
use drape_solver::constants::TELEPORT_SPEED;

use crate::body::on_gpu::OnGpu;
use crate::clock::DrapeClock;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::GpuBody;
use crate::rigid_motion::placement;

/// Moves pins with their entity; they pull the cloth along. A jump faster than [`TELEPORT_SPEED`] brings the body to its first shape
/// at the new place.
pub(crate) fn move_pins_on_gpu(
    mut moved: Query<(Entity, &GlobalTransform, &mut GpuBody, &mut OnGpu), Changed<GlobalTransform>>,
    clock: Res<DrapeClock>,
    mut bodies: ResMut<GpuBodies>,
) {
    let longest_pull = TELEPORT_SPEED * clock.delta();
    let Some(world) = bodies.world_mut() else { return };
    for (entity, transform, mut body, mut parts) in &mut moved {
        let anchor = transform.affine();
        let from = parts.state.anchor;
        if anchor == from || parts.state.pins.is_empty() || !anchor.is_finite() {
            continue;
        }
        parts.state.anchor = anchor;
        let is_pull = |&(_, local): &(u32, Vec3)| {
            from.transform_point3(local).distance(anchor.transform_point3(local)) <= longest_pull
        };
        let is_jump = !parts.state.pins.iter().all(is_pull);
        let told = if is_jump {
            replace(world, &mut body, &mut parts)
        } else {
            let mut targets = parts.state.pins.iter();
            targets.try_for_each(|&(pin, local)| {
                world.set_pin_target(body.0, pin, anchor.transform_point3(local))
            })
        };
        if let Err(error) = told {
            warn!("the pins of {entity} stay where they are on the GPU: {error}");
        }
    }
}

/// Puts a body in its first shape to the place of its entity.
fn replace(world: &mut GpuWorld, body: &mut GpuBody, parts: &mut OnGpu) -> Result<(), GpuError> {
    let OnGpu { particles, state, anchor, .. } = parts;
    if let (Some(from), Some(to)) = (placement(anchor), placement(&state.anchor)) {
        particles.teleport(&from, &to);
    }
    *anchor = state.anchor;
    world.remove(body.0)?;
    body.0 = world.add(&parts.body())?;
    Ok(())
}
