//! Cloth that is thrown, pulled or dropped into places narrower than it is.
//!
//! ```text
//!    box    | ==== |      sleeve   | |  sleeve       funnel   ====
//!           | ==== |              o| |o ring                 \    /
//!           |______|               \_/  pulled down           \||/
//! ```

use std::f32::consts::{PI, TAU};

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{Body, BodySettings, BuildError, MeshClothBuilder, Obstacle, Placement, Shape};

use crate::experiments::contact::cloths::{FRICTION, level_sheets};
use crate::experiments::contact::setup::Setup;
use crate::failure::Failure;

/// Half the inner width of the box, and its depth, in metres.
const BOX: [f32; 2] = [0.2, 0.5];
/// Half the thickness of the walls of box and funnel, in metres.
const WALL: f32 = 0.05;

/// Radius and length of the sleeve in metres.
const SLEEVE: [f32; 2] = [0.2, 0.6];
/// Radius of the ring's middle line, and of the ring's tube, in metres: the hole has a radius of 0.12 m.
const RING: [f32; 2] = [0.15, 0.03];
/// Radius in metres to which the pins of the sleeve draw its rim together.
const DRAWN: f32 = 0.07;

/// Half the width of the funnel's neck, its height above the ground, and the length of its walls, in metres.
const NECK: [f32; 3] = [0.09, 0.4, 0.7];
/// Steepness of the funnel's walls in radians.
const STEEPNESS: f32 = 55.0 * PI / 180.0;

/// Square sheets of 0.6 m are thrown at 3 m/s into an open box of five walls, 0.4 m wide and 0.5 m deep.
///
/// # Errors
/// [`Failure`] if the solver refuses a sheet.
pub fn filled_box(count: u32, n: u32, settings: BodySettings) -> Result<Setup, Failure> {
    let [half, depth] = BOX;
    let mut sheets = level_sheets(count, 0.6, n, f64::from(depth) + 0.1, settings)?;
    for particles in sheets.iter_mut().map(|sheet| &mut sheet.particles) {
        (0..particles.len()).for_each(|i| particles.set_velocity(i, Vec3::NEG_Y * 3.0));
    }
    let floor = Vec3::new(half + 2.0 * WALL, WALL, half + 2.0 * WALL);
    let mut walls = vec![cuboid(floor, Placement::at(Vec3::NEG_Y * WALL))?];
    for side in 0..4_u8 {
        let rotation = Quat::from_rotation_y(f32::from(side) * 0.5 * PI);
        let translation = rotation * Vec3::new(half + WALL, 0.5 * depth, 0.0);
        let half_extents = Vec3::new(WALL, 0.5 * depth, half + 2.0 * WALL);
        walls.push(cuboid(half_extents, Placement { translation, rotation })?);
    }
    Ok(Setup::new(sheets, walls))
}

/// A sleeve of 0.2 m radius and 0.6 m length, with `around` particles around it, above a ring of capsules. Pins at every
/// fourth particle of its lower rim draw the rim together and then down through the ring.
///
/// # Errors
/// [`Failure`] if the solver refuses the sleeve.
pub fn sleeve(around: u32, settings: BodySettings) -> Result<Setup, Failure> {
    let [middle, radius] = RING;
    let links = 24_u8;
    let half_length = middle * (PI / f32::from(links)).tan();
    let ring: Result<Vec<Obstacle>, BuildError> = (0..links)
        .map(|link| {
            let turn = Quat::from_rotation_y(TAU * f32::from(link) / f32::from(links));
            let rotation = turn * Quat::from_rotation_x(0.5 * PI);
            let place = Placement { translation: turn * Vec3::X * middle, rotation };
            Obstacle::new(Shape::Capsule { half_length, radius }, place, FRICTION)
        })
        .collect();
    Ok(Setup::new(vec![tube(around, settings)?], ring?).with_moving_pins(pulled_down))
}

/// Half a second inwards, then 2.4 seconds down at 0.5 m/s.
fn pulled_down(start: Vec3, seconds: f32) -> Vec3 {
    let inwards = Vec3::new(start.x, 0.0, start.z) * (DRAWN / SLEEVE[0] - 1.0);
    start + inwards * (2.0 * seconds).min(1.0) + Vec3::NEG_Y * 0.5 * (seconds - 0.5).clamp(0.0, 2.4)
}

/// The sleeve: an open cylinder about the Y axis, its lower rim 6 cm above the ring's middle.
fn tube(around: u32, settings: BodySettings) -> Result<Body, Failure> {
    let [radius, length] = SLEEVE;
    let rows = (length * around as f32 / (TAU * radius)).round() as u32 + 1;
    let mut places = Vec::new();
    let mut faces = Vec::new();
    for row in 0..rows {
        for column in 0..around {
            let turn = Quat::from_rotation_y(TAU * column as f32 / around as f32);
            let height = 0.06 + length * row as f32 / (rows - 1) as f32;
            places.push(turn * Vec3::X * radius + Vec3::Y * height);
            if row + 1 < rows {
                let next = (column + 1) % around;
                let [a, b, c, d] = [column, next, column + around, next + around].map(|i| row * around + i);
                let is_even = (column + row) % 2 == 0;
                faces.extend(if is_even { [[a, d, c], [a, b, d]] } else { [[a, b, c], [b, d, c]] });
            }
        }
    }
    let rim = (0..around).step_by(4);
    let sleeve = rim.fold(MeshClothBuilder::new(places, faces), MeshClothBuilder::pin);
    Ok(sleeve.build(settings)?)
}

/// Square sheets of 0.8 m fall into a funnel of four inclined walls, through a neck 0.18 m wide, and on the ground.
///
/// # Errors
/// [`Failure`] if the solver refuses a sheet.
pub fn funnel(count: u32, n: u32, settings: BodySettings) -> Result<Setup, Failure> {
    let [neck, height, length] = NECK;
    let mouth = height + length * STEEPNESS.sin();
    let sheets = level_sheets(count, 0.8, n, f64::from(mouth) + 0.08, settings)?;
    let mut obstacles = vec![Obstacle::ground()];
    for side in 0..4_u8 {
        let incline = Quat::from_rotation_z(STEEPNESS);
        let turn = Quat::from_rotation_y(f32::from(side) * 0.5 * PI);
        let half_extents = Vec3::new(0.5 * length, WALL, 0.7);
        // The inner edge of the wall's upper side is the neck.
        let centre = Vec3::new(neck, height, 0.0) + incline * (half_extents * Vec3::new(1.0, -1.0, 0.0));
        obstacles
            .push(cuboid(half_extents, Placement { translation: turn * centre, rotation: turn * incline })?);
    }
    Ok(Setup::new(sheets, obstacles))
}

fn cuboid(half_extents: Vec3, placement: Placement) -> Result<Obstacle, BuildError> {
    Obstacle::new(Shape::Cuboid { half_extents }, placement, FRICTION)
}
