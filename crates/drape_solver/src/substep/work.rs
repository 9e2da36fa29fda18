//! The work of each stage on some strips of a body, and the data that stages read and write.
//!
//! Design: `docs/design/sweeps_and_threads.md`.

use core::ops::Range;

use fearless_simd::Simd;

use crate::constants::WORK_OF_CONTACTS;
use crate::constraint::damping::DampedColumns;
use crate::constraint::listed_damping::Damping;
use crate::constraint::listed_stick::{BatchPass, BlockWork, Relaxation};
use crate::constraint::projection::{OneSided, Projection};
use crate::constraint::stick::{Alike, Joined, project_loose, project_runs};
use crate::contact::particle_obstacle::{ObstacleProjection, ObstacleRows};
use crate::motion::body_columns::{BodyColumns, MovingColumns};
use crate::motion::integrate::update_displacements;
use crate::simd::rows::Rows;
use crate::state::topology::{BatchSticks, StickBatch};
use crate::state::watch::WatchRows;
use crate::substep::plan::StripStage;

/// Some strips of a body: all, or those above or below a cut.
pub(crate) struct Work<'a> {
    /// Index in the body of the first strip here.
    pub first_strip: usize,
    pub cells_of_strip: usize,
    pub moving: MovingColumns<'a>,
    pub contacts: ObstacleRows<'a>,
    /// The rows in which listed sticks are relaxed and damped. None in a part of a body: a body with listed sticks is never cut.
    pub rows: Option<&'a mut [Rows; 2]>,
    pub watch: WatchRows<'a>,
    pub rest: BodyColumns<'a>,
}

