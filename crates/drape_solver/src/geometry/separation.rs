//! A lower bound on the distance of two triangles.
//!
//! Design: `docs/design/self_contact.md`.

use glam::Vec3;

/// A lower bound on the distance of two triangles, in metres: the widest gap along some directions. Zero or less if they
/// may cross. Triangles may be segments or points. The search ends once the gap is `enough`.
pub(crate) fn separation(triangles: [[Vec3; 3]; 2], enough: f32) -> f32 {
    let [a, b] = triangles;
    let [low_a, low_b] = triangles.map(|[p, q, r]| p.min(q).min(r));
    let [high_a, high_b] = triangles.map(|[p, q, r]| p.max(q).max(r));
    let gaps = (low_a - high_b).max(low_b - high_a);
    let mut widest = gaps.max_element();
    let mut along = |direction: Vec3| {
        let squared = direction.length_squared();
        if widest < enough && squared > 0.0 {
            let [p, q] = triangles.map(|corners| corners.map(|corner| corner.dot(direction)));
            let least = |p: [f32; 3]| p[0].min(p[1]).min(p[2]);
            let most = |p: [f32; 3]| p[0].max(p[1]).max(p[2]);
            let gap = (least(p) - most(q)).max(least(q) - most(p));
            // Most directions show no gap: only the others take a square root.
            if gap > 0.0 || widest < 0.0 {
                widest = widest.max(gap / squared.sqrt());
            }
        }
    };
    let normals = triangles.map(|[p, q, r]| (q - p).cross(r - p));
    normals.into_iter().for_each(&mut along);
    along((a[0] + a[1] + a[2]) - (b[0] + b[1] + b[2]));
    for ([p, q, r], normal) in triangles.into_iter().zip(normals) {
        // Directions across each edge, for neighbours in a plane.
        along(normal.cross(q - p));
        along(normal.cross(r - q));
        along(normal.cross(p - r));
    }
    widest
}
