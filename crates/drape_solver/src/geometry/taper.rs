//! The balls of which a tapered capsule consists: their centres on the Y axis, their radii linear in between. A capsule and a sphere are
//! tapered capsules, too.
//!
//! ```text
//!                 p       The nearest ball has its centre at c, where the way from p to the axis stands upright on the side of
//!               / |       the cone. From the foot f it is |p f| tan a away, with sin a = (bottom - top) / length.
//!   bottom  __/___|____
//!   ( O----c------f---O ) top
//!           ----------
//! ```
//!
//! Design: `docs/design/obstacles.md`.

use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;
use parry3d::shape::{Ball, SharedShape};

use crate::simd::lanes::Lanes3;

/// The balls of a tapered capsule.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taper {
    /// Heights of the lowest and the highest centre.
    pub low: f32,
    pub high: f32,
    /// Radius of the lowest ball.
    radius: f32,
    /// Growth of the radius by the height.
    pub growth: f32,
    /// Tangent of the angle of the cone's side with the axis, above 0 if it narrows upwards.
    slope: f32,
}

impl Taper {
    pub fn new(half_length: f32, bottom: f32, top: f32) -> Self {
        let length = 2.0 * half_length;
        let narrowing = bottom - top;
        let side_squared = (length - narrowing) * (length + narrowing);
        if side_squared > 0.0 {
            let (growth, slope) = (-narrowing / length, narrowing / side_squared.sqrt());
            return Self { low: -half_length, high: half_length, radius: bottom, growth, slope };
        }
        // One ball holds the other.
        let (height, radius) = if narrowing > 0.0 { (-half_length, bottom) } else { (half_length, top) };
        Self { low: height, high: height, radius, growth: 0.0, slope: 0.0 }
    }

    pub fn least_radius(&self) -> f32 {
        self.radius.min(self.radius + self.growth * (self.high - self.low))
    }

    /// The vector to a point from the centre of the ball that is nearest to it, and that ball's radius.
    pub fn core(&self, point: Vec3) -> (Vec3, f32) {
        let from_axis = (point.x * point.x + point.z * point.z).sqrt();
        let height = (point.y - from_axis * self.slope).max(self.low).min(self.high);
        let radius = self.radius + (height - self.low) * self.growth;
        (Vec3::new(point.x, point.y - height, point.z), radius)
    }

    /// The same for each lane.
    #[inline(always)]
    pub fn core_lanes<S: Simd>(&self, simd: S, point: Lanes3<S>) -> (Lanes3<S>, f32x16<S>) {
        let splat = |value: f32| f32x16::splat(simd, value);
        let from_axis = (point.x * point.x + point.z * point.z).sqrt();
        let height = (point.y - from_axis * self.slope).max(splat(self.low)).min(splat(self.high));
        let radius = (height - self.low) * self.growth + self.radius;
        (Lanes3 { y: point.y - height, ..point }, radius)
    }
}

