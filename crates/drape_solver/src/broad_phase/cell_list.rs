//! Pairs of points near each other: a uniform grid, filled by counting sort.
//!
//! Space is cut into cubes as wide as the reach of the search, so that all points near a point lie in its cube or in
//! the 26 around it. Two passes count the points of each cube and sort them by cube; nothing is hashed, and nothing is
//! allocated once warm.
//!
//! ```text
//!   +---+---+---+     the cubes of a wide axis are numbered round and round (0 1 2 .. 0 1 2 ..), so that there are
//!   | 0 | 1 | 2 |     never many more of them than points, however far one of these has flown. Two that share a number
//!   +---+---+---+     share their points as well, and distance tells these apart.
//! ```
//!
//! Green 2008, "CUDA Particles", sorts points in this way.
//!
//! Design: `docs/design/broad_phase.md`.

use glam::Vec3;

/// The points, in order of their cubes.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellList {
    axes: [Axis; 3],
    /// For each cube the index in `order` of its first point; one more at the end.
    first: Vec<u32>,
    /// The points by number. Those of a cube keep the order in which they were given.
    order: Vec<u32>,
    /// For each point, by number, its cube.
    cube: Vec<[u32; 3]>,
}

/// The cubes along one axis.
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    count: u32,
    /// True if the cubes are numbered round and round.
    is_wrapped: bool,
}

impl Axis {
    /// The cube one step on (1), back (-1), or the same (0).
    fn step(self, from: u32, step: i32) -> Option<u32> {
        match step {
            0 => Some(from),
            1 if from + 1 < self.count => Some(from + 1),
            1 => self.is_wrapped.then_some(0),
            _ if from > 0 => Some(from - 1),
            _ => self.is_wrapped.then_some(self.count - 1),
        }
    }
}

/// Half of the 26 cubes around: each pair of neighbours is visited from one side only.
const HALF_OF_NEIGHBOURS: [[i32; 3]; 13] = [
    [1, 0, 0],
    [-1, 1, 0],
    [0, 1, 0],
    [1, 1, 0],
    [-1, -1, 1],
    [0, -1, 1],
    [1, -1, 1],
    [-1, 0, 1],
    [0, 0, 1],
    [1, 0, 1],
    [-1, 1, 1],
    [0, 1, 1],
    [1, 1, 1],
];

/// Longer axes are wrapped in any case.
const MOST_OF_AXIS: i64 = 1 << 20;

/// A wrapped axis has at least this many cubes, so that the cubes before and behind a cube differ.
const LEAST_WRAPPED: u32 = 4;

impl CellList {
    /// Sorts `points` into cubes of this `edge` (metres, above 0).
    pub fn build(&mut self, points: impl ExactSizeIterator<Item = Vec3> + Clone, edge: f32) {
        let count = points.len();
        let (low, high) = points
            .clone()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        // Whole numbers, as one point far away must not round the others. The casts saturate: a point that is not finite
        // has a cube as well.
        let numbers = |p: Vec3| (p / edge).floor().to_array().map(|place| place as i64);
        let (lowest, highest) = (numbers(low), numbers(high));
        self.set_axes(core::array::from_fn(|axis| highest[axis].saturating_sub(lowest[axis])), count);
        let [across, down, deep] = self.axes.map(|axis| axis.count);
        self.first.clear();
        self.first.resize((across * down * deep) as usize + 1, 0);
        self.cube.clear();
        self.cube.extend(points.map(|p| {
            let cubes = numbers(p);
            core::array::from_fn(|axis| {
                let along = cubes[axis].saturating_sub(lowest[axis]).max(0);
                (along % i64::from(self.axes[axis].count)) as u32
            })
        }));
        for &cube in &self.cube {
            self.first[number(&self.axes, cube)] += 1;
        }
        for cube in 1..self.first.len() {
            self.first[cube] += self.first[cube - 1];
        }
        // These are the ends of the cubes so far. Each point goes in front of its cube's end, the last point first,
        // which leaves the beginnings.
        self.order.clear();
        self.order.resize(count, 0);
        for (point, &cube) in self.cube.iter().enumerate().rev() {
            let place = &mut self.first[number(&self.axes, cube)];
            *place -= 1;
            self.order[*place as usize] = point as u32;
        }
    }

