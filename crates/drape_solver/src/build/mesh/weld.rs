//! Finds vertices in the same place, in linear time.
//!
//! Design: docs/design/cloth_from_meshes.md.

use std::collections::HashMap;

use glam::Vec3;

/// For each of the `used` vertices, in their order, the first earlier one within `distance` metres, or itself.
///
/// The vertices found lie in a grid of cubes as wide as the distance, so that neighbours are in the same cube or beside it.
pub(crate) fn weld(positions: &[Vec3], used: &[u32], distance: f32) -> Vec<u32> {
    let mut firsts: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    used.iter()
        .map(|&vertex| {
            let position = positions[vertex as usize];
            let cube = cube(position, distance);
            let near = |other: &u32| positions[*other as usize].distance(position) <= distance;
            let first =
                around(cube).filter_map(|cube| firsts.get(&cube)).flatten().copied().filter(near).min();
            first.unwrap_or_else(|| {
                firsts.entry(cube).or_default().push(vertex);
                vertex
            })
        })
        .collect()
}

/// The cube of a position. If the width is 0, each position has a cube of its own.
fn cube(position: Vec3, width: f32) -> [i64; 3] {
    // Adding zero turns -0 into 0, which is the same place.
    position
        .to_array()
        .map(|x| if width > 0.0 { (x / width).floor() as i64 } else { i64::from((x + 0.0).to_bits()) })
}

/// A cube and its 26 neighbours.
fn around([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let beside = |i: i64| i.saturating_sub(1)..=i.saturating_add(1);
    beside(x).flat_map(move |x| beside(y).flat_map(move |y| beside(z).map(move |z| [x, y, z])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_is_welded_to_the_first_and_what_is_not_stays() {
        let x = |x: f32| Vec3::X * x;
        let positions = [x(0.0), x(1.0), x(0.9), x(-0.05), x(-0.0), x(5.0)];
        let used = [0, 1, 2, 3, 4, 5];
        assert_eq!(weld(&positions, &used, 0.1 + 1e-6), [0, 1, 1, 0, 0, 5]);
        assert_eq!(weld(&positions, &used, 0.0), [0, 1, 2, 3, 0, 5]);
        assert_eq!(weld(&positions, &used, 1e-30), [0, 1, 2, 3, 0, 5]);
        assert_eq!(weld(&positions, &[4, 0, 3], 0.06), [4, 4, 4]);
    }
}