/// The hull of two balls on the Y axis, given by height and radius, after this scale. None if it has no extent.
pub(crate) fn scaled_hull(balls: [(f32, f32); 2], scale: Vec3, subdivisions: u32) -> Option<SharedShape> {
    let points = balls.into_iter().flat_map(|(height, radius)| {
        let (points, _) = Ball::new(radius).to_trimesh(subdivisions, subdivisions);
        points.into_iter().map(move |point| (point + Vec3::Y * height) * scale)
    });
    SharedShape::convex_hull(&points.collect::<Vec<Vec3>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::nearest::{FaceOrEdge, Nearest};
    use crate::geometry::nearest_triangle::weighted;
    use crate::geometry::shape::{Shape, Surface};
    use crate::simd::miri::unless_miri;

    /// Half length and both radii: narrowing either way, nearly a cone, and one ball in the other, just and by far.
    const SIZES: [[f32; 3]; 6] = [
        [0.4, 0.3, 0.1],
        [0.4, 0.1, 0.3],
        [0.5, 0.9, 0.01],
        [0.2, 0.599, 0.2],
        [0.2, 0.6, 0.2],
        [0.1, 0.05, 0.7],
    ];

    fn tapered([half_length, bottom_radius, top_radius]: [f32; 3]) -> Shape {
        Shape::TaperedCapsule { half_length, bottom_radius, top_radius }
    }

    fn scattered(step: usize) -> Vec3 {
        let spread = |k: f32| libm::sinf(step as f32 * k);
        Vec3::new(spread(0.7), spread(1.3), spread(2.9))
    }

    /// Signed distance from the hull of two balls: the farthest of the planes that touch it, in the plane of the axis.
    fn by_planes([half_length, bottom, top]: [f32; 3], point: Vec3) -> (f32, Vec3) {
        const PLANES: u32 = 20_000;
        let [half_length, bottom, top] = [half_length, bottom, top].map(f64::from);
        let out = libm::hypot(point.x.into(), point.z.into());
        let away = Vec3::new(point.x, 0.0, point.z) / out as f32;
        let mut farthest = (f64::NEG_INFINITY, Vec3::ZERO);
        for index in 0..=PLANES {
            let angle = core::f64::consts::PI * (f64::from(index) / f64::from(PLANES) - 0.5);
            let (up, across) = libm::sincos(angle);
            let edge = (bottom - up * half_length).max(top + up * half_length);
            let distance = across * out + up * f64::from(point.y) - edge;
            if distance > farthest.0 {
                farthest = (distance, away * across as f32 + Vec3::Y * up as f32);
            }
        }
        (farthest.0 as f32, farthest.1)
    }

    #[test]
    fn it_is_the_hull_of_two_balls() {
        for size in SIZES {
            for step in 1..unless_miri(300, 2) {
                let point = scattered(step) * 1.3;
                let surface = tapered(size).surface(point);
                let (distance, normal) = by_planes(size, point);
                // The plane at the cone's side lies between two of them.
                let off = surface.distance - distance;
                assert!((-2e-6..3e-5).contains(&off), "{size:?} at {point}: {surface:?}, not {distance}");
                assert!(surface.normal.dot(normal) > 0.9999, "{size:?} at {point}: {normal}");
                assert!((surface.normal.length() - 1.0).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn of_equal_radii_it_is_a_capsule_to_the_last_bit() {
        let capsule = Shape::Capsule { half_length: 0.43, radius: 0.21 };
        for step in 0..1000 {
            let point = scattered(step);
            assert_eq!(tapered([0.43, 0.21, 0.21]).surface(point), capsule.surface(point));
        }
        assert_eq!(tapered([0.43, 0.21, 0.21]).local_bounds(), capsule.local_bounds());
    }

    #[test]
    fn a_ball_that_holds_the_other_is_all_of_it() {
        for size in [[0.1, 0.7, 0.45], [0.1, 0.7, 0.01], [0.1, 0.45, 0.7]] {
            let (centre, radius) = if size[1] > size[2] { (-size[0], size[1]) } else { (size[0], size[2]) };
            for step in 0..1000 {
                let point = scattered(step);
                let ball = Shape::Sphere { radius }.surface(point - Vec3::Y * centre);
                assert_eq!(tapered(size).surface(point), ball);
            }
            let (low, high) = tapered(size).local_bounds();
            let ball = [centre - radius, centre + radius].map(|y| Vec3::new(0.0, y, 0.0));
            let across = Vec3::new(radius, 0.0, radius);
            assert!(
                (low - (ball[0] - across)).length() < 1e-6 && (high - (ball[1] + across)).length() < 1e-6
            );
            assert_eq!(tapered(size).least_half_extent(), radius);
        }
    }

    /// The nearest point of a triangle, against all points of a fine grid on it.
    #[test]
    fn the_nearest_point_of_a_face_is_found() {
        const GRID: usize = 40;
        let mut found = [0; 3];
        for size in SIZES {
            for step in 1..unless_miri(120, 2) {
                let middle = scattered(step) * 1.2;
                let corners = [1, 2, 3].map(|k| middle + scattered(step + 1000 * k) * 0.4);
                let grid = (0..=GRID).flat_map(|i| (0..=GRID - i).map(move |j| (i, j)));
                let least = grid
                    .map(|(i, j)| {
                        let [i, j] = [i, j].map(|k| k as f32 / GRID as f32);
                        tapered(size).distance(weighted([i, j, 1.0 - i - j], corners))
                    })
                    .fold(f32::INFINITY, f32::min);
                match tapered(size).nearest_on(FaceOrEdge::Triangle(corners), 0.5) {
                    Nearest::At(distance, _) => {
                        found[0] += 1;
                        assert!(distance < least + 1e-6, "{size:?}: {distance}, not {least}");
                        assert!(distance > least - 0.02, "{size:?}: {distance}, not {least}");
                    }
                    Nearest::Apart => {
                        found[1] += 1;
                        assert!(least > 0.5, "{size:?}: {least}");
                    }
                    Nearest::Through => {
                        found[2] += 1;
                        assert!(least < 0.02, "{size:?}: {least}");
                    }
                }
            }
        }
        assert!(found.into_iter().all(|count| count > 0), "{found:?}");
    }

    /// Balls, points, faces and edges that fly at it stop where a walk in small strides meets it.
    #[test]
    fn sweeps_end_at_the_surface() {
        const STRIDES: usize = 500;
        let mut hits = 0;
        for size in SIZES {
            let shape = tapered(size);
            for step in 1..unless_miri(60, 2) {
                let start = scattered(step).normalize() * 2.0;
                let path = scattered(step + 500) * 0.8 - 2.0 * start;
                let corners = [1, 2, 3].map(|k| start + scattered(step + 1000 * k) * 0.3);
                let pieces = [FaceOrEdge::Triangle(corners), FaceOrEdge::Segment([corners[0], corners[1]])];
                let walk = |distance: &dyn Fn(f32) -> f32| {
                    let strides = (1..=STRIDES).map(|stride| stride as f32 / STRIDES as f32);
                    strides.into_iter().find(|&fraction| distance(fraction) <= 0.0)
                };
                let check = |fraction: Option<f32>, distance: &dyn Fn(f32) -> f32| {
                    if let Some(fraction) = fraction {
                        let left = distance(fraction);
                        assert!(left > -1e-4 && left < 1e-4, "{size:?}: {left} m from it at its hit");
                    }
                    match (fraction, walk(distance)) {
                        (Some(exact), Some(walked)) => assert!(
                            exact <= walked + 1e-4 && exact > walked - 0.2,
                            "{size:?}: {exact}, not {walked}"
                        ),
                        (None, Some(walked)) => panic!("{size:?}: no hit at {walked}"),
                        _ => {}
                    }
                    fraction.is_some()
                };
                let point = |fraction: f32| shape.distance(start + path * fraction);
                hits += usize::from(check(shape.cast(start, path).map(|hit| hit.0), &point));
                let ball = |fraction: f32| point(fraction) - 0.1;
                let swept = shape.sweep_ball(0.1, start, path);
                check(swept.map(|hit| hit.fraction), &ball);
                for piece in pieces {
                    let gap = |fraction: f32| match shape
                        .nearest_on(piece.map(|corner| corner + path * fraction), 100.0)
                    {
                        Nearest::At(distance, _) => distance,
                        _ => 0.0,
                    };
                    let swept = shape.sweep_piece(piece, path);
                    check(swept.map(|hit| hit.fraction), &gap);
                    if let Some(hit) = swept {
                        let Surface { distance, normal } = shape.surface(hit.point);
                        assert!(distance.abs() < 1e-4 && normal.dot(hit.plane.normal) > 0.99);
                    }
                }
            }
        }
        assert!(hits > 50, "{hits}");
    }

    #[test]
    fn an_even_scale_keeps_its_form_and_an_uneven_one_makes_a_hull() {
        let shape = tapered([0.4, 0.3, 0.1]);
        let double = shape.scaled(Vec3::splat(2.0)).expect("valid");
        assert!((double.distance(Vec3::X) - 2.0 * shape.distance(Vec3::X * 0.5)).abs() < 1e-6);
        let flat = shape.scaled(Vec3::new(2.0, 1.0, 1.0)).expect("valid");
        let (low, high) = flat.local_bounds();
        assert!((low - Vec3::new(-0.6, -0.7, -0.3)).length() < 0.01, "{low}");
        assert!((high - Vec3::new(0.6, 0.5, 0.3)).length() < 0.01, "{high}");
        for size in [[0.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, f32::NAN]] {
            assert!(tapered(size).validate().is_err());
        }
    }
}
