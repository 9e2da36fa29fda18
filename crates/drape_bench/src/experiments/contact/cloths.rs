//! Cloth that folds, falls in layers, and is twisted.
//!
//! ```text
//!    fold      ~ a strip on its edge, in slight waves      stack   ==== sheets above each other,
//!              |                                                   ==== each turned a little more
//!            __|__ ground                                            O  sphere on the ground
//! ```

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use drape_solver::glam::{DVec2, DVec3, Vec3};
use drape_solver::{
    Ball, BallMaterial, Body, BodySettings, BuildError, ClothBuilder, Edge, Obstacle, Placement, Shape,
};

use crate::experiments::contact::setup::{PinPath, Setup};
use crate::failure::Failure;
use crate::scenes::world::GRAVITY;

/// Friction of all obstacles.
pub(super) const FRICTION: f32 = 0.5;

/// Seconds for which the ends of a twisted sheet turn.
const TWISTING: f32 = 2.0;

/// A sheet that is flat at rest, `size` metres wide and high. Its point at `(u, v)` metres from the first corner begins at
/// `place(u, v)`. `pinned` edges are held.
///
/// # Errors
/// [`BuildError`] if the solver refuses the sheet.
pub(super) fn sheet(
    size: [f32; 2],
    [columns, rows]: [u32; 2],
    pinned: &[Edge],
    settings: BodySettings,
    place: impl Fn(DVec2) -> DVec3,
) -> Result<Body, BuildError> {
    let first = place(DVec2::ZERO).as_vec3();
    let flat = ClothBuilder::new(size[0], size[1], columns, rows).placed(first, Vec3::X, Vec3::NEG_Y);
    let mut body = pinned.iter().fold(flat, |sheet, &edge| sheet.pin_edge(edge)).build(settings)?;
    let part = |i: u32, count: u32| f64::from(i) / f64::from(count - 1);
    for i in 0..columns * rows {
        let (u, v) = (part(i % columns, columns), part(i / columns, rows));
        let at = DVec2::new(u * f64::from(size[0]), v * f64::from(size[1]));
        body.particles.set_position(i as usize, place(at).as_vec3());
    }
    Ok(body)
}

/// Level square sheets above each other about the Y axis, the lowest at `height` metres, 3 cm apart, each turned by 0.1 more
/// than the one below.
///
/// # Errors
/// [`BuildError`] if the solver refuses a sheet.
pub(super) fn level_sheets(
    count: u32,
    side: f64,
    n: u32,
    height: f64,
    settings: BodySettings,
) -> Result<Vec<Body>, BuildError> {
    let level = |i: u32| {
        let turn = DVec2::from_angle(0.1 * f64::from(i));
        let place = move |at: DVec2| {
            let turned = turn.rotate(at - 0.5 * side);
            DVec3::new(turned.x + 0.01, height + 0.03 * f64::from(i), turned.y - 0.007)
        };
        sheet([side as f32; 2], [n, n], &[], settings, place)
    };
    (0..count).map(level).collect()
}

/// A strip of 0.4 m x 2 m that stands 12 mm above the ground on a short edge. Waves of 5 mm and 0.25 m length, whose phase
/// turns over the width, decide how it folds.
///
/// # Errors
/// [`Failure`] if the solver refuses the strip.
pub fn fold(columns: u32, rows: u32, settings: BodySettings) -> Result<Setup, Failure> {
    let place = |at: DVec2| {
        let height = (2.0 - at.y) * 0.996;
        let phase = TAU * height / 0.25 + 1.5 * at.x / 0.4;
        DVec3::new(at.x - 0.2, height + 0.012, 0.005 * phase.sin())
    };
    let strip = sheet([0.4, 2.0], [columns, rows], &[], settings, place)?;
    Ok(Setup::new(vec![strip], vec![Obstacle::ground()]))
}

/// Sheets of 1 m fall on a sphere of 0.5 m radius that lies on the ground.
///
/// # Errors
/// [`Failure`] if the solver refuses a sheet.
pub fn stack(count: u32, n: u32, settings: BodySettings) -> Result<Setup, Failure> {
    let sheets = level_sheets(count, 1.0, n, 1.05, settings)?;
    let sphere = Obstacle::new(Shape::Sphere { radius: 0.5 }, Placement::at(Vec3::Y * 0.5), FRICTION)?;
    Ok(Setup::new(sheets, vec![Obstacle::ground(), sphere]))
}

