//! Counts the edges that pass through faces, in double precision and by code of its own: what contacts miss is seen here.
//!
//! An edge crosses a triangle if its ends lie on either side of the triangle's plane, and the triangle's sides all run round
//! the edge in the same sense: five volumes of tetrahedra, by their signs alone. What only touches has a volume of zero, and
//! does not count; an edge and a triangle with a common corner have two such volumes. Two triangles that pass through each
//! other make two crossings.
//!
//! ```text
//!          p
//!     a----|---b     volume(a, b, c, p) and volume(a, b, c, q) have opposite signs;
//!      \   |  /      volume(p, q, a, b), volume(p, q, b, c) and volume(p, q, c, a) have the same
//!       \  q /
//!        \  /
//!         c
//! ```
//!
//! Each edge counts once, however many triangles share it. Segments of ropes count as edges: a rope through a cloth is
//! found, but not a rope through a rope, as one state does not tell on which side two segments have passed.

use glam::{DVec3, UVec3};

use crate::state::topology::Topology;

/// The greatest number of cubes of the grid: clearing more costs more than they save.
const MOST_CUBES: f64 = 262_144.0;

/// Width of a cube in mean edge lengths.
const WIDTH: f64 = 1.5;

/// Least width of a cube in metres: all corners may lie in one place.
const LEAST_WIDTH: f64 = 1e-6;

/// Volumes below this part of the product of three edges are rounding.
const ROUNDING: f64 = 1e-14;

/// Edges and triangles between numbered corners, with the scratch of a search.
#[derive(Clone, Debug, Default)]
pub struct CrossingCounter {
    edges: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    grid: Grid,
    /// For each triangle the last edge that was tested against it, as a triangle stands in several cubes.
    tested_by: Vec<u32>,
}

impl CrossingCounter {
    /// The edges and faces of bodies with these topologies; their particles are numbered on from body to body.
    pub fn of<'a>(topologies: impl IntoIterator<Item = &'a Topology>) -> Self {
        let (mut triangles, mut segments) = (Vec::new(), Vec::new());
        let mut first = 0;
        for topology in topologies {
            triangles.extend(topology.contact_faces().map(|face| face.map(|i| first + i)));
            segments.extend(topology.segments().iter().map(|ends| ends.map(|i| first + i)));
            first += topology.particle_count() as u32;
        }
        Self::new(triangles, &segments)
    }

    /// The edges of `triangles`, and `segments` that belong to no triangle.
    pub fn new(triangles: Vec<[u32; 3]>, segments: &[[u32; 2]]) -> Self {
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let edges = triangles.iter().flat_map(sides).chain(segments.iter().copied());
        let mut edges: Vec<[u32; 2]> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        Self { edges, triangles, ..Self::default() }
    }

    /// The number of crossings with the corners at these places, in metres.
    ///
    /// # Panics
    /// If there are fewer corners than the triangles name.
    pub fn count(&mut self, corners: &[DVec3]) -> usize {
        let Self { edges, triangles, grid, tested_by } = self;
        let at = |i: u32| corners[i as usize];
        let lengths = edges.iter().map(|&[a, b]| at(a).distance(at(b))).sum::<f64>();
        grid.build(triangles.iter().map(|of| Bounds::of(of.map(at))), WIDTH * lengths / edges.len() as f64);
        tested_by.clear();
        tested_by.resize(triangles.len(), u32::MAX);
        let mut count = 0;
        for (number, &edge) in (0..).zip(&*edges) {
            let ends = edge.map(at);
            grid.for_each_near(Bounds::of(ends), |triangle| {
                if core::mem::replace(&mut tested_by[triangle], number) != number
                    && crosses(ends, triangles[triangle].map(at))
                {
                    count += 1;
                }
            });
        }
        count
    }
}

/// Six times the volume of a tetrahedron, positive if `s` lies before the triangle whose corners run counter-clockwise;
/// zero if it is flat to within rounding.
fn volume(p: DVec3, q: DVec3, r: DVec3, s: DVec3) -> f64 {
    let [q, r, s] = [q, r, s].map(|corner| corner - p);
    let volume = q.cross(r).dot(s);
    let squares = q.length_squared() * r.length_squared() * s.length_squared();
    if volume * volume <= ROUNDING * ROUNDING * squares { 0.0 } else { volume }
}