    /// Sets the number of cubes along each axis, some four for each point at most.
    fn set_axes(&mut self, steps: [i64; 3], points: usize) {
        self.axes = steps.map(|steps| {
            let count = steps.clamp(0, MOST_OF_AXIS) + 1;
            Axis { count: count as u32, is_wrapped: steps > MOST_OF_AXIS }
        });
        let most = 4 * points as u64 + 64;
        loop {
            let cubes: u64 = self.axes.iter().map(|axis| u64::from(axis.count)).product();
            let [x, y, z] = self.axes.map(|axis| axis.count);
            let longest = if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) };
            let axis = &mut self.axes[longest];
            if cubes <= most || axis.count <= LEAST_WRAPPED {
                return;
            }
            *axis = Axis { count: (axis.count / 2).max(LEAST_WRAPPED), is_wrapped: true };
        }
    }

    /// The points in order of their cubes.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `visit` once for any two points that lie in one cube or in two cubes that touch, with their indices in
    /// [`order`](Self::order), in either order.
    pub fn for_each_pair(&self, mut visit: impl FnMut(usize, usize)) {
        for (place, &point) in self.order.iter().enumerate() {
            let cube = self.cube[point as usize];
            let own_end = self.first[number(&self.axes, cube) + 1] as usize;
            (place + 1..own_end).for_each(|other| visit(place, other));
            for steps in HALF_OF_NEIGHBOURS {
                let [x, y, z] = core::array::from_fn(|axis| self.axes[axis].step(cube[axis], steps[axis]));
                if let (Some(x), Some(y), Some(z)) = (x, y, z) {
                    let neighbour = number(&self.axes, [x, y, z]);
                    let points = self.first[neighbour] as usize..self.first[neighbour + 1] as usize;
                    points.for_each(|other| visit(place, other));
                }
            }
        }
    }
}

/// The number of a cube: those along x follow each other.
fn number(axes: &[Axis; 3], [x, y, z]: [u32; 3]) -> usize {
    ((z * axes[1].count + y) * axes[0].count + x) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;

    /// A pseudo-random number from 0 to 1 for each `n`.
    fn scattered(n: u32) -> f32 {
        (n.wrapping_mul(0x9e37_79b9) >> 8) as f32 / (1 << 24) as f32
    }

    fn cloud(count: u32, size: Vec3) -> Vec<Vec3> {
        let point = |i| Vec3::new(scattered(3 * i), scattered(7 * i + 1), scattered(13 * i + 2)) * size;
        (0..count).map(point).collect()
    }

    /// Pairs nearer than `reach`, lower number first, in order.
    fn found(points: &[Vec3], reach: f32) -> Vec<(u32, u32)> {
        let mut list = CellList::default();
        list.build(points.iter().copied(), reach);
        let mut pairs = Vec::new();
        list.for_each_pair(|a, b| {
            let (a, b) = (list.order()[a], list.order()[b]);
            if points[a as usize].distance(points[b as usize]) < reach {
                pairs.push((a.min(b), a.max(b)));
            }
        });
        pairs.sort_unstable();
        pairs
    }

    fn by_trying_all(points: &[Vec3], reach: f32) -> Vec<(u32, u32)> {
        let count = points.len() as u32;
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        pairs.filter(|&(a, b)| points[a as usize].distance(points[b as usize]) < reach).collect()
    }

    #[test]
    fn it_finds_each_near_pair_once_in_clouds_of_any_shape() {
        let shapes = [Vec3::ONE, Vec3::new(1.0, 0.0, 1.0), Vec3::X, Vec3::ZERO, Vec3::new(0.11, 3.0, 0.25)];
        for size in shapes {
            let points = cloud(unless_miri(400, 20), size);
            for reach in [0.03, 0.1, 0.3, 2.0] {
                assert_eq!(found(&points, reach), by_trying_all(&points, reach), "{size}, {reach}");
            }
        }
    }

    #[test]
    fn a_point_far_away_costs_no_cubes_and_hides_no_pair() {
        let mut points = cloud(unless_miri(300, 20), Vec3::ONE);
        for far in [Vec3::splat(5e3), Vec3::new(1e6, -1e6, 3.0), Vec3::Y * 1e20] {
            points.push(far);
            let mut list = CellList::default();
            list.build(points.iter().copied(), 0.05);
            assert!(list.first.len() < 8 * points.len() + 128, "{} cubes", list.first.len());
            if far.length() < 1e10 {
                assert_eq!(found(&points, 0.05), by_trying_all(&points, 0.05));
            }
        }
    }

    #[test]
    fn none_one_and_impossible_points_do_no_harm() {
        assert!(found(&[], 0.1).is_empty());
        assert!(found(&[Vec3::ONE], 0.1).is_empty());
        assert!(found(&[Vec3::NAN, Vec3::INFINITY, Vec3::NEG_INFINITY], 0.1).is_empty());
    }
}
