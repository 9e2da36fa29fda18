//! Sweeps: the stages of a substep, or of several, in one trip down the strips of a body.
//!
//! The plan lists the stages once. A schedule that runs systems between them runs them one by one over the whole body.
//! A sweep starts a stage on a strip as soon as the stage before is so far ahead that none of the stage's sticks
//! reaches an unfinished strip. Each particle gets the same operations in the same order, and so the same bits, but one
//! trip through memory carries a whole substep, or several.
//!
//! ```text
//!   strips 0..4 | integrate contacts rows(even) rows(odd) columns(even) ... friction integrate ...
//!          4..8 |   integrate contacts rows(even) ...      time runs to the right;
//!         8..12 |     integrate contacts ...               a stage lags behind the one before
//!        12..16 |       integrate ...                      by as many strips as its sticks reach down
//! ```
//!
//! Two threads share a body that is cut between two strips. Above the cut each stage ends higher up than the stage
//! before it, and below the cut each begins lower down, so that neither half ever needs data of the other. One thread
//! does the wedge that is left when both halves are finished.
//!
//! ```text
//!   strip     | integrate . . . . friction
//!             |  a b o v e        .
//!             |              .
//!     cut ----|---------.  wedge
//!             |              .
//!             |  b e l o w        .
//! ```
//!
//! Design: `docs/design/sweeps_and_threads.md`.

use core::ops::Range;

use fearless_simd::Simd;
use glam::Vec3;

use crate::constants::{BYTES_OF_CELL, LEAST_SHARED_CELLS, LEAST_STRIPS_PER_LAG, SWEPT_BYTES, TETHER_SPEED};
use crate::constraint::direct::line;
use crate::constraint::projection::{Exact, Projection, SquareRootFree};
use crate::contact::body_contacts::BodyContacts;
use crate::contact::particle_obstacle::ObstacleContacts;
use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::motion::integrate::{Flight, drift};
use crate::parallel::workers::Workers;
use crate::simd::columns::LANES;
use crate::simd::isa::Kernel;
use crate::state::body::Body;
use crate::state::settings::StickProjection;
use crate::state::substep::Substep;
use crate::substep::plan::{BodyPlan, Plan, StripStage};
use crate::substep::work::Work;

/// Moves pins to the end of the substep.
pub(crate) fn move_pins(body: &mut Body) {
    body.move_pins();
    body.topology.tethers.note_anchors(&body.particles, &mut body.context.anchors);
}

/// Solves the lines of iteration `index`.
pub(crate) fn solve_lines(
    body: &mut Body,
    plan: &mut BodyPlan,
    substep: Substep,
    index: u32,
    workers: &Workers,
) {
    if plan.plan.solves_lines(index, body.settings.iterations) {
        line::solve(body, &plan.plan.lines, &mut plan.lines, substep, workers);
    }
}

/// True if [`substeps`] may be called for the body: the stages that cannot be done in strips have nothing to do.
pub(crate) fn can_be_swept(body: &Body, contacts: &BodyContacts) -> bool {
    // With a tolerance, the number of iterations is known only in the middle of the substep.
    let is_fixed = body.settings.tolerance == 0.0 || body.settings.iterations == 1;
    let has_pressure = body.pressure > 0.0;
    let has_listed_bends = !body.topology.bends.listed.is_empty();
    // `substeps` notes the ways of pins at the end of a substep, and damping needs them before.
    let is_damped_at_pins =
        !body.context.pin_shifts.is_empty() && body.context.damping.iter().any(|&damping| damping > 0.0);
    let is_in_strips =
        contacts.faces.is_empty() && contacts.embedded.is_empty() && contacts.joints.is_empty();
    is_fixed && is_in_strips && !has_pressure && !has_listed_bends && !is_damped_at_pins
}

/// Takes all substeps that are left, of a body without a ball near it: in sweeps if it is large, else stage by stage.
pub(crate) fn substeps(
    body: &mut Body,
    contacts: &mut ObstacleContacts,
    plan: &mut BodyPlan,
    mut substep: Substep,
    workers: &Workers,
) {
    let BodyPlan { plan, lines } = plan;
    let count = plan.stages.len();
    if count == 0 {
        // The body was taken out in the middle of the step.
        return;
    }
    let per_trip = substeps_per_trip(body, plan, workers);
    let mut stages = |body: &mut Body, substep: Substep, stages: Range<usize>| {
        if plan.can_sweep {
            sweep(body, contacts, plan, substep, stages, workers);
        } else {
            run(body, contacts, plan, substep, stages);
        }
    };
    // The number of stages of the substep that the sweep before has already done.
    let mut done = 0;
    while substep.index < substep.count {
        let taken = per_trip.min(substep.count - substep.index);
        if done == 0 {
            move_pins(body);
        }
        // Lines are solved between sweeps.
        for &place in &plan.places_of_lines {
            stages(body, substep, done..place);
            line::solve(body, &plan.lines, lines, substep, workers);
            done = place;
        }
        let next = match plan.places_of_lines.first() {
            // The first sweep of the next substep is joined to the last sweep of this one.
            Some(&place) if may_join(body, plan) && substep.index + 1 < substep.count => place,
            _ => 0,
        };
        if body.particles.masses.has_pins {
            stages(body, substep, done..taken as usize * count + next);
        } else {
            // The drift of a free body is a sum over all of it.
            stages(body, substep, done..plan.update);
            stages(body, substep, plan.update..count);
        }
        body.note_pin_travel();
        substep.index += taken;
        done = next;
    }
}