/// True if the edge passes through the triangle.
fn crosses([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let ends = [volume(a, b, c, p), volume(a, b, c, q)];
    let is_across = ends[0] < 0.0 && ends[1] > 0.0 || ends[0] > 0.0 && ends[1] < 0.0;
    if !is_across {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
}

/// A box along the axes, in metres.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const NONE: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn of<const N: usize>(points: [DVec3; N]) -> Self {
        points.into_iter().fold(Self::NONE, |all, point| all.joined(Self { low: point, high: point }))
    }

    fn joined(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn overlaps(self, other: Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// A block of cubes along the axes.
#[derive(Clone, Copy, Debug, Default)]
struct Cubes {
    low: DVec3,
    per_metre: f64,
    count: UVec3,
}

impl Cubes {
    /// Cubes of this width in metres that cover `all`, or wider ones if there were too many.
    fn covering(all: Bounds, mut width: f64) -> Self {
        let size = (all.high - all.low).max(DVec3::ZERO);
        let count = |width: f64| (size / width).floor() + 1.0;
        while count(width).element_product() > MOST_CUBES {
            width *= 1.25;
        }
        Self { low: all.low, per_metre: 1.0 / width, count: count(width).as_uvec3() }
    }

    /// Visits the cubes that `of` overlaps; what lies outside the block belongs to the nearest ones.
    fn for_each(self, of: Bounds, mut visit: impl FnMut(usize)) {
        let cube = |point: DVec3| {
            let cube = ((point - self.low) * self.per_metre).max(DVec3::ZERO).as_uvec3();
            cube.min(self.count - 1)
        };
        let (low, high) = (cube(of.low), cube(of.high));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    visit(((z * self.count.y + y) * self.count.x + x) as usize);
                }
            }
        }
    }
}

/// A uniform grid: for each cube the boxes that overlap it, sorted by counting.
#[derive(Clone, Debug, Default)]
struct Grid {
    boxes: Vec<Bounds>,
    cubes: Cubes,
    /// The start of each cube's entries; the last entry is their number.
    starts: Vec<u32>,
    /// Numbers of boxes, cube by cube.
    entries: Vec<u32>,
}

impl Grid {
    /// Sorts these boxes into cubes of about this width in metres.
    fn build(&mut self, boxes: impl Iterator<Item = Bounds>, width: f64) {
        let Self { boxes: kept, cubes, starts, entries } = self;
        kept.clear();
        kept.extend(boxes);
        starts.clear();
        entries.clear();
        if kept.is_empty() {
            return;
        }
        let all = kept.iter().copied().fold(Bounds::NONE, Bounds::joined);
        *cubes = Cubes::covering(all, width.max(LEAST_WIDTH));
        starts.resize(cubes.count.element_product() as usize + 1, 0);
        for &of in &*kept {
            cubes.for_each(of, |cube| starts[cube] += 1);
        }
        let mut sum = 0;
        for end in &mut *starts {
            sum += *end;
            *end = sum;
        }
        entries.resize(sum as usize, 0);
        // Each entry of `starts` is the end of its cube. Filling from the back makes it the start.
        for (number, &of) in kept.iter().enumerate().rev() {
            cubes.for_each(of, |cube| {
                starts[cube] -= 1;
                entries[starts[cube] as usize] = number as u32;
            });
        }
    }

