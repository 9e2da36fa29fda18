//! The nearest points of two segments.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

/// Parameters, from 0 to 1, of the nearest points of two segments (Ericson, "Real-Time Collision Detection", section
/// 5.1.9). A segment may be a point.
pub(crate) fn between_segments([a, b]: [Vec3; 2], [c, d]: [Vec3; 2]) -> [f32; 2] {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let part = |along: f32, whole: f32| if whole > 0.0 { (along / whole).clamp(0.0, 1.0) } else { 0.0 };
    let area = uu * vv - uv * uv;
    // Parallel segments have many nearest points; an end of one is good enough.
    let s = if area > 1e-6 * uu * vv { ((uv * vw - uw * vv) / area).clamp(0.0, 1.0) } else { 0.0 };
    let t = if vv > 0.0 { (uv * s + vw) / vv } else { 0.0 };
    if t < 0.0 || vv == 0.0 {
        [part(-uw, uu), 0.0]
    } else if t > 1.0 {
        [part(uv - uw, uu), 1.0]
    } else {
        [s, t]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;

    /// No two points of a fine sampling may be nearer than those found.
    #[test]
    fn no_other_points_of_the_segments_are_nearer() {
        for step in 0..unless_miri(500, 5) {
            let spread = |k: f32| libm::sinf(step as f32 * k) * 2.0;
            let point = |k: f32| Vec3::new(spread(0.31 * k), spread(0.57 * k), spread(0.93 * k));
            let (p, mut q) = ([point(1.0), point(2.3)], [point(3.1), point(4.7)]);
            match step % 5 {
                0 => q[1] = q[0] + (p[1] - p[0]) * 0.7,
                1 => q[1] = q[0],
                _ => {}
            }
            let at = |ends: [Vec3; 2], t: f32| ends[0].lerp(ends[1], t);
            let [s, t] = between_segments(p, q);
            assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t));
            let found = at(p, s).distance(at(q, t));
            for (i, j) in
                (0..=40).filter(|i| i % unless_miri(1, 10) == 0).flat_map(|i| (0..=40).map(move |j| (i, j)))
            {
                let other = at(p, i as f32 / 40.0).distance(at(q, j as f32 / 40.0));
                assert!(found <= other + 1e-4, "{found} > {other} in {step}");
            }
        }
    }
}