/// True if a sweep may go from one substep into the next.
fn may_join(body: &Body, plan: &Plan) -> bool {
    let Body { particles, context, .. } = body;
    let is_steady = context.pin_shifts.is_empty() && particles.excess_length == 0.0;
    plan.can_sweep && particles.masses.has_pins && is_steady
}

/// The number of substeps in one trip through memory: as many as keep the strips between the first stage and the last
/// in the cache.
fn substeps_per_trip(body: &Body, plan: &Plan, workers: &Workers) -> u32 {
    if !may_join(body, plan) || !plan.lines.is_empty() {
        return 1;
    }
    let lag = plan.lag_of_substep().max(1);
    let strips = SWEPT_BYTES / (BYTES_OF_CELL * plan.cells_of_strip);
    let by_cache = strips.saturating_sub(plan.strips_per_turn()) / lag;
    let by_wedge = plan.strips / (LEAST_STRIPS_PER_LAG * workers.most() * lag);
    let most = if workers.most() > 1 { by_cache.min(by_wedge) } else { by_cache };
    most.max(1) as u32
}

/// Runs some stages of a substep, pass by pass over the whole body.
pub(crate) fn run(
    body: &mut Body,
    contacts: &mut ObstacleContacts,
    plan: &Plan,
    substep: Substep,
    stages: Range<usize>,
) {
    if stages.is_empty() {
        return;
    }
    with_work(body, contacts, plan, substep, stages.start, |work, plan, projection| {
        let (top, bottom) = (RegionEdge::level(0), RegionEdge::level(plan.strips));
        for stages in plan.passes(stages) {
            // Listed sticks go down the body by themselves.
            let per_turn = if stages.len() == 1 { plan.strips } else { plan.strips_per_turn() };
            Region { stages, top, bottom }.sweep(work, plan, projection, per_turn);
        }
    });
}

/// Runs some stages, counted through several substeps, in a sweep.
fn sweep(
    body: &mut Body,
    contacts: &mut ObstacleContacts,
    plan: &Plan,
    substep: Substep,
    stages: Range<usize>,
    workers: &Workers,
) {
    if stages.is_empty() {
        return;
    }
    with_work(body, contacts, plan, substep, stages.start, |work, plan, projection| {
        let region = Region { stages, top: RegionEdge::level(0), bottom: RegionEdge::level(plan.strips) };
        region.share(work, plan, projection, workers, workers.count());
    });
}

/// Calls `run` with the data that the stages from `first` on read and write.
fn with_work(
    body: &mut Body,
    contacts: &mut ObstacleContacts,
    plan: &Plan,
    substep: Substep,
    first: usize,
    run: impl FnOnce(&mut Work, &Plan, StickProjection),
) {
    let is_update = plan.stages.get(first) == Some(&StripStage::Update);
    let drift = if is_update { drift(body) } else { Vec3::ZERO };
    let Body { particles, topology, settings, context, .. } = body;
    let (inverse_mass, _) = particles.inverse_mass.as_chunks::<LANES>();
    let length_ratio = particles.length_ratio(substep);
    let mut work = Work {
        first_strip: 0,
        cells_of_strip: plan.cells_of_strip,
        moving: MovingColumns {
            position: &mut particles.position.cells,
            displacement: &mut particles.displacement.cells,
            integrated: &mut context.integrated.cells,
        },
        contacts: contacts.rows(),
        rows: Some(&mut context.rows),
        watch: context.watch.rows(),
        rest: BodyColumns {
            inverse_mass,
            common_mass: &particles.masses.common,
            topology,
            stiffness: &context.stiffness,
            damping: &context.damping,
            flight: Flight {
                drag: context.drag,
                substep: particles.substep,
                uniform: context.uniform_acceleration,
            },
            varying: &context.acceleration.cells,
            anchors: &context.anchors.cells,
            substep,
            origin: particles.origin,
            thickness: settings.thickness,
            drift,
            pose: &particles.pose,
            frame: context.frame.as_ref(),
            tether_reach: TETHER_SPEED * particles.substep,
            length_ratio,
        },
    };
    run(&mut work, plan, settings.projection);
}

