//! The nearest point of a segment or triangle, as weights of its corners.
//!
//! Design: `docs/design/ball_cloth.md`.

use core::ops::{Add, Mul};

use glam::Vec3;

/// Weights of the point of segment `ends` that is nearest to `point`; the third is always zero.
pub fn on_segment([a, b]: [Vec3; 2], point: Vec3) -> [f32; 3] {
    let along = b - a;
    let length_squared = along.length_squared();
    // A segment without length is its first end.
    let t =
        if length_squared > 0.0 { ((point - a).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    [1.0 - t, t, 0.0]
}

/// Weights of the point of a triangle that is nearest to `point` (Ericson, "Real-Time Collision Detection",
/// section 5.1.5): the plane is divided into the regions that belong to each corner, edge and the face.
///
/// ```text
///        \ c /
///    ca   \ /   bc
///      ___/ \___
///     a  / f \  b
///    ---+-----+---
///       | ab  |
/// ```
#[inline]
pub fn on_triangle([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let [s, t, _] = on_segment([a, b], point);
        return [s, t, 0.0];
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let [s, t, _] = on_segment([a, c], point);
        return [s, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let [s, t, _] = on_segment([b, c], point);
        return [0.0, s, t];
    }
    let sum = va + vb + vc;
    // Only a triangle without area gets here with a zero sum; any corner will do.
    if sum <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (v, w) = (vb / sum, vc / sum);
    [1.0 - v - w, v, w]
}

/// The sum of `vectors`, each times its weight, from the first to the last: the point of a triangle with these barycentric
/// weights, for example.
#[inline]
pub(crate) fn weighted<V, const N: usize>(weights: [f32; N], vectors: [V; N]) -> V
where
    V: Copy + Add<Output = V> + Mul<f32, Output = V>,
{
    let mut sum = vectors[0] * weights[0];
    for k in 1..N {
        sum = sum + vectors[k] * weights[k];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;

    const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.5)];

    fn point_of(weights: [f32; 3]) -> Vec3 {
        TRIANGLE[0] * weights[0] + TRIANGLE[1] * weights[1] + TRIANGLE[2] * weights[2]
    }

    /// No point of a fine sampling of the triangle may be nearer than the one found.
    #[test]
    fn no_other_point_of_the_triangle_is_nearer() {
        for step in 0..unless_miri(500, 3) {
            let spread = |k: f32| libm::sinf(step as f32 * k) * 3.0;
            let point = Vec3::new(spread(0.71), spread(1.37), spread(2.93));
            let weights = on_triangle(TRIANGLE, point);
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)));
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            let found = point.distance(point_of(weights));
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let (u, v) = (i as f32 / 40.0, j as f32 / 40.0);
                    let other = point.distance(point_of([1.0 - u - v, u, v]));
                    assert!(found <= other + 1e-4, "{point}: {found} > {other}");
                }
            }
        }
    }

    #[test]
    fn degenerate_triangles_and_segments_stay_finite() {
        for corners in [[Vec3::ONE; 3], [Vec3::ZERO, Vec3::X, Vec3::X * 2.0]] {
            let weights = on_triangle(corners, Vec3::new(0.3, 1.0, 0.0));
            assert!(weights.iter().all(|w| w.is_finite()));
        }
        assert_eq!(on_segment([Vec3::ONE; 2], Vec3::ZERO), [1.0, 0.0, 0.0]);
    }
}
