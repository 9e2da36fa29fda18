//! A body's way through a substep: which stage runs on which row, in which order.
//!
//! The plan lists the stages once. They can be run one by one over the whole body, which is what a schedule does that
//! lets others in between; or pipelined: a stage may work on a row as soon as the stage before it is far enough ahead
//! that none of its sticks reaches a row the other has not finished. Each particle then sees the same work in the same
//! order, and ends at the same bits, but one trip through memory carries a whole substep.
//!
//! ```text
//!   rows  0 | integrate contacts rows(even) rows(odd) columns(even) ... friction
//!         1 |   integrate contacts rows(even) ...          time runs to the right;
//!         2 |     integrate contacts ...                   a stage lags behind the one before
//!         3 |       integrate ...                          by as many rows as its sticks reach down
//! ```

use core::ops::Range;

use fearless_simd::Simd;
use glam::Vec3;

use crate::body::Body;
use crate::columns::{Cell, LANES};
use crate::constants::{LEAST_PIPELINED_CELLS, TETHER_SPEED};
use crate::contact_particle_obstacle::{Moving, ObstacleContacts};
use crate::integrate::{Flight, drift, update_displacements};
use crate::isa::{Isa, Kernel};
use crate::layout::Layout;
use crate::line::{LineScratch, LineSolve, Lines};
use crate::obstacle::Obstacle;
use crate::overlap::Pace;
use crate::settings::{SolverSettings, StickProjection};
use crate::stick::{Exact, Joined, Projection, SquareRootFree, project_listed, project_run};
use crate::topology::{BatchSticks, Topology};

/// A piece of a substep's work that can be done row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Integrate,
    /// Contacts with obstacles.
    Contacts {
        is_first: bool,
    },
    /// One batch of sticks.
    Sticks(usize),
    Tethers,
    /// All rows or all columns, as chains of sticks of this length in metres.
    Lines {
        lines: Lines,
        rest_length: f32,
    },
    /// Displacements follow positions.
    Update,
    Friction,
}

/// The stages of a substep in their order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plan {
    stages: Vec<Stage>,
    /// Rows that each stage is behind the first, where they are pipelined.
    lags: Vec<usize>,
    /// Place of each projection's contacts, sticks, tethers and lines in the stages, in turn.
    projections: Vec<[usize; 4]>,
    cells_of_row: usize,
    rows: usize,
    can_pipeline: bool,
}

impl Plan {
    /// Writes down the order of work for a body with this `stiffness` of its batches, whose island takes `projections`
    /// iterations.
    pub fn make(
        &mut self,
        topology: &Topology,
        settings: &SolverSettings,
        stiffness: &[f32],
        projections: u32,
    ) {
        (self.cells_of_row, self.rows) = topology.layout.rows();
        let is_swept = |&batch: &usize| {
            stiffness[batch] > 0.0
                && Lines::of(&topology.batches[batch], stiffness[batch], settings).is_none()
        };
        let active = (0..stiffness.len()).filter(is_swept).count();
        self.stages.clear();
        self.projections.clear();
        self.stages.push(Stage::Integrate);
        for projection in 0..projections {
            let first = self.stages.len();
            self.stages.push(Stage::Contacts { is_first: projection == 0 });
            let (mut tethers, mut lines) = (self.stages.len(), self.stages.len());
            if projection < settings.iterations {
                self.stages.extend((0..stiffness.len()).filter(is_swept).map(Stage::Sticks));
                // There and back: a symmetric pair of sweeps gains no energy. A rope has only two batches, and the way
                // back would begin with the one just done, which does nothing.
                if projection % 2 == 1 && active > 2 {
                    self.stages[first + 1..].reverse();
                }
                tethers = self.stages.len();
                if settings.tethers && !topology.tethers.is_empty() {
                    self.stages.push(Stage::Tethers);
                }
                lines = self.stages.len();
                // The others would undo what lines have done, and columns hang from the pins.
                for lines in [Lines::Columns, Lines::Rows] {
                    if let Some(rest_length) = lines.rest_length(topology, stiffness, settings) {
                        self.stages.push(Stage::Lines { lines, rest_length });
                    }
                }
            }
            self.projections.push([first, first + 1, tethers, lines]);
        }
        let last = self.stages.len();
        self.projections.push([last, last + 1, last + 1, last + 1]);
        self.stages.extend([Stage::Contacts { is_first: false }, Stage::Update, Stage::Friction]);
        self.lag(topology);
    }

    /// Where the contacts, sticks, tethers and lines of a projection are in the stages.
    fn places(&self, projection: u32) -> [usize; 4] {
        self.projections.get(projection as usize).copied().unwrap_or_default()
    }

    /// The first stage from `first` on that solves lines.
    fn next_lines(&self, first: usize) -> Option<usize> {
        let stages = self.stages.get(first..)?;
        let place = stages.iter().position(|stage| matches!(stage, Stage::Lines { .. }))?;
        Some(first + place)
    }

