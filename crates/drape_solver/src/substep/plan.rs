//! The order of a substep's work for one body.

use core::ops::Range;

use crate::constants::{CELLS_AT_ONCE, LEAST_SWEPT_CELLS};
use crate::constraint::direct::line::Lines;
use crate::state::settings::{SolverSettings, StructuralSolve};
use crate::state::topology::{BatchSticks, StickBatch, Topology};

/// A piece of a substep's work that can be done strip by strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    Integrate,
    /// Contacts with obstacles.
    Contacts {
        is_first: bool,
    },
    /// One batch of a grid's sticks.
    Sticks(usize),
    /// Batches of listed sticks from `first` up to `end`, the last first if `backwards`. They have a sweep of their own
    /// through the whole body.
    Listed {
        first: usize,
        end: usize,
        backwards: bool,
    },
    /// The same of a torn grid's loose sticks, which may join any two strips.
    Loose {
        first: usize,
        end: usize,
        backwards: bool,
    },
    Tethers,
    /// The frame in which the body moves takes it along.
    Carry,
    /// Displacements follow positions.
    Update,
    Friction,
    /// Limits on motion have the last word.
    Limits,
    /// The motion of the frame is taken off the displacements.
    Leave,
}

impl Stage {
    /// The same work the other way round.
    fn turn(&mut self) {
        if let Self::Listed { backwards, .. } | Self::Loose { backwards, .. } = self {
            *backwards = true;
        }
    }
}

/// What few bodies need.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extras {
    /// Whether the frame in which the body moves moves.
    pub has_frame: bool,
    /// Whether it has limits on motion.
    pub has_limits: bool,
}