/// A sheet of 1 m that hangs by its upper edge, at 45 degrees when it is let go.
///
/// # Errors
/// [`Failure`] if the solver refuses the sheet.
pub fn swing(n: u32, settings: BodySettings) -> Result<Setup, Failure> {
    let place = |at: DVec2| DVec3::new(at.x - 0.5, 2.0 - at.y * FRAC_1_SQRT_2, at.y * FRAC_1_SQRT_2);
    let sheet = sheet([1.0, 1.0], [n, n], &[Edge::Top], settings, place)?;
    Ok(Setup::new(vec![sheet], Vec::new()))
}

/// The curtain of the cannon demo, 4 m x 3 m, and five balls in flight that hit it at 20 m/s, one a second.
///
/// # Errors
/// [`Failure`] if the solver refuses the curtain or a ball.
pub fn bombarded_curtain(particles: [u32; 2], settings: BodySettings) -> Result<Setup, Failure> {
    let place = |at: DVec2| DVec3::new(at.x - 2.0, 3.3 - at.y, 0.0);
    let settings = BodySettings { drag: 2.0, ..settings };
    let curtain = sheet([4.0, 3.0], particles, &[Edge::Top], settings, place)?;
    let mut setup = Setup::new(vec![curtain], vec![Obstacle::ground()]);
    let material = BallMaterial { radius: 0.15, mass: 2.0, ..BallMaterial::default() };
    for (number, across) in [0.3, -0.8, 0.9, -0.2, 0.0].into_iter().enumerate() {
        // At this time it is as high as now.
        let seconds = 0.5 + number as f32;
        let at = Vec3::new(across, 1.0 + 0.3 * number as f32, 20.0 * seconds);
        let velocity = Vec3::new(0.0, 0.5 * -GRAVITY.y * seconds, -20.0);
        setup.island.balls.push(Ball::new(material, at, velocity)?);
    }
    Ok(setup)
}

/// A level sheet of 1 m, held by two opposite edges that go on this way.
///
/// # Errors
/// [`Failure`] if the solver refuses the sheet.
pub fn twist(n: u32, path: PinPath, settings: BodySettings) -> Result<Setup, Failure> {
    let place = |at: DVec2| DVec3::new(at.x - 0.5, 0.0, at.y - 0.5);
    let sheet = sheet([1.0, 1.0], [n, n], &[Edge::Top, Edge::Bottom], settings, place)?;
    Ok(Setup::new(vec![sheet], Vec::new()).with_moving_pins(path))
}

/// The edges turn about Z against each other, each by one turn in two seconds.
pub fn twisted(start: Vec3, seconds: f32) -> Vec3 {
    let side = -f64::from(start.z.signum());
    let turn = DVec2::from_angle(side * PI * f64::from(seconds.min(TWISTING)));
    turn.rotate(start.truncate().as_dvec2()).extend(f64::from(start.z)).as_vec3()
}

/// The same, while each edge comes 0.3 m nearer to the other.
pub fn twisted_and_nearer(start: Vec3, seconds: f32) -> Vec3 {
    twisted(start, seconds) - Vec3::Z * start.z.signum() * 0.15 * seconds.min(TWISTING)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edges_of_a_twisted_sheet_make_one_turn_each_and_come_nearer() {
        let corner = Vec3::new(0.5, 0.0, -0.5);
        let quarter = twisted(corner, 0.5);
        assert!(quarter.abs_diff_eq(Vec3::new(0.0, 0.5, -0.5), 1e-6), "{quarter}");
        let other = twisted(corner.with_z(0.5), 0.5);
        assert!(other.abs_diff_eq(Vec3::new(0.0, -0.5, 0.5), 1e-6), "{other}");
        for seconds in [2.0, 3.0] {
            let last = twisted_and_nearer(corner, seconds);
            assert!(last.abs_diff_eq(Vec3::new(0.5, 0.0, -0.2), 1e-6), "{last}");
        }
    }
}
