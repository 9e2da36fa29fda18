//! Distances between layers, measured by the tests themselves in double precision, from every corner to every face.

use drape_solver::glam::DVec3;
use drape_solver::state::measure;
use drape_solver::{Body, Island};

/// Distance in metres from a point to a triangle (Ericson 2005, "Real-time collision detection", 5.1.5).
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    let (bp, cp) = (p - b, p - c);
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if va > 0.0 && vb > 0.0 && vc > 0.0 {
        return ap.dot(ab.cross(ac).normalize()).abs();
    }
    [[a, b], [b, c], [c, a]].map(|side| to_segment(p, side)).into_iter().fold(f64::INFINITY, f64::min)
}

fn to_segment(p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let way = b - a;
    let part = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    p.distance(a + way * part)
}

/// Distances in metres from each corner of `body` to the nearest face of `other`, of those that are less than `reach`; `counts` tells
/// whether a corner and a face do.
fn corners_to_faces(
    body: &Body,
    other: &Body,
    reach: f64,
    counts: impl Fn(usize, [u32; 3]) -> bool,
) -> Vec<f64> {
    let corners: Vec<DVec3> = measure::positions(&body.particles).collect();
    let places: Vec<DVec3> = measure::positions(&other.particles).collect();
    let mut nearest = vec![f64::INFINITY; corners.len()];
    for &face in other.topology.faces() {
        let triangle = face.map(|corner| places[corner as usize]);
        let low = triangle[0].min(triangle[1]).min(triangle[2]) - reach;
        let high = triangle[0].max(triangle[1]).max(triangle[2]) + reach;
        for (i, &corner) in corners.iter().enumerate() {
            if corner.cmpge(low).all() && corner.cmple(high).all() && counts(i, face) {
                nearest[i] = nearest[i].min(to_triangle(corner, triangle));
            }
        }
    }
    nearest.retain(|&distance| distance < reach);
    nearest
}

/// Distances in metres of corners of one body to the nearest face of the other, both ways, of those that are less than `reach`.
pub fn between(a: &Body, b: &Body, reach: f64) -> Vec<f64> {
    [corners_to_faces(a, b, reach, |_, _| true), corners_to_faces(b, a, reach, |_, _| true)].concat()
}

/// The same for all pairs of bodies of an island.
pub fn of_bodies(island: &Island, reach: f64) -> Vec<f64> {
    let bodies = &island.bodies;
    let pairs = (0..bodies.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    pairs.flat_map(|(a, b)| between(&bodies[a], &bodies[b], reach)).collect()
}

/// The same for a body and itself: of corners and faces that are more than `apart` metres apart in its pose `rest`.
pub fn within(body: &Body, rest: &[DVec3], apart: f64, reach: f64) -> Vec<f64> {
    corners_to_faces(body, body, reach, |i, face| {
        face.iter().all(|&corner| rest[i].distance(rest[corner as usize]) > apart)
    })
}

/// The least of some distances.
pub fn least(distances: &[f64]) -> f64 {
    distances.iter().copied().fold(f64::INFINITY, f64::min)
}

#[test]
fn distances_of_a_point_and_a_triangle_are_right() {
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    for (point, distance) in [
        (DVec3::new(0.2, 0.3, 0.5), 0.5),
        (DVec3::new(0.2, 0.3, -0.5), 0.5),
        (DVec3::new(0.5, -3.0, 4.0), 5.0),
        (DVec3::new(-3.0, -4.0, 12.0), 13.0),
        (DVec3::new(1.0, 1.0, 0.0), 0.5_f64.sqrt()),
        (DVec3::new(4.0, -4.0, 0.0), 5.0),
    ] {
        assert!((to_triangle(point, triangle) - distance).abs() < 1e-12, "{point}");
    }
}
