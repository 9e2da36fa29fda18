//! The plan of a body's substep: the stages of the [order](crate::substep::order) that are done strip by strip, for this
//! body's sticks.
//!
//! Design: `docs/design/sweeps_and_threads.md`.

use core::ops::Range;

use crate::constants::{CELLS_AT_ONCE, LEAST_SWEPT_CELLS, MOST_SUBSTEPS_OF_TWO_COLUMNS};
use crate::constraint::direct::grid_lines::{Lines, Solved};
use crate::constraint::direct::line::LineScratch;
use crate::state::settings::BodySettings;
use crate::state::topology::{BatchSticks, StickBatch, Topology};
use crate::substep::order::{BodyStage, Order};

/// A piece of a stage that can be done strip by strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StripStage {
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
    /// The same for a torn grid's loose sticks, which may join any two strips.
    Loose {
        first: usize,
        end: usize,
        backwards: bool,
    },
    /// Damping of one batch of a grid's sticks.
    Damping(usize),
    /// Damping of batches of listed sticks, in a sweep of its own.
    ListedDamping {
        first: usize,
        end: usize,
    },
    /// Damping of one batch of loose sticks.
    LooseDamping(usize),
    Tethers,
    /// The moving frame takes the particles along.
    Carry,
    /// Drives draw particles towards their animated places.
    Drive,
    /// Displacements follow positions.
    Update,
    Friction,
    /// Limits on motion come last, and backstops, which heed them.
    Limits,
    Backstops,
    /// The motion of the frame is subtracted from the displacements.
    Leave,
    /// The watch notes how far particles are off their ways.
    Watch,
}

impl StripStage {
    /// True if it takes the whole body at once, as its sticks may join any two strips.
    fn goes_alone(self) -> bool {
        matches!(
            self,
            Self::Listed { .. } | Self::Loose { .. } | Self::ListedDamping { .. } | Self::LooseDamping(_)
        )
    }

    /// Reverses the order of the batches.
    fn reverse(&mut self) {
        if let Self::Listed { backwards, .. } | Self::Loose { backwards, .. } = self {
            *backwards = true;
        }
    }
}

/// The plan of a body's substep, and the memory of its line solves: kept so that a step allocates nothing once warm.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyPlan {
    pub plan: Plan,
    pub lines: LineScratch,
}

/// How the sticks of a body are relaxed.
#[derive(Clone, Debug)]
pub(crate) struct Relaxation<'a> {
    /// Substeps of the step.
    pub substeps: u32,
    /// The iterations of a substep in which sticks are relaxed.
    pub iterations: Range<u32>,
    /// For each batch of sticks, the part of the errors that an iteration removes.
    pub stiffness: &'a [f32],
    /// For each batch of sticks, the part of the speeds along them that damping removes in a substep.
    pub damping: &'a [f32],
}

/// Stages that few bodies need.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extras {
    /// True if the body is in a moving frame.
    pub has_frame: bool,
    /// True if the body has limits on motion.
    pub has_limits: bool,
    /// True if the body has backstops.
    pub has_backstops: bool,
    /// True if its pose drives it.
    pub has_drives: bool,
}

/// The stages of a substep that are done strip by strip, in their order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plan {
    pub stages: Vec<StripStage>,
    /// The number of strips that each stage stays behind the first in a sweep.
    lags: Vec<usize>,
    /// For each stage of the [order](crate::substep::order), the index of its first strip stage; one more at the end.
    first_of_stage: Vec<u32>,
    /// Lines that are solved directly, and the indices of the stages before which they are solved. Lines run through all
    /// strips, so no sweep crosses a line solve.
    pub lines: Vec<(Lines, Solved)>,
    pub places_of_lines: Vec<usize>,
    /// Index of [`StripStage::Update`], at which displacements follow positions.
    pub update: usize,
    /// Range of the last contacts with obstacles, which layers of cloth repeat.
    pub last_contacts: Range<usize>,
    pub cells_of_strip: usize,
    pub strips: usize,
    /// True if the body may be swept strip by strip, and is large enough for that to pay.
    pub can_sweep: bool,
}

