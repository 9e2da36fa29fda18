//! Numbers and a reference solve for the tests of this floor.

use core::iter::Sum;
use core::ops::{Div, Mul, Sub};

/// Numbers from -1 to 1 that look random.
pub(crate) fn dice(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
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
