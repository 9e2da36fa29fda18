//! First touch of two convex solids of which one moves straight on, from the plane between them.
//!
//! All of one solid lies behind the plane through its nearest point, so they touch no sooner than the other gets to that plane. There
//! the next plane is found, and so on: Newton's method, from one side, as the distance is a convex function of the time.
//!
//! Design: `docs/design/obstacles.md`.

use glam::Vec3;

/// Planes after which the two are taken to touch: a path that only grazes halves its distance with each.
const MOST_PLANES: usize = 24;

/// The first touch on a `path`: the fraction of it, 0 to 1, and the unit normal there, against the path. `gap` gives distance and
/// normal at a fraction; up to `noise` metres it is a touch. None if the two intersect at the start.
pub(crate) fn first_touch(
    path: Vec3,
    noise: f32,
    gap: impl Fn(f32) -> Option<(f32, Vec3)>,
) -> Option<(f32, Vec3)> {
    let mut fraction = 0.0;
    let (mut distance, mut normal) = gap(fraction).filter(|&(distance, _)| distance >= 0.0)?;
    for _ in 0..MOST_PLANES {
        let closing = -normal.dot(path);
        if closing <= 0.0 {
            return None;
        }
        if distance <= noise {
            break;
        }
        // Stops short, as solids that touch by rounding have no plane between them.
        fraction += (distance - 0.5 * noise) / closing;
        if fraction > 1.0 {
            return None;
        }
        let Some(next) = gap(fraction) else { break };
        (distance, normal) = next;
    }
    (normal.dot(path) < 0.0).then_some((fraction, normal))
}
