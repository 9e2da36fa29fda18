//! Detects passages of a point through a moving surface, in double precision and independently of the solver.
//!
//! Between two states the point and all corners move linearly. A triangle with the corners `p`, `q` and `r` relative to
//! the point can contain it only when the volume `p . (q x r)` is zero: a cubic in time. Each change of its sign is
//! found between the extremes of the cubic, so that none is missed, however close two of them are. It counts if the
//! triangle then lies around the point.
//!
//! ```text
//!   volume  +   \      __          to the front, + 1, where it falls to below zero,
//!           0 ---\----/--\---      to the back,  - 1, where it rises
//!           -     \__/    \
//! ```
//!
//! The sum of signs is the side that the point is on, as long as it does not go round the surface's edge: a closed loop
//! passes a surface as often forwards as backwards, unless it links with the edge. Self-intersections of the surface
//! change nothing.

use drape_solver::glam::DVec3;

/// Number of bisections of a time interval, after which double precision has no times in between.
const HALVINGS: usize = 60;

/// A surface relative to a point, with its corners now and before.
pub struct Oracle {
    faces: Vec<[u32; 3]>,
    /// Corners relative to the point.
    corners: Vec<DVec3>,
    /// Corners before the last advance, relative to the point.
    before: Vec<DVec3>,
    /// One bit for each side of the point on which a corner stayed during the last advance.
    sides: Vec<u8>,
}

/// Passages of the point through the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passages {
    /// Those to the front (the side from which the corners of a face run counter-clockwise) less those to the back.
    pub net: i32,
    /// All of them.
    pub count: u32,
}

impl Oracle {
    /// A surface of `faces` with these corners, relative to the point.
    pub fn new(faces: &[[u32; 3]], corners: impl IntoIterator<Item = DVec3>) -> Self {
        let corners: Vec<DVec3> = corners.into_iter().collect();
        let (before, sides) = (corners.clone(), vec![0; corners.len()]);
        Self { faces: faces.to_vec(), corners, before, sides }
    }

    /// Moves the corners to these positions relative to the point, and counts the passages on the way.
    pub fn advance(&mut self, corners: impl IntoIterator<Item = DVec3>) -> Passages {
        std::mem::swap(&mut self.corners, &mut self.before);
        self.corners.clear();
        self.corners.extend(corners);
        for ((sides, &now), &before) in self.sides.iter_mut().zip(&self.corners).zip(&self.before) {
            let above = now.cmpgt(DVec3::ZERO).bitmask() & before.cmpgt(DVec3::ZERO).bitmask();
            let below = now.cmplt(DVec3::ZERO).bitmask() & before.cmplt(DVec3::ZERO).bitmask();
            *sides = (above | below << 3) as u8;
        }
        let mut passages = Passages::default();
        for face in &self.faces {
            let [p, q, r] = face.map(|i| i as usize);
            // If all corners stay on one side, the point is outside the convex hull of the triangle's motion.
            if self.sides[p] & self.sides[q] & self.sides[r] == 0 {
                let triangle = Swept {
                    start: [self.before[p], self.before[q], self.before[r]],
                    end: [self.corners[p], self.corners[q], self.corners[r]],
                };
                triangle.count(&mut passages);
            }
        }
        passages
    }
}

/// A triangle that moves from `start` to `end`, relative to the point.
struct Swept {
    start: [DVec3; 3],
    end: [DVec3; 3],
}

