//! The beginning of a body's step: everything that stays the same through its substeps.
//!
//! Design: `docs/design/integration.md`.

use crate::constants::CONTACT_MARGIN;
use crate::constraint::damping::substep_damping;
use crate::constraint::direct::grid_lines::stick_iterations;
use crate::constraint::stick::{greatest_error, iteration_stiffness};
use crate::motion::environment::Environment;
use crate::state::body::Body;
use crate::state::drag::Drag;
use crate::state::frame_motion::SubstepMotion;
use crate::state::settings::{BodySettings, StructuralSolve};
use crate::substep::order::Order;
use crate::substep::plan::{BodyPlan, Extras, Relaxation};

/// Arranges the particles in the topology's layout, and gathers their statistics if anything has changed.
pub(crate) fn prepare(body: &mut Body) {
    let Body { particles, topology, .. } = body;
    particles.arrange(&topology.layout);
    particles.masses.update(&particles.inverse_mass, &particles.layout);
    particles.take_stats();
}

/// Sets everything that stays the same through the substeps of one step, `substep` seconds each.
///
/// `projections` is the number of iterations of the island, and so of the projections of contacts. `structural` is how structural
/// sticks are [solved](structural_solve) in this step.
pub(crate) fn begin_step(
    body: &mut Body,
    plan: &mut BodyPlan,
    order: Order,
    substep: f32,
    substeps: u32,
    projections: u32,
    structural: StructuralSolve,
) {
    let Body { particles, topology, settings, context, .. } = body;
    if [structural, settings.structural].contains(&StructuralSolve::Lines) || topology.has_elastic_lines() {
        plan.lines.reserve(topology);
    }
    let settings = BodySettings { structural, ..*settings };
    particles.set_substep(substep);
    context.drag = Drag::new(settings.drag, substep);
    let iterations = stick_iterations(particles, topology, &settings);
    let materials = topology.batches.iter().map(|batch| &batch.material);
    let effective_substep = context.drag.effective_substep(substep);
    context.stiffness.clear();
    let count = iterations.len() as u32;
    context
        .stiffness
        .extend(materials.clone().map(|m| iteration_stiffness(m.stiffness, effective_substep, count)));
    if !topology.bends.listed.is_empty() {
        context.bends.reserve(particles.layout.cells());
    }
    context.compliance_scale = 1.0 / (effective_substep * effective_substep);
    context.damping.clear();
    context.damping.extend(materials.map(|m| substep_damping(m, substep)));
    if context.integrated.cells.len() != particles.layout.cells() {
        context.integrated.reset(particles.layout.cells());
    }
    let [positions, displacements] = &mut context.rows;
    positions.reset(topology.window(), particles.layout.cells());
    let is_damped = context.damping.iter().any(|&damping| damping > 0.0);
    displacements.reset(if is_damped { topology.window() } else { 0 }, particles.layout.cells());
    let frame = particles.frame.as_ref();
    context.frame = frame.map(|motion| SubstepMotion::new(motion, substeps, particles.origin));
    particles.pose.drives.set_substep(substep);
    let extras = Extras {
        has_frame: context.frame.is_some(),
        has_limits: !particles.pose.limits.is_empty(),
        has_backstops: !particles.pose.backstops.is_empty(),
        has_drives: !particles.pose.drives.is_empty(),
    };
    let relaxation =
        Relaxation { substeps, iterations, stiffness: &context.stiffness, damping: &context.damping };
    plan.plan.make(order, topology, &settings, relaxation, projections, extras);
    context.pin_shifts.clear();
    for &(i, target) in &particles.pin_targets {
        let way = target - particles.origin - particles.position.get(i as usize);
        context.pin_shifts.push((i, way / substeps as f32));
    }
}

/// How the structural sticks of a body are solved in the coming step.
pub(crate) fn structural_solve(body: &Body, environment: &Environment) -> StructuralSolve {
    let Body { particles, topology, settings, .. } = body;
    if topology.is_rope() {
        // Sweeps leave a rope under a heavy body so slack that it swings through sideways.
        let is_joined = !particles.joints.is_empty() && !settings.has_self_contact();
        return if is_joined { StructuralSolve::Lines } else { settings.structural };
    }
    // Lines take the light particles under a mover far into it, which contact then moves out again: a heavy one pushes through. Sweeps in
    // each iteration give it the pull of many.
    let has_iterations = settings.structural == StructuralSolve::Lines && settings.iterations > 1;
    let is_swept = has_iterations && is_near_mover(body, environment);
    if is_swept { StructuralSolve::Sweeps } else { settings.structural }
}

/// True if an obstacle that contacts push around may touch the body in the coming step.
fn is_near_mover(body: &Body, environment: &Environment) -> bool {
    let (low, high) = body.particles.bounds();
    let way = environment.greatest_way(body.particles.greatest_speed());
    let reach = way + body.settings.thickness + CONTACT_MARGIN;
    environment.obstacles.is_any_near(low - reach, high + reach, |obstacle| {
        obstacle.rigid_body().is_some() && obstacle.stops(body.layers)
    })
}

/// Upper bound in metres on the pull of sticks, pins, limits, backstops and the frame on a particle in the coming step,
/// after an edit. Zero if nothing was edited: the work of sticks in the last step is already in the velocities.
pub(crate) fn pull(body: &Body) -> f32 {
    let Body { particles, topology, .. } = body;
    if !particles.disturbed {
        return 0.0;
    }
    let pull = greatest_error(particles, topology).max(particles.pin_way()).max(particles.pose_way());
    pull + particles.frame_way()
}
