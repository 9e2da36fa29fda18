//! Ropes that are knotted.

use drape_solver::glam::DVec3;
use drape_solver::{BodySettings, RopeBuilder};

use crate::experiments::contact::setup::Setup;
use crate::failure::Failure;

/// Particles of the rope.
const PARTICLES: u32 = 121;
/// Its length in metres.
const LENGTH: f64 = 2.4;
/// Weight in the loop of the bowline, in kilograms; the rope itself weighs 0.24 kg.
const LOAD: f32 = 0.5;

/// A loose bowline, in radii of its small loop. The rope hangs from the first point, makes the small loop and the large one,
/// comes up through the small loop from behind, goes behind itself, and back down through the small loop.
const BOWLINE: [[f64; 3]; 30] = [
    [1.0, 5.5, 0.0],
    [1.0, 4.0, 0.0],
    [1.0, 3.0, 0.0],
    // The small loop.
    [1.05, 2.0, 0.0],
    [1.1, 1.0, -0.35],
    [1.0, 0.0, -0.35],
    [0.0, -1.05, -0.1],
    [-1.0, 0.0, 0.1],
    [-0.3, 1.0, 0.15],
    [1.0, 1.15, 0.45],
    // The large loop.
    [2.2, 0.6, 0.4],
    [2.7, -1.0, 0.1],
    [2.6, -3.0, 0.0],
    [1.3, -4.8, 0.0],
    [-0.4, -5.0, 0.0],
    [-1.6, -3.6, -0.2],
    [-1.3, -1.8, -0.7],
    // Up through the small loop, and behind the rope.
    [-0.7, -0.7, -0.75],
    [-0.15, 0.05, 0.0],
    [0.0, 0.9, 0.75],
    [0.3, 1.7, 0.5],
    [1.0, 2.3, -0.6],
    [1.7, 2.2, 0.0],
    // Down through the small loop.
    [1.35, 1.7, 0.8],
    [0.75, 1.0, 1.05],
    [0.4, 0.2, 0.45],
    [0.35, -0.5, -0.4],
    [0.35, -1.2, -0.9],
    [0.4, -2.2, -0.7],
    [0.4, -3.2, -0.4],
];

/// A rope that hangs from its first particle, tied in a bowline that has yet to draw tight, with a weight at the lowest
/// particle of the large loop.
///
/// # Errors
/// [`Failure`] if the solver refuses the rope.
pub fn bowline(settings: BodySettings) -> Result<Setup, Failure> {
    let places = along(&BOWLINE.map(DVec3::from_array));
    let [first, last] = [places[0], places[0] - DVec3::Y * LENGTH].map(DVec3::as_vec3);
    let mut rope = RopeBuilder::new(first, last, PARTICLES).pin_start().build(settings)?;
    for (i, place) in places.iter().enumerate() {
        rope.particles.set_position(i, place.as_vec3());
    }
    let heights = places.iter().map(|place| place.y).enumerate();
    if let Some((lowest, _)) = heights.min_by(|a, b| a.1.total_cmp(&b.1)) {
        rope.particles.set_inverse_mass(lowest, 1.0 / LOAD);
    }
    Ok(Setup::new(vec![rope], Vec::new()))
}

/// Places of the rope's particles, at even distances along a Catmull-Rom spline through `points`, which is scaled to the
/// length of the rope.
fn along(points: &[DVec3]) -> Vec<DVec3> {
    let last = points.len() - 1;
    let mut fine = vec![points[0]];
    for i in 0..last {
        let [from, to] = [points[i], points[i + 1]];
        let before = if i == 0 { 2.0 * from - to } else { points[i - 1] };
        let after = if i + 1 == last { 2.0 * to - from } else { points[i + 2] };
        fine.extend((1..=1000).map(|k| spline([before, from, to, after], f64::from(k) * 1e-3)));
    }
    let mut ways = vec![0.0];
    for pair in fine.windows(2) {
        ways.push(ways[ways.len() - 1] + pair[0].distance(pair[1]));
    }
    let whole = ways[ways.len() - 1];
    let place = |i: u32| {
        let way = whole * f64::from(i) / f64::from(PARTICLES - 1);
        fine[ways.partition_point(|&to| to < way).min(fine.len() - 1)] * (LENGTH / whole)
    };
    (0..PARTICLES).map(place).collect()
}

/// A point of the Catmull-Rom spline between the second and the third of four points, at a `time` from 0 to 1.
fn spline([a, b, c, d]: [DVec3; 4], time: f64) -> DVec3 {
    let (square, cube) = (time * time, time * time * time);
    0.5 * (2.0 * b
        + (c - a) * time
        + (2.0 * a - 5.0 * b + 4.0 * c - d) * square
        + (3.0 * b - a - 3.0 * c + d) * cube)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loose_bowline_keeps_its_length_and_does_not_touch_itself() {
        let places = along(&BOWLINE.map(DVec3::from_array));
        let link = LENGTH / f64::from(PARTICLES - 1);
        for pair in places.windows(2) {
            let length = pair[0].distance(pair[1]);
            assert!((0.9 * link..1.01 * link).contains(&length), "{length} of {link}");
        }
        // Points of links in tenths: the gap is that to within a millimetre.
        let fine: Vec<DVec3> = places
            .windows(2)
            .flat_map(|pair| (0..10).map(|k| pair[0].lerp(pair[1], 0.1 * f64::from(k))))
            .collect();
        let pairs = (0..fine.len()).flat_map(|i| (0..i.saturating_sub(30)).map(move |j| (i, j)));
        let least = pairs.map(|(i, j)| fine[i].distance(fine[j])).fold(f64::INFINITY, f64::min);
        assert!(least > 0.015, "{least} m");
    }
}