/// The stages of a substep in their order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plan {
    pub stages: Vec<Stage>,
    /// Strips that each stage must stay behind the first, in a sweep.
    lags: Vec<usize>,
    /// Place of each projection's contacts, sticks and tethers in the stages, in turn.
    projections: Vec<[usize; 3]>,
    /// Lines to be solved, with the length of their sticks in metres, and the places in the stages before which all of
    /// them are: after the tethers of each projection. They run through all strips, and no sweep through them.
    pub lines: Vec<(Lines, f32)>,
    pub places_of_lines: Vec<usize>,
    pub cells_of_strip: usize,
    pub strips: usize,
    /// Whether the body may be swept strip by strip, and is large enough for that to pay.
    pub can_sweep: bool,
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
        extras: Extras,
    ) {
        (self.cells_of_strip, self.strips) = topology.layout.strips();
        let mut settings = *settings;
        if topology.layout.is_torn() {
            // A line with gaps is no chain.
            settings.structural = StructuralSolve::default();
        }
        let settings = &settings;
        let is_swept = |&batch: &usize| {
            stiffness[batch] > 0.0
                && Lines::of(&topology.batches[batch], stiffness[batch], settings).is_none()
        };
        let active = (0..stiffness.len()).filter(is_swept).count();
        self.list_lines(topology, settings, stiffness);
        self.stages.clear();
        self.projections.clear();
        self.stages.push(Stage::Integrate);
        if extras.has_frame {
            self.stages.push(Stage::Carry);
        }
        for projection in 0..projections {
            let first = self.stages.len();
            self.stages.push(Stage::Contacts { is_first: projection == 0 });
            let mut tethers = self.stages.len();
            if projection < settings.iterations {
                for batch in (0..stiffness.len()).filter(is_swept) {
                    self.push_batch(topology, batch);
                }
                // There and back: a symmetric pair of sweeps gains no energy. A rope has only two batches, and the way
                // back would begin with the one just done, which does nothing.
                if projection % 2 == 1 && active > 2 {
                    self.stages[first + 1..].reverse();
                    self.stages[first + 1..].iter_mut().for_each(Stage::turn);
                }
                tethers = self.stages.len();
                if settings.tethers && !topology.tethers.is_empty() {
                    self.stages.push(Stage::Tethers);
                }
                if !self.lines.is_empty() {
                    self.places_of_lines.push(self.stages.len());
                }
            }
            self.projections.push([first, first + 1, tethers]);
        }
        let last = self.stages.len();
        self.projections.push([last, last + 1, last + 1]);
        self.stages.extend([Stage::Contacts { is_first: false }, Stage::Update, Stage::Friction]);
        self.stages.extend(extras.has_limits.then_some(Stage::Limits));
        self.stages.extend(extras.has_frame.then_some(Stage::Leave));
        self.lag(topology);
    }

    /// Last of a projection, as the other sticks would undo what lines have done; columns first, as they hang from the
    /// pins.
    fn list_lines(&mut self, topology: &Topology, settings: &SolverSettings, stiffness: &[f32]) {
        self.places_of_lines.clear();
        self.lines.clear();
        self.lines.extend([Lines::Columns, Lines::Rows].into_iter().filter_map(|lines| {
            let rest_length = lines.rest_length(topology, stiffness, settings)?;
            Some((lines, rest_length))
        }));
    }

    /// Adds a batch of sticks, to the listed ones before if it is listed as well.
    fn push_batch(&mut self, topology: &Topology, batch: usize) {
        let is_listed = |batch: &StickBatch| matches!(batch.sticks, BatchSticks::Listed(_));
        let is_loose = |batch: &StickBatch| matches!(batch.sticks, BatchSticks::Loose(_));
        let all =
            |between: Range<usize>, are: fn(&StickBatch) -> bool| topology.batches[between].iter().all(are);
        match (&topology.batches[batch].sticks, self.stages.last_mut()) {
            (BatchSticks::Grid { .. }, _) => self.stages.push(Stage::Sticks(batch)),
            (BatchSticks::Listed(_), Some(Stage::Listed { end, .. })) if all(*end..batch, is_listed) => {
                *end = batch + 1;
            }
            (BatchSticks::Loose(_), Some(Stage::Loose { end, .. })) if all(*end..batch, is_loose) => {
                *end = batch + 1;
            }
            (BatchSticks::Loose(_), _) => {
                self.stages.push(Stage::Loose { first: batch, end: batch + 1, backwards: false });
            }
            (BatchSticks::Listed(_), _) => {
                self.stages.push(Stage::Listed { first: batch, end: batch + 1, backwards: false });
            }
        }
    }

    /// Where the contacts, sticks and tethers of a projection are in the stages.
    pub fn places(&self, projection: u32) -> [usize; 3] {
        self.projections.get(projection as usize).copied().unwrap_or_default()
    }

    /// The place of [`Stage::Update`], at which displacements follow positions; friction comes next.
    pub fn update(&self) -> usize {
        self.places(self.projections.len().saturating_sub(1) as u32)[1]
    }

    /// How far each stage must stay behind the one before, and whether that works for this body.
    fn lag(&mut self, topology: &Topology) {
        self.can_sweep =
            topology.layout.has_whole_rows() && self.cells_of_strip * self.strips >= LEAST_SWEPT_CELLS;
        self.lags.clear();
        let mut lag = 0;
        for stage in &self.stages {
            match *stage {
                Stage::Sticks(batch) => {
                    if let BatchSticks::Grid { runs, .. } = &topology.batches[batch].sticks {
                        lag += runs.reach;
                    }
                }
                Stage::Listed { .. } | Stage::Loose { .. } => self.can_sweep = false,
                _ => {}
            }
            self.lags.push(lag);
        }
    }

    /// Stages in as few passes over the body as there can be without a sweep: one for each, unless no stick reaches from
    /// strip to strip; then one for all up to listed sticks, and so on.
    pub fn passes(&self, stages: Range<usize>) -> impl Iterator<Item = Range<usize>> + '_ {
        let (mut next, end) = (stages.start, stages.end);
        let goes_alone = |stage: Stage| matches!(stage, Stage::Listed { .. } | Stage::Loose { .. });
        let is_alone = move |place: usize| self.lag_of_substep() > 0 || goes_alone(self.stages[place]);
        core::iter::from_fn(move || {
            let first = next;
            next = (first + 1..end).find(|&place| is_alone(place - 1) || is_alone(place)).unwrap_or(end);
            (first < end).then_some(first..next)
        })
    }

    /// Strips that a whole substep needs between the first stage and the last.
    pub fn lag_of_substep(&self) -> usize {
        self.lags.last().copied().unwrap_or_default()
    }

    /// Strips that stage `place` must stay behind the first, where places are counted through several substeps.
    pub fn lag_of(&self, place: usize) -> usize {
        let count = self.stages.len();
        place / count * self.lag_of_substep() + self.lags[place % count]
    }

    /// Strips that a stage takes at once in a sweep.
    pub fn strips_at_once(&self) -> usize {
        CELLS_AT_ONCE.div_ceil(self.cells_of_strip)
    }
}