impl Plan {
    /// Lists the strip stages of a body. The island takes `projections` iterations.
    pub fn make(
        &mut self,
        order: Order,
        topology: &Topology,
        settings: &BodySettings,
        Relaxation { substeps, iterations, stiffness, damping }: Relaxation,
        projections: u32,
        extras: Extras,
    ) {
        (self.cells_of_strip, self.strips) = topology.layout.strips();
        self.list_lines(topology, settings, stiffness, substeps <= MOST_SUBSTEPS_OF_TWO_COLUMNS);
        self.stages.clear();
        self.first_of_stage.clear();
        for (stage, projection) in order.of_body(projections) {
            self.first_of_stage.push(self.stages.len() as u32);
            let has_sticks = iterations.contains(&projection);
            match stage {
                BodyStage::Integrate => self.stages.push(StripStage::Integrate),
                BodyStage::Carry => self.stages.extend(extras.has_frame.then_some(StripStage::Carry)),
                BodyStage::Drive => self.stages.extend(extras.has_drives.then_some(StripStage::Drive)),
                BodyStage::ObstacleContacts => {
                    let is_first = projection == 0 && projections > 0;
                    self.last_contacts = self.stages.len()..self.stages.len() + 1;
                    self.stages.push(StripStage::Contacts { is_first });
                }
                BodyStage::Sticks if has_sticks => {
                    self.push_sticks(topology, settings, stiffness, projection % 2 == 1);
                }
                BodyStage::Tethers if has_sticks && settings.tethers && !topology.tethers.is_empty() => {
                    self.stages.push(StripStage::Tethers);
                }
                BodyStage::Lines if self.solves_lines(projection, iterations.end) => {
                    self.places_of_lines.push(self.stages.len());
                }
                BodyStage::Update => {
                    self.update = self.stages.len();
                    self.stages.push(StripStage::Update);
                }
                BodyStage::Damping => self.push_damping(topology, damping),
                BodyStage::ObstacleFriction => self.stages.push(StripStage::Friction),
                BodyStage::Limits => self.stages.extend(extras.has_limits.then_some(StripStage::Limits)),
                BodyStage::Backstops => {
                    self.stages.extend(extras.has_backstops.then_some(StripStage::Backstops));
                }
                BodyStage::Leave => self.stages.extend(extras.has_frame.then_some(StripStage::Leave)),
                BodyStage::Watch => {
                    self.stages.extend(settings.has_self_contact().then_some(StripStage::Watch));
                }
                _ => {}
            }
        }
        self.first_of_stage.push(self.stages.len() as u32);
        self.lag(topology);
    }

    /// Adds the batches of sticks that no line solve takes, in alternating directions: a symmetric pair of sweeps gains
    /// no energy.
    fn push_sticks(&mut self, topology: &Topology, settings: &BodySettings, stiffness: &[f32], is_odd: bool) {
        let first = self.stages.len();
        let is_swept = |&batch: &usize| {
            stiffness[batch] > 0.0
                && Lines::of(&topology.batches[batch], stiffness[batch], topology, settings).is_none()
        };
        let mut active = 0;
        for batch in (0..stiffness.len()).filter(is_swept) {
            self.push_batch(topology, batch, first);
            active += 1;
        }
        // A rope has only two batches: the way back would begin with the batch just done, which changes nothing.
        if is_odd && active > 2 {
            self.stages[first..].reverse();
            self.stages[first..].iter_mut().for_each(StripStage::reverse);
        }
    }

    /// Adds the batches of sticks that are damped. Listed ones that follow each other share a stage.
    fn push_damping(&mut self, topology: &Topology, damping: &[f32]) {
        for batch in (0..damping.len()).filter(|&batch| damping[batch] > 0.0) {
            match (&topology.batches[batch].sticks, self.stages.last_mut()) {
                (BatchSticks::Grid { .. }, _) => self.stages.push(StripStage::Damping(batch)),
                (BatchSticks::Loose(_), _) => self.stages.push(StripStage::LooseDamping(batch)),
                (BatchSticks::Listed(_), Some(StripStage::ListedDamping { end, .. })) if *end == batch => {
                    *end = batch + 1;
                }
                (BatchSticks::Listed(_), _) => {
                    self.stages.push(StripStage::ListedDamping { first: batch, end: batch + 1 });
                }
            }
        }
    }

    /// Lists the line solves. They come last in a projection, as the other sticks would undo them: bends before sticks, and
    /// columns before rows, as they hang from the pins. Springs along them are solved by halves around those along diagonals:
    ///
    /// ```text
    ///   1/2 columns, 1/2 rows, diagonals, 1/2 rows, 1/2 columns
    /// ```
    ///
    /// All of them move the same particles, by turns. A list that reads the same from both ends gains far less energy by that. So rigid
    /// columns come again after the rows, if `repeats_columns`.
    fn list_lines(
        &mut self,
        topology: &Topology,
        settings: &BodySettings,
        stiffness: &[f32],
        repeats_columns: bool,
    ) {
        self.places_of_lines.clear();
        self.lines.clear();
        let threads = [Lines::Columns, Lines::Rows];
        self.lines.extend(threads.into_iter().filter_map(|lines| Some((lines, lines.bends(topology)?))));
        let sticks = |lines: Lines| Some((lines, lines.sticks(topology, stiffness, settings)?));
        let half = |(lines, solved): (Lines, Solved)| Some((lines, solved.half()?));
        let diagonals = [Lines::Diagonals, Lines::Antidiagonals].map(sticks);
        let threads = threads.map(sticks);
        let has_diagonals = diagonals.iter().any(Option::is_some);
        if has_diagonals {
            let halves = threads.into_iter().flatten().filter_map(half);
            self.lines.extend(halves.clone().chain(diagonals.into_iter().flatten()).chain(halves.rev()));
        }
        let is_left = |thread: &(Lines, Solved)| !has_diagonals || half(*thread).is_none();
        self.lines.extend(threads.into_iter().flatten().filter(is_left));
        if let [Some(columns), Some(rows)] = threads
            && repeats_columns
            && [columns, rows].into_iter().all(|lines| half(lines).is_none())
        {
            self.lines.push(columns);
        }
    }

