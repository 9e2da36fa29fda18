//! Numbers, listed sticks and a reference solve for the tests of this floor.

use core::iter::Sum;
use core::ops::{Div, Mul, Range, Sub};

use crate::simd::columns::LANES;
use crate::splitmix::SplitMix64;
use crate::state::stick_list::{ListedBatch, ListedSticks};

/// Numbers from -1 to 1 that look random.
pub(crate) fn dice(seed: u64) -> impl FnMut() -> f32 {
    let mut random = SplitMix64(seed);
    move || random.signed()
}

/// Batches of sticks between `count` particles, with each of `steps` as the distance between the ends; no two sticks of a batch
/// share a particle.
pub(crate) fn listed_batches(sticks: &mut ListedSticks, count: u32, steps: &[u32]) -> Vec<ListedBatch> {
    let cells = (count as usize).div_ceil(LANES);
    let batch = |&step: &u32| {
        let first = sticks.begin_batch();
        let starts = (0..count - step).filter(|i| i / step % 2 == 0 && i % 9 != 4);
        for i in starts {
            sticks.push([i, i + step], 0.3 + (i % 5) as f32 * 0.1);
        }
        let mut batch = ListedBatch::new(first, true);
        batch.arrange(sticks, sticks.next - first, cells, |slot| slot);
        batch
    };
    steps.iter().map(batch).collect()
}

/// The places of the sticks of a batch in the list.
pub(crate) fn places_of(batch: &ListedBatch) -> Range<usize> {
    batch.first..batch.first_of_block.last().map_or(batch.first, |&last| last as usize)
}

/// Solves `rows x = right` by Gaussian elimination of the whole matrix: slow, and without regard to its shape.
pub(crate) fn solved<V>(mut rows: Vec<Vec<f64>>, mut right: Vec<V>) -> Vec<V>
where
    V: Copy + Sub<Output = V> + Mul<f64, Output = V> + Div<f64, Output = V> + Sum,
{
    for i in 0..rows.len() {
        let (above, below) = rows.split_at_mut(i + 1);
        for (k, row) in (i + 1..).zip(below) {
            let factor = row[i] / above[i][i];
            row.iter_mut().zip(&above[i]).for_each(|(entry, pivot)| *entry -= factor * pivot);
            right[k] = right[k] - right[i] * factor;
        }
    }
    for (i, row) in rows.iter().enumerate().rev() {
        let known: V = (i + 1..row.len()).map(|k| right[k] * row[k]).sum();
        right[i] = (right[i] - known) / row[i];
    }
    right
}