    /// How far each stage must stay behind the one before, and whether that works for this body.
    fn lag(&mut self, topology: &Topology) {
        let has_whole_rows = matches!(topology.layout, Layout::Grid(grid) if grid.has_whole_rows());
        self.can_pipeline = has_whole_rows && self.cells_of_row * self.rows >= LEAST_PIPELINED_CELLS;
        self.lags.clear();
        let mut lag = 0;
        for stage in &self.stages {
            if let Stage::Sticks(batch) = *stage {
                match &topology.batches[batch].sticks {
                    BatchSticks::Grid { batch, .. } => lag += batch.reach(),
                    BatchSticks::Listed { .. } => self.can_pipeline = false,
                }
            }
            self.lags.push(lag);
        }
    }
}

/// What is the same for all stages of a substep, and comes from outside the body.
#[derive(Clone, Copy, Default)]
pub(crate) struct Surroundings<'a> {
    pub obstacles: &'a [Obstacle],
    pub pace: Pace,
    /// The substep, from 0, and the number of substeps.
    pub substep_index: u32,
    pub substeps: u32,
    pub isa: Isa,
}

/// Free flight for one substep.
pub(crate) fn integrate(body: &mut Body, around: Surroundings) {
    body.move_pins();
    begin_contacts(body, around);
    run(body, around, 0..1, false);
    body.note_pin_travel();
}

/// Contacts with obstacles, before the sticks of projection `index` or, after the last, at the end of the substep.
pub(crate) fn project_contacts(body: &mut Body, around: Surroundings, index: u32) {
    let [contacts, sticks, ..] = body.context.plan.places(index);
    run(body, around, contacts..sticks, false);
}

/// The sticks of projection `index`.
pub(crate) fn relax(body: &mut Body, around: Surroundings, index: u32) {
    let [_, sticks, tethers, _] = body.context.plan.places(index);
    run(body, around, sticks..tethers, false);
}

/// The tethers of projection `index`.
pub(crate) fn tether(body: &mut Body, around: Surroundings, index: u32) {
    let [.., tethers, lines] = body.context.plan.places(index);
    run(body, around, tethers..lines, false);
}

/// The lines of projection `index`.
pub(crate) fn solve_lines(body: &mut Body, around: Surroundings, index: u32) {
    let plan = &body.context.plan;
    let ([.., lines], [next, ..]) = (plan.places(index), plan.places(index + 1));
    run(body, around, lines..next, false);
}

/// Velocities follow positions.
pub(crate) fn update(body: &mut Body, around: Surroundings) {
    let count = body.context.plan.stages.len();
    run(body, around, count.saturating_sub(2)..count.saturating_sub(1), false);
}

/// Friction against obstacles.
pub(crate) fn apply_friction(body: &mut Body, around: Surroundings) {
    let count = body.context.plan.stages.len();
    run(body, around, count.saturating_sub(1)..count, false);
}

/// Whether [`substep`] may be called for the body.
pub(crate) fn can_pipeline(body: &Body) -> bool {
    let Body { context, particles, .. } = body;
    // The drift of a free body is a sum over all rows, and damping is not done row by row.
    context.plan.can_pipeline && particles.masses.has_pins && context.damping.iter().all(|&d| d == 0.0)
}

/// The whole substep of a body that no ball is near.
pub(crate) fn substep(body: &mut Body, around: Surroundings) {
    body.move_pins();
    begin_contacts(body, around);
    // Lines run through all rows: what comes before them and what comes after is pipelined.
    let mut first = 0;
    while let Some(lines) = body.context.plan.next_lines(first) {
        run(body, around, first..lines, true);
        run(body, around, lines..lines + 1, false);
        first = lines + 1;
    }
    let count = body.context.plan.stages.len();
    run(body, around, first..count, true);
    body.note_pin_travel();
}

fn begin_contacts(body: &mut Body, around: Surroundings) {
    let origin = body.particles.origin;
    body.context.contacts.begin_substep(around.obstacles, origin, around.substep_index, around.substeps);
}

fn run(body: &mut Body, around: Surroundings, stages: Range<usize>, is_pipelined: bool) {
    // A body that was taken out in the middle of the step has no plan.
    if stages.is_empty() || stages.end > body.context.plan.stages.len() {
        return;
    }
    let drift = if stages.end + 1 == body.context.plan.stages.len() { drift(body) } else { Vec3::ZERO };
    let Body { particles, topology, settings, context } = body;
    let (inverse_mass, _) = particles.inverse_mass.as_chunks::<LANES>();
    let work = Work {
        moving: Moving {
            position: &mut particles.position.cells,
            displacement: &mut particles.displacement.cells,
            integrated: &mut context.integrated.cells,
        },
        inverse_mass,
        common: &particles.masses.common,
        topology,
        stiffness: &context.stiffness,
        flight: Flight {
            drag: context.drag,
            substep: particles.substep,
            uniform: context.uniform_acceleration,
        },
        varying: &context.acceleration.cells,
        contacts: &mut context.contacts,
        lines: &mut context.lines,
        thickness: settings.thickness,
        around,
        drift,
        tether_reach: TETHER_SPEED * particles.substep,
    };
    let plan = &context.plan;
    match settings.projection {
        StickProjection::Exact => around.isa.run(Run { work, plan, stages, is_pipelined, projection: Exact }),
        StickProjection::SquareRootFree => {
            around.isa.run(Run { work, plan, stages, is_pipelined, projection: SquareRootFree });
        }
    }
}

