//! The dispatches of large bodies in one step, in order.

use crate::kernels::spread;
use crate::layout::{BodyData, DispatchData};
use crate::model::{Model, Way};
use crate::source::LARGE_WORKGROUP;

/// The kernel of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Begin,
    Advance,
    /// Only of free bodies.
    Drift,
    /// Left out if there is no obstacle.
    Contacts,
    Sticks,
    Tethers,
    /// All sticks and tethers of a grid. Its result goes to the other buffer of positions.
    Grid,
}

/// One dispatch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dispatch {
    pub stage: Stage,
    pub groups: [u32; 2],
    /// The buffer of positions, of two, that it reads.
    pub side: usize,
    pub data: DispatchData,
}

/// Appends the dispatches of one body, and returns the buffer in which its positions end.
pub(crate) fn push(
    list: &mut Vec<Dispatch>,
    number: u32,
    body: &BodyData,
    model: &Model,
    inner: [u32; 2],
) -> usize {
    let mut side = 0;
    let by_particle = groups(body.particle_count);
    let pass = DispatchData { body: number, ..DispatchData::default() };
    let mut add = |stage, groups, side, data| list.push(Dispatch { stage, groups, side, data });
    add(Stage::Begin, by_particle, side, pass);
    for substep in 0..body.substeps {
        let pass = DispatchData { substep, ends: u32::from(substep > 0), begins: 1, ..pass };
        add(Stage::Advance, by_particle, side, pass);
        for iteration in 0..body.iterations {
            let pass = DispatchData { iteration, ..pass };
            if iteration > 0 {
                add(Stage::Contacts, by_particle, side, pass);
            }
            if model.way == Way::Tiled {
                let tiles = [body.columns.div_ceil(inner[0]), body.rows.div_ceil(inner[1])];
                add(Stage::Grid, tiles, side, pass);
                side = 1 - side;
                continue;
            }
            for i in 0..body.batch_count {
                // Odd iterations run in reverse, so that an even number makes symmetric pairs.
                let batch = if iteration % 2 == 1 { body.batch_count - 1 - i } else { i };
                let sticks = groups(model.batches[batch as usize].data.count);
                add(Stage::Sticks, sticks, side, DispatchData { batch: body.first_batch + batch, ..pass });
            }
            if body.tethers_per_particle > 0 {
                add(Stage::Tethers, by_particle, side, pass);
            }
        }
        if body.inverse_mass > 0.0 {
            add(Stage::Drift, by_particle, side, pass);
        }
    }
    let last = DispatchData { substep: body.substeps, ends: 1, begins: 0, ..pass };
    add(Stage::Advance, by_particle, side, last);
    side
}

/// Workgroups for so many threads.
fn groups(threads: u32) -> [u32; 2] {
    spread(threads.div_ceil(LARGE_WORKGROUP))
}