impl Swept {
    fn count(&self, passages: &mut Passages) {
        let mut times = vec![0.0, 1.0];
        times.extend(self.extremes());
        times.sort_unstable_by(f64::total_cmp);
        for pair in times.windows(2) {
            let [mut low, mut high] = [pair[0], pair[1]];
            // Zero counts as positive, at the end of one motion as at the start of the next.
            let is_above = |time: f64| volume(self.at(time)) >= 0.0;
            let from_above = is_above(low);
            if from_above == is_above(high) {
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(low, high);
                if is_above(middle) == from_above {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if is_around(self.at(high)) {
                passages.count += 1;
                passages.net += if from_above { 1 } else { -1 };
            }
        }
    }

    /// Corners at a `time` from 0 to 1; exactly `start` and `end` at 0 and 1.
    fn at(&self, time: f64) -> [DVec3; 3] {
        [0, 1, 2].map(|k| self.start[k] * (1.0 - time) + self.end[k] * time)
    }

    /// Times between 0 and 1 at which the volume has an extreme.
    fn extremes(&self) -> impl Iterator<Item = f64> {
        let [p, q, r] = self.start;
        let [dp, dq, dr] = [0, 1, 2].map(|k| self.end[k] - self.start[k]);
        let cubic = dp.dot(dq.cross(dr));
        let square = p.dot(dq.cross(dr)) + dp.dot(q.cross(dr)) + dp.dot(dq.cross(r));
        let linear = dp.dot(q.cross(r)) + p.dot(dq.cross(r)) + p.dot(q.cross(dr));
        // Roots of 3 cubic t^2 + 2 square t + linear, without cancellation.
        let root = (square * square - 3.0 * cubic * linear).max(0.0).sqrt();
        let large = -(square + root.copysign(square));
        let times = [large / (3.0 * cubic), linear / large];
        times.into_iter().filter(|time| *time > 0.0 && *time < 1.0)
    }
}

/// Six times the volume between the point and a triangle: positive if the point is behind it.
fn volume([p, q, r]: [DVec3; 3]) -> f64 {
    p.dot(q.cross(r))
}

/// True if a triangle whose plane contains the point has it inside.
fn is_around([p, q, r]: [DVec3; 3]) -> bool {
    let normal = (q - p).cross(r - p);
    [p.cross(q), q.cross(r), r.cross(p)].iter().all(|part| part.dot(normal) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Counter-clockwise seen from +Z.
    const TRIANGLE: [DVec3; 3] =
        [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(2.0, -1.0, 0.0), DVec3::new(-1.0, 2.0, 0.0)];

    /// The passages of a point on its `way` past a triangle that moves through `states`.
    fn passages(way: &[DVec3], states: &[[DVec3; 3]]) -> Passages {
        let seen =
            |i: usize| states[i.min(states.len() - 1)].map(|corner| corner - way[i.min(way.len() - 1)]);
        let mut oracle = Oracle::new(&[[0, 1, 2]], seen(0));
        let mut sum = Passages::default();
        for i in 1..way.len().max(states.len()) {
            let Passages { net, count } = oracle.advance(seen(i));
            sum = Passages { net: sum.net + net, count: sum.count + count };
        }
        sum
    }

    fn moved(by: DVec3) -> [DVec3; 3] {
        TRIANGLE.map(|corner| corner + by)
    }

    #[test]
    fn a_point_passes_a_still_triangle_to_the_front_and_back() {
        let [behind, before] = [DVec3::new(0.1, 0.2, -3.0), DVec3::new(-0.2, 0.1, 2.0)];
        assert_eq!(passages(&[behind, before], &[TRIANGLE]), Passages { net: 1, count: 1 });
        assert_eq!(passages(&[before, behind], &[TRIANGLE]), Passages { net: -1, count: 1 });
        assert_eq!(passages(&[behind, before, behind], &[TRIANGLE]), Passages { net: 0, count: 2 });
    }

    #[test]
    fn a_triangle_passes_a_still_point() {
        let states = [moved(DVec3::Z), moved(-DVec3::Z)];
        assert_eq!(passages(&[DVec3::ZERO], &states), Passages { net: 1, count: 1 });
        let both = [DVec3::ZERO, DVec3::Z * 5.0];
        assert_eq!(passages(&both, &[TRIANGLE, moved(DVec3::Z * 4.0)]).count, 1, "the point is faster");
        assert_eq!(passages(&both, &[moved(DVec3::Z), moved(DVec3::Z * 7.0)]).count, 0, "the triangle is");
    }

    #[test]
    fn a_point_that_stops_in_the_plane_passes_once_or_not_at_all() {
        let [behind, front] = [DVec3::NEG_Z, DVec3::Z];
        assert_eq!(passages(&[behind, DVec3::ZERO, front], &[TRIANGLE]), Passages { net: 1, count: 1 });
        assert_eq!(passages(&[behind, DVec3::ZERO, behind], &[TRIANGLE]).net, 0);
        assert_eq!(passages(&[front, DVec3::ZERO, front], &[TRIANGLE]).net, 0);
    }

    #[test]
    fn beside_the_triangle_is_not_through_it() {
        for beside in [DVec3::new(0.6, 0.6, 0.0), DVec3::new(-1.001, 0.0, 0.0), DVec3::new(0.0, -1.001, 0.0)]
        {
            assert_eq!(passages(&[beside - DVec3::Z, beside + DVec3::Z], &[TRIANGLE]).count, 0, "{beside}");
            let inside = beside * 0.8;
            assert_eq!(passages(&[inside - DVec3::Z, inside + DVec3::Z], &[TRIANGLE]).count, 1, "{inside}");
        }
    }

    /// The plane goes to and fro through the point within one advance: only the cubic tells.
    #[test]
    fn a_triangle_that_turns_over_passes_and_comes_back() {
        // One corner goes through a plane that the others take back.
        let start = [DVec3::new(-1.0, -1.0, -1.0), DVec3::new(2.0, -1.0, 0.4), DVec3::new(-1.0, 2.0, 0.4)];
        let end = [DVec3::new(-1.0, -1.0, 3.0), DVec3::new(0.2, -1.0, -1.0), DVec3::new(-1.0, 0.2, -1.0)];
        let found = passages(&[DVec3::ZERO], &[start, end]);
        // Against a thousand small advances, which need no more than the sign at either end.
        let state = |i: usize| {
            let time = i as f64 / 1e3;
            [0, 1, 2].map(|k| start[k] * (1.0 - time) + end[k] * time)
        };
        let fine: Vec<_> = (0..=1000).map(state).collect();
        assert_eq!(found, passages(&[DVec3::ZERO], &fine));
    }

    /// Many random passes through a closed surface: a point inside stays inside unless it passes.
    #[test]
    fn passages_of_a_closed_surface_tell_inside_from_outside() {
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let mut random = Random::new(5);
        let mut vector = |size: f64| DVec3::from_array([(); 3].map(|()| random.either_side() * size));
        let mut passed = 0;
        for _ in 0..2000 {
            let corners = |vector: &mut dyn FnMut(f64) -> DVec3| {
                [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|corner| corner * 4.0 - 1.0 + vector(0.5))
            };
            let (start, end) = (corners(&mut vector), corners(&mut vector));
            let (from, to) = (vector(2.0), vector(2.0));
            let is_inside = |corners: &[DVec3; 4], point: DVec3| {
                faces.iter().all(|face| volume(face.map(|i| corners[i as usize] - point)) > 0.0)
            };
            let mut oracle = Oracle::new(&faces, start.map(|corner| corner - from));
            let found = oracle.advance(end.map(|corner| corner - to));
            let outwards = i32::from(is_inside(&start, from)) - i32::from(is_inside(&end, to));
            assert_eq!(found.net, outwards, "{start:?} {end:?} {from} {to}");
            passed += found.count;
        }
        assert!(passed > 500, "{passed}");
    }
}