/// What the stages read and write.
struct Work<'a> {
    moving: Moving<'a>,
    inverse_mass: &'a [[f32; LANES]],
    common: &'a [f32],
    topology: &'a Topology,
    stiffness: &'a [f32],
    flight: Flight,
    varying: &'a [Cell],
    contacts: &'a mut ObstacleContacts,
    lines: &'a mut LineScratch,
    thickness: f32,
    around: Surroundings<'a>,
    drift: Vec3,
    /// How far a tether may pull in one substep, in metres.
    tether_reach: f32,
}

/// Some stages on all rows.
struct Run<'a, P> {
    work: Work<'a>,
    plan: &'a Plan,
    stages: Range<usize>,
    is_pipelined: bool,
    projection: P,
}

impl<P: Projection> Kernel for Run<'_, P> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let Plan { stages, lags, cells_of_row, rows, .. } = self.plan;
        let (stages, lags) = (&stages[self.stages.clone()], &lags[self.stages.clone()]);
        let (first_lag, last_lag) = (lags[0], lags[lags.len() - 1]);
        let (outer, inner) = if self.is_pipelined {
            (rows + last_lag - first_lag, stages.len())
        } else {
            (stages.len(), *rows)
        };
        let place = |i: usize, j: usize| {
            if self.is_pipelined { (j, (i + first_lag).wrapping_sub(lags[j])) } else { (i, j) }
        };
        for i in 0..outer {
            for j in 0..inner {
                let (stage, row) = place(i, j);
                if row < *rows {
                    let cells = row * cells_of_row..(row + 1) * cells_of_row;
                    self.work.stage(simd, stages[stage], row, cells, self.projection);
                }
            }
        }
    }
}

impl Work<'_> {
    /// One stage on one row.
    #[inline(always)]
    fn stage<S: Simd>(
        &mut self,
        simd: S,
        stage: Stage,
        row: usize,
        cells: Range<usize>,
        projection: impl Projection,
    ) {
        match stage {
            Stage::Integrate => {
                let Self { flight, moving, varying, inverse_mass, .. } = self;
                simd.vectorize(
                    #[inline(always)]
                    || flight.integrate(simd, cells, moving, varying, inverse_mass),
                );
            }
            Stage::Contacts { is_first } => {
                let Surroundings { obstacles, pace, .. } = self.around;
                let Self { contacts, moving, thickness, .. } = self;
                if !contacts.is_empty() {
                    simd.vectorize(
                        #[inline(always)]
                        || contacts.project(simd, row, moving, obstacles, *thickness, pace, is_first),
                    );
                }
            }
            Stage::Sticks(batch) => {
                let stiffness = self.stiffness[batch];
                let (position, inverse_mass) = (&mut *self.moving.position, self.inverse_mass);
                let mut joined = Joined { position, inverse_mass, common: self.common };
                let batch = &self.topology.batches[batch];
                match &batch.sticks {
                    BatchSticks::Grid { runs, rest_length, .. } => {
                        for run in runs.of_row(row) {
                            project_run(simd, &mut joined, run, *rest_length, stiffness, projection);
                        }
                    }
                    BatchSticks::Listed { first } if row == 0 => {
                        let sticks = &self.topology.listed[*first..*first + batch.count];
                        project_listed(&mut joined, sticks, stiffness, projection);
                    }
                    BatchSticks::Listed { .. } => {}
                }
            }
            Stage::Tethers => {
                let tethers = &self.topology.tethers;
                let Self { moving, inverse_mass, tether_reach, .. } = self;
                simd.vectorize(
                    #[inline(always)]
                    || tethers.project(simd, cells, moving.position, inverse_mass, *tether_reach),
                );
            }
            Stage::Lines { lines, rest_length } => {
                let Layout::Grid(grid) = self.topology.layout else {
                    return;
                };
                if row == 0 {
                    let (position, inverse_mass) = (&mut *self.moving.position, self.inverse_mass);
                    let mut solve = LineSolve { grid, position, inverse_mass, scratch: self.lines };
                    simd.vectorize(
                        #[inline(always)]
                        || solve.solve(simd, lines, rest_length, projection),
                    );
                }
            }
            Stage::Update => {
                let Self { moving, drift, .. } = self;
                simd.vectorize(
                    #[inline(always)]
                    || update_displacements(simd, cells, moving, *drift),
                );
            }
            Stage::Friction => {
                let Self { contacts, moving, .. } = self;
                if !contacts.is_empty() {
                    simd.vectorize(
                        #[inline(always)]
                        || contacts.apply_friction(simd, row, moving),
                    );
                }
            }
        }
    }
}