    /// True if lines are solved in this iteration: in the last one, as small sheets would gain energy by more.
    pub fn solves_lines(&self, iteration: u32, iterations: u32) -> bool {
        !self.lines.is_empty() && iteration + 1 == iterations
    }

    /// Adds a batch of sticks. Listed batches that follow each other share a stage, and so do loose ones.
    fn push_batch(&mut self, topology: &Topology, batch: usize, first: usize) {
        let is_listed = |batch: &StickBatch| matches!(batch.sticks, BatchSticks::Listed(_));
        let is_loose = |batch: &StickBatch| matches!(batch.sticks, BatchSticks::Loose(_));
        let all =
            |between: Range<usize>, are: fn(&StickBatch) -> bool| topology.batches[between].iter().all(are);
        match (&topology.batches[batch].sticks, self.stages[first..].last_mut()) {
            (BatchSticks::Grid { .. }, _) => self.stages.push(StripStage::Sticks(batch)),
            (BatchSticks::Listed(_), Some(StripStage::Listed { end, .. })) if all(*end..batch, is_listed) => {
                *end = batch + 1;
            }
            (BatchSticks::Loose(_), Some(StripStage::Loose { end, .. })) if all(*end..batch, is_loose) => {
                *end = batch + 1;
            }
            (BatchSticks::Loose(_), _) => {
                self.stages.push(StripStage::Loose { first: batch, end: batch + 1, backwards: false });
            }
            (BatchSticks::Listed(_), _) => {
                self.stages.push(StripStage::Listed { first: batch, end: batch + 1, backwards: false });
            }
        }
    }

    /// The range of the strip stages of one stage of the order. Empty for a body that was taken out in the middle of
    /// the step, which has no plan.
    pub fn span(&self, stage: usize) -> Range<usize> {
        match self.first_of_stage.get(stage..stage + 2) {
            Some(&[first, end]) => first as usize..end as usize,
            _ => 0..0,
        }
    }

    /// Sets the lags of the stages, and decides if the body can be swept.
    fn lag(&mut self, topology: &Topology) {
        self.can_sweep =
            topology.layout.has_whole_rows() && self.cells_of_strip * self.strips >= LEAST_SWEPT_CELLS;
        self.lags.clear();
        let mut lag = 0;
        for stage in &self.stages {
            match *stage {
                StripStage::Sticks(batch) | StripStage::Damping(batch) => {
                    if let BatchSticks::Grid { runs, .. } = &topology.batches[batch].sticks {
                        lag += runs.reach;
                    }
                }
                stage if stage.goes_alone() => self.can_sweep = false,
                _ => {}
            }
            self.lags.push(lag);
        }
    }

    /// Groups stages into as few passes over the body as possible without a sweep: one for each stage if sticks reach
    /// from strip to strip, else one for all stages between listed or loose sticks.
    pub fn passes(&self, stages: Range<usize>) -> impl Iterator<Item = Range<usize>> + '_ {
        let (mut next, end) = (stages.start, stages.end);
        let is_alone = move |place: usize| self.lag_of_substep() > 0 || self.stages[place].goes_alone();
        core::iter::from_fn(move || {
            let first = next;
            next = (first + 1..end).find(|&place| is_alone(place - 1) || is_alone(place)).unwrap_or(end);
            (first < end).then_some(first..next)
        })
    }

    /// The number of strips between the first stage and the last in a whole substep.
    pub fn lag_of_substep(&self) -> usize {
        self.lags.last().copied().unwrap_or_default()
    }

    /// The number of strips that stage `place` stays behind the first; places count through several substeps.
    pub fn lag_of(&self, place: usize) -> usize {
        let count = self.stages.len();
        place / count * self.lag_of_substep() + self.lags[place % count]
    }

    /// The number of strips that a stage takes in one turn of a sweep.
    pub fn strips_per_turn(&self) -> usize {
        CELLS_AT_ONCE.div_ceil(self.cells_of_strip)
    }
}