/// Some stages, each on the strips between two edges.
#[derive(Clone)]
struct Region {
    /// Indices of stages, counted through several substeps.
    stages: Range<usize>,
    top: RegionEdge,
    bottom: RegionEdge,
}

/// The upper or lower end of a region's strips, stage by stage.
#[derive(Clone, Copy)]
struct RegionEdge {
    strip: usize,
    slope: Slope,
}

#[derive(Clone, Copy)]
enum Slope {
    /// The same strip for all stages.
    Level,
    /// Higher by each stage's lag: above it, no stage touches a strip below the cut.
    Up,
    /// Lower by the lag of the stage before: below it, no stage touches a strip above the cut, or one that it has not
    /// finished.
    Down,
}

impl RegionEdge {
    fn level(strip: usize) -> Self {
        Self { strip, slope: Slope::Level }
    }
}

impl Region {
    /// The number of strips that stage `place` stays behind the first of the region.
    fn lag(&self, plan: &Plan, place: usize) -> usize {
        plan.lag_of(place) - plan.lag_of(self.stages.start)
    }

    fn strips_of(&self, plan: &Plan, place: usize) -> Range<usize> {
        let at = |edge: RegionEdge| match edge.slope {
            Slope::Level => edge.strip,
            Slope::Up => edge.strip - self.lag(plan, place),
            Slope::Down => edge.strip + self.lag(plan, place.max(self.stages.start + 1) - 1),
        };
        at(self.top)..at(self.bottom)
    }

    /// Sweeps it on up to `count` threads.
    fn share(
        &self,
        work: &mut Work,
        plan: &Plan,
        projection: StickProjection,
        workers: &Workers,
        count: usize,
    ) {
        let (top, bottom) = (self.top.strip, self.bottom.strip);
        let steepest = self.lag(plan, self.stages.end - 1) + 1;
        let is_small = (bottom - top) * plan.cells_of_strip < count * LEAST_SHARED_CELLS;
        if count < 2 || is_small || bottom - top < 4 * steepest {
            return self.sweep(work, plan, projection, plan.strips_per_turn());
        }
        let above = count / 2;
        // Each half must hold its two slopes.
        let strip = work
            .balanced_cut(top..bottom, above as f32 / count as f32)
            .clamp(top + 2 * steepest, bottom - 2 * steepest);
        let (up, down) = (RegionEdge { strip, slope: Slope::Up }, RegionEdge { strip, slope: Slope::Down });
        let [upper, lower, wedge] = [(self.top, up), (down, self.bottom), (up, down)]
            .map(|(top, bottom)| Self { stages: self.stages.clone(), top, bottom });
        let (mut work_above, mut work_below) = work.split_at(strip);
        workers.join(&mut || upper.share(&mut work_above, plan, projection, workers, above), &mut || {
            lower.share(&mut work_below, plan, projection, workers, count - above);
        });
        wedge.sweep(work, plan, projection, plan.strips_per_turn());
    }

    /// Sweeps it, `per_turn` strips at a time.
    fn sweep(&self, work: &mut Work, plan: &Plan, projection: StickProjection, per_turn: usize) {
        let isa = work.rest.substep.isa;
        let region = self;
        match projection {
            StickProjection::Exact => isa.run(Sweep { region, work, plan, per_turn, projection: Exact }),
            StickProjection::SquareRootFree => {
                isa.run(Sweep { region, work, plan, per_turn, projection: SquareRootFree });
            }
        }
    }
}

struct Sweep<'r, 'w, P> {
    region: &'r Region,
    work: &'r mut Work<'w>,
    plan: &'r Plan,
    per_turn: usize,
    projection: P,
}

impl<P: Projection> Kernel for Sweep<'_, '_, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { region, work, plan, per_turn, projection } = self;
        let stages = region.stages.clone();
        let count = plan.stages.len();
        let last = stages.end - 1;
        // The sweep ends when the last stage has finished its strips.
        let end = region.strips_of(plan, last).end + region.lag(plan, last);
        for ahead in (region.top.strip..end).step_by(per_turn) {
            for place in stages.clone() {
                let lag = region.lag(plan, place);
                let of_stage = region.strips_of(plan, place);
                let from = ahead.saturating_sub(lag).max(of_stage.start);
                let to = (ahead + per_turn).saturating_sub(lag).min(of_stage.end);
                if from < to {
                    let substep = work.rest.substep.index + (place / count) as u32;
                    work.stage(simd, plan.stages[place % count], substep, from..to, projection);
                }
            }
        }
    }
}
