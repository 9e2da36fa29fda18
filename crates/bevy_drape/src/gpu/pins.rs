//! Pins of bodies on the GPU that follow the transform of their entity.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_gpu::{GpuError, GpuWorld};
use drape_solver::constants::TELEPORT_SPEED;

use crate::attach::pins::is_jump;
use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::clock::DrapeClock;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::GpuBody;
use crate::gpu::report::LastReport;
use crate::refusal::Refusals;

/// Moves pins with their entity; they pull the cloth along. After a jump faster than [`TELEPORT_SPEED`], and if its entity moved while it was frozen,
/// the body begins again at the new place, in the shape that it went to the GPU in.
pub(crate) fn move_pins_on_gpu(
    mut moved: Query<
        (Entity, &GlobalTransform, &mut GpuBody, &mut OnGpu, &mut LastReport, &mut Activity),
        (Or<(Changed<GlobalTransform>, Changed<Activity>)>, Allow<Disabled>),
    >,
    clock: Res<DrapeClock>,
    mut bodies: ResMut<GpuBodies>,
    mut refusals: ResMut<Refusals>,
) {
    let longest_pull = TELEPORT_SPEED * clock.delta();
    let Some(world) = bodies.world.as_mut() else { return };
    for (entity, transform, mut body, mut parts, mut last, mut activity) in &mut moved {
        let anchor = transform.affine();
        if anchor == parts.state.anchor || parts.state.pins.is_empty() || parts.follows_entity(*activity) {
            continue;
        }
        if !anchor.is_finite() {
            refusals.entity(entity, "the new Transform", "it must be finite; the pins stay where they were");
            continue;
        }
        activity.set_if_neq(Activity::Active);
        last.still_since = None;
        let from = core::mem::replace(&mut parts.state.anchor, anchor);
        let begins_again =
            last.was_carried || is_jump(parts.state.pins.iter(), [&from, &anchor], longest_pull);
        let told = if begins_again {
            begin_again(world, &mut body, &mut parts, &mut last)
        } else {
            let mut targets = parts.state.pins.iter();
            targets.try_for_each(|&(pin, local)| {
                world.set_pin_target(body.0, pin, anchor.transform_point3(local))
            })
        };
        if let Err(error) = told {
            warn!("body {entity} stays where it is on the GPU: {error}");
        }
    }
}

/// Replaces a body by the one that went to the GPU, at the place of its entity.
fn begin_again(
    world: &mut GpuWorld,
    body: &mut GpuBody,
    parts: &mut OnGpu,
    last: &mut LastReport,
) -> Result<(), GpuError> {
    parts.follow();
    let there = parts.body();
    let new = world.add(&there)?;
    *last = LastReport::at(&there);
    let old = core::mem::replace(&mut body.0, new);
    world.remove(old)
}
