//! The beginning of a body's step: everything that stays the same through its substeps.
//!
//! Design: `docs/design/integration.md`.

use crate::constraint::stick::{greatest_error, iteration_stiffness, substep_damping};
use crate::state::body::Body;
use crate::state::drag::Drag;
use crate::state::frame_motion::SubstepMotion;
use crate::state::particles::Particles;
use crate::state::pose_constraints::PoseConstraints;
use crate::state::settings::StructuralSolve;
use crate::substep::order::Order;
use crate::substep::plan::{BodyPlan, Extras};

/// Arranges the particles in the topology's layout, and gathers their statistics if anything has changed.
pub(crate) fn prepare(body: &mut Body) {
    let Body { particles, topology, .. } = body;
    particles.arrange(&topology.layout);
    particles.masses.update(&particles.inverse_mass, &particles.layout);
    particles.take_stats();
}

/// Sets everything that stays the same through the substeps of one step, `substep` seconds each.
///
/// `projections` is the number of iterations of the island, and so of the projections of contacts.
pub(crate) fn begin_step(
    body: &mut Body,
    plan: &mut BodyPlan,
    order: Order,
    substep: f32,
    substeps: u32,
    projections: u32,
) {
    let Body { particles, topology, settings, context, .. } = body;
    particles.set_substep(substep);
    context.drag = Drag::new(settings.drag, substep);
    let materials = topology.batches.iter().map(|batch| &batch.material);
    let effective_substep = context.drag.effective_substep(substep);
    context.stiffness.clear();
    context.stiffness.extend(
        materials.clone().map(|m| iteration_stiffness(m.stiffness, effective_substep, settings.iterations)),
    );
    context.damping.clear();
    context.damping.extend(materials.map(|m| substep_damping(m, substep)));
    if context.integrated.cells.len() != particles.layout.cells() {
        context.integrated.reset(particles.layout.cells());
    }
    context.rows.reset(topology.window(), particles.layout.cells());
    let mut settings = *settings;
    if !particles.joints.is_empty() && topology.is_rope() && !settings.has_self_contact() {
        // Sweeps leave a rope under a heavy body so slack that it swings through sideways.
        settings.structural = StructuralSolve::Lines;
    }
    if settings.structural == StructuralSolve::Lines {
        plan.lines.reserve(&topology.layout);
    }
    let frame = particles.frame.as_ref();
    context.frame = frame.map(|motion| SubstepMotion::new(motion, substeps, particles.origin));
    particles.pose.drives.set_substep(substep);
    let extras = Extras {
        has_frame: context.frame.is_some(),
        has_limits: !particles.pose.limits.is_empty(),
        has_backstops: !particles.pose.backstops.is_empty(),
        has_drives: !particles.pose.drives.is_empty(),
    };
    plan.plan.make(order, topology, &settings, &context.stiffness, projections, extras);
    context.pin_shifts.clear();
    for &(i, target) in &particles.pin_targets {
        let way = target - particles.origin - particles.position.get(i as usize);
        context.pin_shifts.push((i, way / substeps as f32));
    }
}

/// Upper bound in metres on the pull of sticks, pins, limits, backstops and the frame on a particle in the coming step,
/// after an edit. Zero if nothing was edited: the work of sticks in the last step is already in the velocities.
pub(crate) fn pull(body: &Body) -> f32 {
    if !body.particles.disturbed {
        return 0.0;
    }
    let pins = body.particles.pin_targets.iter();
    let ways = pins
        .map(|&(i, target)| target.distance(body.particles.origin + body.particles.position.get(i as usize)));
    let pull = ways.fold(greatest_error(&body.particles, &body.topology), f32::max);
    let Particles { layout, pose, position, frame, .. } = &body.particles;
    let tied = layout.slots().filter(|_| !pose.is_empty());
    let held_back = tied.map(|slot| pose.pull(slot, position.get(slot)));
    let carried = frame.map_or(0.0, |motion| motion.reach(body.particles.bounds()));
    held_back.fold(pull, f32::max) + carried
}

/// Upper bound in metres on the way by which drives add to the way of a particle in the coming step of `dt` seconds.
pub(crate) fn drive_reach(body: &Body, dt: f32) -> f32 {
    let Particles { layout, pose: PoseConstraints { drives, .. }, position, .. } = &body.particles;
    if drives.is_empty() {
        return 0.0;
    }
    let ways = layout.slots().filter_map(|slot| {
        let angle = drives.get(slot)?.angular_frequency * dt;
        let [now, next] = drives.place.get(slot);
        // An undamped drive takes the particle as far beyond its place.
        Some(next.distance(position.get(slot)) * (angle * angle).min(2.0) + now.distance(next))
    });
    ways.fold(0.0, f32::max)
}