impl Work<'_> {
    /// The strip above which there is this `part` of the work of some strips.
    pub fn balanced_cut(&self, strips: Range<usize>, part: f32) -> usize {
        let work_above = |strip: usize| {
            let cells = (strip * self.cells_of_strip) as f32;
            cells + self.contacts.candidates_above(strip) as f32 * WORK_OF_CONTACTS
        };
        let [first, last] = [strips.start, strips.end].map(work_above);
        let wanted = first + (last - first) * part;
        let (mut low, mut high) = (strips.start, strips.end);
        while low < high {
            let middle = low.midpoint(high);
            if work_above(middle) < wanted { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// Splits it in two above `strip`.
    pub fn split_at(&mut self, strip: usize) -> (Work<'_>, Work<'_>) {
        let &mut Self { first_strip, cells_of_strip, rest, .. } = self;
        let cells = ((strip - first_strip) * cells_of_strip).min(self.moving.position.len());
        let MovingColumns { position, displacement, integrated } = &mut self.moving;
        let position = position.split_at_mut(cells);
        let displacement = displacement.split_at_mut(cells);
        let integrated = integrated.split_at_mut(cells);
        let contacts = self.contacts.split_at(strip);
        let watch = self.watch.split_at(strip - first_strip, cells);
        let above =
            MovingColumns { position: position.0, displacement: displacement.0, integrated: integrated.0 };
        let below =
            MovingColumns { position: position.1, displacement: displacement.1, integrated: integrated.1 };
        (
            Work {
                first_strip,
                cells_of_strip,
                moving: above,
                contacts: contacts.0,
                rows: None,
                watch: watch.0,
                rest,
            },
            Work {
                first_strip: strip,
                cells_of_strip,
                moving: below,
                contacts: contacts.1,
                rows: None,
                watch: watch.1,
                rest,
            },
        )
    }

    /// One stage on some strips of the body, in substep `index` of the step.
    #[inline(always)]
    pub fn stage<S: Simd>(
        &mut self,
        simd: S,
        stage: StripStage,
        index: u32,
        strips: Range<usize>,
        projection: impl Projection,
    ) {
        match stage {
            StripStage::Sticks(batch) => self.grid_sticks(simd, batch, &strips, projection),
            StripStage::Damping(batch) => self.grid_damping(simd, batch, &strips),
            // Listed sticks have a sweep of their own, so the whole body is done at the first strip.
            StripStage::Listed { .. } | StripStage::ListedDamping { .. } | StripStage::LooseDamping(_)
                if strips.start > 0 => {}
            StripStage::ListedDamping { first, end } => self.listed_damping(simd, first..end),
            StripStage::LooseDamping(batch) => self.loose_damping(batch),
            StripStage::Listed { first, end, backwards } => {
                self.listed_sticks(simd, in_order(first, end, backwards), projection);
            }
            StripStage::Loose { first, end, backwards } => {
                self.loose_sticks(first, end, backwards, projection);
            }
            _ => self.particles(simd, stage, index, strips, projection),
        }
    }

    /// The stages of particles: flight, drives, contacts, tethers, limits, backstops.
    #[inline(always)]
    fn particles<S: Simd>(
        &mut self,
        simd: S,
        stage: StripStage,
        index: u32,
        strips: Range<usize>,
        projection: impl Projection,
    ) {
        let Self {
            first_strip, cells_of_strip, ref mut moving, ref mut contacts, ref mut watch, rest, ..
        } = *self;
        let first_cell = first_strip * cells_of_strip;
        let last_cell = first_cell + moving.position.len();
        // The same cells, counted in the body and in the columns of this part.
        let cells = strips.start * cells_of_strip..(strips.end * cells_of_strip).min(last_cell);
        let places = cells.start - first_cell..cells.end - first_cell;
        match stage {
            StripStage::Integrate => simd.vectorize(
                #[inline(always)]
                || rest.flight.integrate(simd, moving, places, &rest, cells),
            ),
            StripStage::Contacts { is_first } if !contacts.is_empty() => {
                let context = ObstacleProjection::new(&rest, index, is_first);
                simd.vectorize(
                    #[inline(always)]
                    || contacts.project(simd, strips, moving, first_cell, &context),
                );
            }
            StripStage::Friction if !contacts.is_empty() => {
                let context = ObstacleProjection::new(&rest, index, false);
                simd.vectorize(
                    #[inline(always)]
                    || contacts.apply_friction(simd, strips, moving, first_cell, &context),
                );
            }
            StripStage::Tethers => {
                let mut joined = Joined::new(moving.position, &rest, first_cell);
                simd.vectorize(
                    #[inline(always)]
                    || rest.topology.tethers.project(simd, cells, places, &mut joined, &rest, projection),
                );
            }
            StripStage::Carry | StripStage::Leave => {
                if let Some(frame) = rest.frame {
                    let is_start = stage == StripStage::Carry;
                    simd.vectorize(
                        #[inline(always)]
                        || {
                            if is_start {
                                frame.carry(simd, moving, places, &rest, cells, index);
                            } else {
                                frame.leave(simd, moving, places, &rest, cells, index);
                            }
                        },
                    );
                }
            }
            StripStage::Drive | StripStage::Limits | StripStage::Backstops => {
                let pose = rest.pose;
                let count = rest.substep.count as f32;
                let [before, after] = [index, index + 1].map(|passed| passed as f32 / count);
                // A user system between two stages may have removed what the plan was made for.
                simd.vectorize(
                    #[inline(always)]
                    || match stage {
                        StripStage::Drive if pose.drives.has_factors() => {
                            pose.drives.draw(simd, moving, places, &rest, cells, before);
                        }
                        StripStage::Limits if !pose.limits.is_empty() => {
                            pose.limits.enforce(simd, moving, places, &rest, cells, after);
                        }
                        StripStage::Backstops if !pose.backstops.is_empty() => {
                            pose.backstops.enforce(simd, moving, places, &rest, cells, [before, after]);
                        }
                        _ => {}
                    },
                );
            }
            StripStage::Update => simd.vectorize(
                #[inline(always)]
                || update_displacements(simd, places, moving, rest.drift),
            ),
            StripStage::Watch if watch.is_on() => {
                let strips = strips.start - first_strip..strips.end - first_strip;
                simd.vectorize(
                    #[inline(always)]
                    || watch.note(simd, moving.position, strips, cells_of_strip, index),
                );
            }
            // No contacts, nothing to watch, or a stage of sticks.
            StripStage::Watch
            | StripStage::Contacts { .. }
            | StripStage::Friction
            | StripStage::Sticks(_)
            | StripStage::Listed { .. }
            | StripStage::Loose { .. }
            | StripStage::Damping(_)
            | StripStage::ListedDamping { .. }
            | StripStage::LooseDamping(_) => {}
        }
    }

    /// One batch of a grid's sticks.
    #[inline(always)]
    fn grid_sticks<S: Simd>(
        &mut self,
        simd: S,
        batch: usize,
        strips: &Range<usize>,
        projection: impl Projection,
    ) {
        let Self { first_strip, cells_of_strip, ref mut moving, rest, .. } = *self;
        let mut joined = Joined::new(moving.position, &rest, first_strip * cells_of_strip);
        if let BatchSticks::Grid { ref runs, rest_length, .. } = rest.topology.batches[batch].sticks {
            let rest_length = rest_length * rest.length_ratio;
            let alike = Alike { rest_length, stiffness: rest.stiffness[batch], projection };
            for (band, runs) in runs.bands() {
                let first_cells = band.among(strips).map(|strip| (strip - first_strip) * cells_of_strip);
                project_runs(simd, &mut joined, runs, first_cells, alike);
            }
        }
    }

    /// Some batches of listed sticks, of the whole body.
    #[inline(always)]
    fn listed_sticks<S: Simd>(
        &mut self,
        simd: S,
        batches: impl Iterator<Item = usize> + Clone,
        projection: impl Projection,
    ) {
        let BodyColumns { topology, stiffness, inverse_mass, .. } = self.rest;
        let passes = passes(self.rest, batches, stiffness);
        if let Some([rows, _]) = self.rows.as_deref_mut() {
            let (position, sticks) = (&mut *self.moving.position, &topology.listed);
            let cells = position.len();
            Relaxation { rows, position, inverse_mass, sticks, projection }.descend(simd, cells, passes);
        }
    }

    /// Damping of some batches of listed sticks, of the whole body.
    #[inline(always)]
    fn listed_damping<S: Simd>(&mut self, simd: S, batches: Range<usize>) {
        let BodyColumns { topology, damping, inverse_mass, .. } = self.rest;
        let passes = passes(self.rest, batches, damping);
        if let Some(rows) = self.rows.as_deref_mut() {
            let MovingColumns { position, displacement, .. } = &mut self.moving;
            let cells = position.len();
            Damping { rows, position, displacement, inverse_mass, sticks: &topology.listed }
                .descend(simd, cells, passes);
        }
    }

    /// Damping of one batch of a grid's sticks.
    #[inline(always)]
    fn grid_damping<S: Simd>(&mut self, simd: S, batch: usize, strips: &Range<usize>) {
        let Self { first_strip, cells_of_strip, ref mut moving, rest, .. } = *self;
        let mut columns = damped_columns(moving, &rest, first_strip * cells_of_strip);
        let part = rest.damping[batch];
        if let BatchSticks::Grid { runs, .. } = &rest.topology.batches[batch].sticks {
            for (band, runs) in runs.bands() {
                let first_cells = band.among(strips).map(|strip| (strip - first_strip) * cells_of_strip);
                for run in runs {
                    let first_cells = first_cells.clone();
                    simd.vectorize(
                        #[inline(always)]
                        || columns.damp_run(simd, run, first_cells, part),
                    );
                }
            }
        }
    }

    /// Damping of one batch of a torn grid's loose sticks.
    fn loose_damping(&mut self, batch: usize) {
        let StickBatch { material, sticks, .. } = &self.rest.topology.batches[batch];
        if let BatchSticks::Loose(loose) = sticks {
            let mut columns = damped_columns(&mut self.moving, &self.rest, 0);
            columns.damp_loose(loose, self.rest.damping[batch], material.bound);
        }
    }

    /// Some batches of a torn grid's loose sticks.
    #[inline(always)]
    fn loose_sticks(&mut self, first: usize, end: usize, backwards: bool, projection: impl Projection) {
        let Self { first_strip, cells_of_strip, ref mut moving, rest, .. } = *self;
        let batches = in_order(first, end, backwards);
        for batch in batches.filter(|&batch| rest.stiffness[batch] > 0.0) {
            if let BatchSticks::Loose(loose) = &rest.topology.batches[batch].sticks {
                let mut joined = Joined::new(moving.position, &rest, first_strip * cells_of_strip);
                let (stiffness, bound) = (rest.stiffness[batch], rest.topology.batches[batch].material.bound);
                match OneSided::of(bound, projection) {
                    None => project_loose(&mut joined, loose, backwards, stiffness, projection),
                    Some(one) => project_loose(&mut joined, loose, backwards, stiffness, one),
                }
            }
        }
    }
}

/// The passes through some listed batches that take these parts; those with none are left out.
fn passes<'a>(
    rest: BodyColumns<'a>,
    batches: impl Iterator<Item = usize> + Clone,
    parts: &'a [f32],
) -> impl Iterator<Item = BatchPass<'a>> + Clone {
    batches.filter_map(move |place| {
        let StickBatch { material, sticks, .. } = &rest.topology.batches[place];
        match sticks {
            BatchSticks::Listed(batch) if parts[place] > 0.0 => Some(BatchPass {
                batch,
                part: parts[place],
                bound: material.bound,
                length_ratio: rest.length_ratio,
            }),
            _ => None,
        }
    })
}

/// The columns that damping reads and writes, of a body from `first_cell` on.
fn damped_columns<'a>(
    moving: &'a mut MovingColumns,
    rest: &BodyColumns<'a>,
    first_cell: usize,
) -> DampedColumns<'a> {
    let MovingColumns { position, displacement, .. } = moving;
    DampedColumns { position, displacement, inverse_mass: &rest.inverse_mass[first_cell..] }
}

/// The batches from `first` up to `end`, the last first if `backwards`.
fn in_order(first: usize, end: usize, backwards: bool) -> impl Iterator<Item = usize> + Clone {
    (first..end).map(move |i| if backwards { end - 1 - (i - first) } else { i })
}
