//! Bilinear resampling of a grid by a coarser or finer one over the same area.
//!
//! ```text
//!   o-----o-----o          o--------o      Corners lie on corners, edges on edges; what lies
//!   |     |     |    ->    |   .    |      within a square of the old grid is the mean of its
//!   o-----o-----o          o--------o      four corners, by how near they are (bilinear).
//! ```

use core::ops::{Add, Mul};

/// Resamples `values` of a grid of `from` (columns, rows) to a grid of `to`, row by row. Each side has at least two
/// lines.
pub(crate) fn resample<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(
    values: &[T],
    from: [u32; 2],
    to: [u32; 2],
) -> Vec<T> {
    let columns = from[0] as usize;
    let mut resampled = Vec::with_capacity(to[0] as usize * to[1] as usize);
    for row in 0..to[1] {
        let (above, down) = place(row, to[1], from[1]);
        for column in 0..to[0] {
            let (left, right) = place(column, to[0], from[0]);
            let along = |row: usize| {
                let first = row * columns + left;
                between(values[first], values[first + 1], right)
            };
            resampled.push(between(along(above), along(above + 1), down));
        }
    }
    resampled
}

/// Returns the line of the old grid before line `i` of the new one, and the fraction of the way to the next old line.
fn place(i: u32, to: u32, from: u32) -> (usize, f32) {
    // Integers, so that coinciding lines are met exactly.
    let (last, squares) = (u64::from(to) - 1, u64::from(from) - 1);
    let scaled = u64::from(i) * squares;
    let before = (scaled / last).min(squares - 1);
    (before as usize, (scaled - before * last) as f32 / last as f32)
}

fn between<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(a: T, b: T, part: f32) -> T {
    // Both ends are exact to the bit.
    if part == 0.0 {
        a
    } else if part == 1.0 {
        b
    } else {
        a * (1.0 - part) + b * part
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;

    use super::*;

    /// A value that is linear in column and row, as parts of the sides.
    fn plane([columns, rows]: [u32; 2]) -> Vec<Vec3> {
        let part = |i: u32, n: u32| i as f32 / (n - 1) as f32;
        let row = |row: u32| (0..columns).map(move |column| (part(column, columns), part(row, rows)));
        (0..rows).flat_map(row).map(|(u, v)| Vec3::new(u, v, 1.0 + 3.0 * u - 2.0 * v)).collect()
    }

    #[test]
    fn what_is_linear_is_kept_by_any_grid() {
        for (from, to) in [([9, 5], [5, 3]), ([9, 5], [4, 7]), ([2, 2], [33, 17]), ([33, 17], [2, 2])] {
            let resampled = resample(&plane(from), from, to);
            assert_eq!(resampled.len(), plane(to).len());
            for (a, b) in resampled.iter().zip(plane(to)) {
                assert!((*a - b).length() < 1e-6, "{from:?} to {to:?}: {a} and {b}");
            }
        }
    }

    #[test]
    fn there_and_back_the_shared_particles_are_the_same_to_the_bit() {
        let (coarse, fine) = ([5, 3], [9, 5]);
        let values: Vec<f32> = (0..15).map(|i| (i as f32 * 1.7).sin()).collect();
        assert_eq!(resample(&resample(&values, coarse, fine), fine, coarse), values);
    }

    #[test]
    fn a_grid_that_is_as_fine_is_the_same() {
        let values: Vec<f32> = (0..15).map(|i| (i as f32 * 1.7).sin()).collect();
        assert_eq!(resample(&values, [5, 3], [5, 3]), values);
    }
}