    /// Visits every box that overlaps `of`, some of them more than once.
    fn for_each_near(&self, of: Bounds, mut visit: impl FnMut(usize)) {
        if self.boxes.is_empty() {
            return;
        }
        self.cubes.for_each(of, |cube| {
            for &number in &self.entries[self.starts[cube] as usize..self.starts[cube + 1] as usize] {
                if self.boxes[number as usize].overlaps(of) {
                    visit(number as usize);
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    /// Numbers from -1 to 1.
    struct Random(u32);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(self.0) / f64::from(1 << 31) - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next())
        }
    }

    /// Crossings found by trying every edge on every triangle.
    fn by_brute_force(triangles: &[[u32; 3]], segments: &[[u32; 2]], corners: &[DVec3]) -> usize {
        let at = |i: u32| corners[i as usize];
        let mut edges: Vec<[u32; 2]> = segments.to_vec();
        for &[a, b, c] in triangles {
            edges.extend([[a, b], [b, c], [c, a]]);
        }
        let mut seen = Vec::new();
        let mut count = 0;
        for [a, b] in edges {
            if seen.contains(&[a, b]) || seen.contains(&[b, a]) {
                continue;
            }
            seen.push([a, b]);
            let shares = |of: &&[u32; 3]| of.contains(&a) || of.contains(&b);
            let others = triangles.iter().filter(|of| !shares(of));
            count += others.filter(|of| crosses([at(a), at(b)], of.map(at))).count();
        }
        count
    }

    fn count(triangles: &[[u32; 3]], corners: &[DVec3]) -> usize {
        CrossingCounter::new(triangles.to_vec(), &[]).count(corners)
    }

    /// `n` x `n` corners of a square of 1 m at this height, and its triangles, numbered from `first`.
    fn layer(n: u32, first: u32, height: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let part = |i: u32| f64::from(i) / f64::from(n - 1);
        let corners = (0..n * n).map(|i| DVec3::new(part(i % n), height, part(i / n))).collect();
        let squares = (0..(n - 1) * (n - 1)).map(|i| first + i / (n - 1) * n + i % (n - 1));
        let faces = squares.flat_map(|i| [[i, i + n, i + 1], [i + 1, i + n, i + n + 1]]).collect();
        (corners, faces)
    }

    #[test]
    fn two_triangles_through_each_other_cross_twice() {
        let lying = [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 2.0)];
        let both = [[0, 1, 2], [3, 4, 5]];
        // Two sides of the upright one go through the lying one.
        let dipped = [DVec3::new(-0.2, 1.0, 0.1), DVec3::new(0.2, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0)];
        assert_eq!(count(&both, &[lying, dipped].concat()), 2);
        // One side of each goes through the other.
        let aside = dipped.map(|corner| corner * DVec3::new(6.0, 1.0, 1.0) + DVec3::X * 0.9);
        assert_eq!(count(&both, &[lying, aside].concat()), 2);
        let above = dipped.map(|corner| corner + DVec3::Y * 1.001);
        assert_eq!(count(&both, &[lying, above].concat()), 0);
    }

    #[test]
    fn a_shared_edge_through_a_triangle_counts_once() {
        let lying = [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 2.0)];
        let spine = [DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 0.0)];
        // Their far corners are so far above that only the spine is within the lying triangle.
        let far = [DVec3::new(9.0, 1.0, 0.0), DVec3::new(-9.0, 1.0, 0.1)];
        let corners = [&lying[..], &spine, &far].concat();
        let wings = [[0, 1, 2], [3, 4, 5], [4, 3, 6]];
        let spine_alone = CrossingCounter::new(vec![wings[0]], &[[3, 4]]).count(&corners);
        assert_eq!(spine_alone, 1);
        // The spine, and a side of the lying triangle through each wing.
        assert_eq!(count(&wings, &corners), 3);
    }

    #[test]
    fn corners_edges_and_faces_that_touch_do_not_cross() {
        let lying = [DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 0.0, 2.0)];
        let both = [[0, 1, 2], [3, 4, 5]];
        let upright = |foot: DVec3| [foot, foot + DVec3::new(0.2, 1.0, 0.0), foot + DVec3::Y];
        for foot in [lying[0], DVec3::ZERO, (lying[0] + lying[1]) * 0.5] {
            assert_eq!(count(&both, &[lying, upright(foot)].concat()), 0, "a corner at {foot}");
        }
        let beside = [lying[0], lying[1], DVec3::new(0.0, 1.0, -1.0)];
        assert_eq!(count(&both, &[lying, beside].concat()), 0, "edge on edge");
        assert_eq!(count(&both, &[lying, lying].concat()), 0, "face on face");
    }

    #[test]
    fn edges_do_not_cross_triangles_that_share_a_corner_with_them() {
        let mut random = Random(3);
        for _ in 0..1000 {
            let corners = [(); 4].map(|()| random.vector());
            assert_eq!(count(&[[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]], &corners), 0, "{corners:?}");
        }
    }

    #[test]
    fn parallel_layers_do_not_cross_and_a_tilted_one_does() {
        let (mut corners, mut faces) = layer(12, 0, 0.0);
        for i in 1..5 {
            let (more, of) = layer(12, 144 * i, 1e-6 * f64::from(i));
            corners.extend(more);
            faces.extend(of);
        }
        assert_eq!(count(&faces, &corners), 0);
        // Aslant, so that nothing is flat to the last bit.
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.3);
        let aslant: Vec<DVec3> = corners.iter().map(|&corner| turn * corner).collect();
        assert_eq!(count(&faces, &aslant), 0);
        assert_eq!(by_brute_force(&faces, &[], &aslant), 0);
        for corner in &mut corners[144..288] {
            *corner += DVec3::new(0.0, 1e-3 * (corner.x - 0.47), 0.013);
        }
        let tilted = count(&faces, &corners);
        assert!(tilted > 4 * 11, "{tilted}");
        assert_eq!(tilted, by_brute_force(&faces, &[], &corners));
    }

    #[test]
    fn the_grid_finds_what_brute_force_finds_in_random_soups() {
        let mut found = 0;
        for seed in 0..40 {
            let mut random = Random(seed);
            let mut vector = |size: f64| random.vector() * size;
            // Small triangles among large ones, some with common corners, and one far away in every other soup.
            let mut corners = Vec::new();
            for i in 0..60 {
                let (centre, size) = (vector(1.0), if i % 6 == 0 { 1.5 } else { 0.3 });
                corners.extend([(); 3].map(|()| centre + vector(size)));
            }
            if seed % 2 == 0 {
                corners[7] += DVec3::X * 1e4;
            }
            let triangles: Vec<[u32; 3]> = (0..60)
                .map(|i| [3 * i, 3 * i + 1, if i % 4 == 0 { (3 * i + 5) % 180 } else { 3 * i + 2 }])
                .collect();
            let segments: Vec<[u32; 2]> = (0..20).map(|i| [9 * i, (9 * i + 40) % 180]).collect();
            let brute = by_brute_force(&triangles, &segments, &corners);
            let mut counter = CrossingCounter::new(triangles, &segments);
            assert_eq!(counter.count(&corners), brute, "seed {seed}");
            assert_eq!(counter.count(&corners), brute, "again, seed {seed}");
            found += brute;
        }
        assert!(found > 1000, "{found}");
    }

    #[test]
    fn nothing_crosses_where_there_is_nothing() {
        assert_eq!(CrossingCounter::new(Vec::new(), &[]).count(&[]), 0);
        assert_eq!(CrossingCounter::new(Vec::new(), &[[0, 1]]).count(&[DVec3::ZERO, DVec3::X]), 0);
    }
}
