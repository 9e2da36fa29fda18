//! Measurements of textile laboratories: the drape of a cloth over a disc, its bending length, and its stretch by its own weight.
//!
//! ```
//! use drape_solver::drape_test::drape_coefficient;
//! use drape_solver::{BodySettings, Preset};
//!
//! let coefficient = |preset: Preset| {
//!     drape_coefficient(preset.material(), preset.settings(BodySettings::default()))
//! };
//! // Silk hangs down from the disc; leather stands out over it.
//! assert!(coefficient(Preset::Silk)? < 0.2 && coefficient(Preset::Leather)? > 0.3);
//! # Ok::<(), drape_solver::StepError>(())
//! ```
//!
//! Design: `docs/design/presets.md`.

use glam::{Quat, Vec2, Vec3};
use parry3d::shape::SharedShape;

use crate::build::cloth::{ClothBuilder, ClothMaterial, Edge};
use crate::build::mesh::cloth::MeshClothBuilder;
use crate::build::mesh::error::MeshError;
use crate::error::{BuildError, StepError};
use crate::geometry::pose::Placement;
use crate::geometry::shape::Shape;
use crate::island::Island;
use crate::motion::environment::Environment;
use crate::state::body::Body;
use crate::state::obstacle::Obstacle;
use crate::state::settings::BodySettings;
use crate::step::step;

/// Side of the cloth, and diameter of the disc that it hangs over, in metres: those of Cusick's apparatus.
const SIDE: f32 = 0.30;
const DISC: f32 = 0.18;

/// Side of the squares by which the shadow is counted, in metres.
const PIXEL: f32 = 0.0015;

/// Simulated seconds until the cloth hangs still, and until a curtain does.
const SETTLING: [f32; 2] = [2.0, 6.0];

/// The drape coefficient (Cusick 1968): the part of the overhang of a cloth that its shadow covers when it hangs over a disc,
/// from 0 (limp) to 1 (a board). The cloth is a square of 30 cm, and not round, over a disc of 18 cm.
///
/// # Errors
/// [`StepError`] if material or settings are out of range.
pub fn drape_coefficient(material: ClothMaterial, settings: BodySettings) -> Result<f32, StepError> {
    let settings = hanging(settings);
    let cloth = ClothBuilder::new(SIDE, SIDE, 16, 16)
        .placed(Vec3::new(-0.5 * SIDE, settings.thickness, -0.5 * SIDE), Vec3::X, Vec3::Z)
        .material(material);
    coefficient(cloth.build(settings).map_err(bad)?, SIDE * SIDE)
}

fn bad(source: BuildError) -> StepError {
    StepError::BadSettings { body: 0, source }
}

/// Area of a circle of this diameter.
fn circle(diameter: f32) -> f32 {
    core::f32::consts::PI * diameter * diameter / 4.0
}

/// These settings with a strong drag, so that the cloth does not swing.
fn hanging(settings: BodySettings) -> BodySettings {
    BodySettings { drag: 4.0, thickness: 0.002, ..settings }
}

/// Hangs a cloth of this area over the disc, and measures its shadow.
fn coefficient(cloth: Body, area: f32) -> Result<f32, StepError> {
    let mut island = Island::of_body(cloth);
    let disc = Shape::from_parry(SharedShape::cylinder(0.01, 0.5 * DISC)).map_err(bad)?;
    let place = Placement { translation: Vec3::NEG_Y * 0.01, rotation: Quat::IDENTITY };
    let disc = Obstacle::new(disc, place, 0.5).map_err(bad)?;
    let environment = Environment { obstacles: vec![disc].into(), ..Environment::default() };
    settle(&mut island, &environment, SETTLING[0])?;
    let disc = circle(DISC);
    Ok((shadow(&island) - disc) / (area - disc))
}

/// The drape coefficient of a round specimen of 30 cm over a disc of 18 cm (Cusick 1968), as a mesh of this number of rings of triangles.
///
/// # Errors
/// [`StepError`] if material or settings are out of range.
pub fn round_drape_coefficient(
    material: ClothMaterial,
    settings: BodySettings,
    rings: u32,
) -> Result<f32, StepError> {
    let settings = hanging(settings);
    let (places, faces) = specimen(rings, settings.thickness);
    let cloth = MeshClothBuilder::new(places, faces).material(material).build(settings);
    let cloth = cloth.map_err(|error| match error {
        MeshError::Build(source) => bad(source),
        _ => bad(BuildError::BadShape { reason: "a specimen needs rings" }),
    })?;
    coefficient(cloth, circle(SIDE))
}

/// A round specimen of `rings` rings, of 6, 12, 18 .. vertices.
fn specimen(rings: u32, height: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut places = vec![Vec3::Y * height];
    let mut faces = Vec::new();
    for ring in 1..=rings {
        let radius = 0.5 * SIDE * ring as f32 / rings as f32;
        for i in 0..6 * ring {
            let angle = f64::from(i) / f64::from(6 * ring) * core::f64::consts::TAU;
            let (sin, cos) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
            places.push(Vec3::new(cos * radius, height, sin * radius));
        }
        let vertex =
            |ring: u32, i: u32| if ring == 0 { 0 } else { 1 + 3 * ring * (ring - 1) + i % (6 * ring) };
        for (sixth, i) in (0..6).flat_map(|sixth| (0..ring).map(move |i| (sixth, i))) {
            let [outer, inner] = [sixth * ring + i, sixth * (ring - 1) + i];
            faces.push([vertex(ring, outer), vertex(ring - 1, inner), vertex(ring, outer + 1)]);
            if i + 1 < ring {
                faces.push([vertex(ring, outer + 1), vertex(ring - 1, inner), vertex(ring - 1, inner + 1)]);
            }
        }
    }
    (places, faces)
}

/// Peirce's bending length in metres (Peirce 1930, "The Handle of Cloth as a Measurable Quantity"): from the angle at which the
/// end of a strip hangs that overhangs its support by this number of sticks. Of a cloth of rigidity `B` and weight `w` it is `(B / w)^(1/3)`.
///
/// The strip runs along the weft and hangs down on both sides by twice the `expected` length, so that it is level in the middle.
///
/// # Errors
/// [`StepError`] if material or settings are out of range.
pub fn bending_length(
    material: ClothMaterial,
    settings: BodySettings,
    expected: f32,
    sticks: u32,
) -> Result<f32, StepError> {
    let settings = BodySettings { drag: 8.0, ..settings };
    let (overhang, spacing) = (2.0 * expected, 2.0 * expected / sticks as f32);
    let strip = ClothBuilder::new(2.0 * overhang, 4.0 * spacing, 2 * sticks + 1, 5)
        .placed(Vec3::new(-overhang, 0.0, -2.0 * spacing), Vec3::X, Vec3::Z)
        .material(material)
        .pin_where(|column, _, _| column == sticks);
    let strip = strip.build(settings).map_err(bad)?;
    let mut island = Island::of_body(strip);
    settle(&mut island, &Environment::default(), SETTLING[1])?;
    // In the middle of the free end.
    let end = island.bodies[0].particles.position((3 * (2 * sticks + 1) - 1) as usize);
    Ok(bending_length_of(overhang, end))
}

/// Peirce's bending length in metres of a strip that overhangs its support, which is at the origin, by `overhang` metres along X, and
/// whose end hangs at `end`.
pub fn bending_length_of(overhang: f32, end: Vec3) -> f32 {
    let angle = libm::atan2(f64::from(-end.y), f64::from(end.x));
    overhang * libm::cbrt(libm::cos(0.5 * angle) / (8.0 * libm::tan(angle))) as f32
}

/// Stretch of a curtain of 1 m x 1 m and 21 x 21 particles under its own weight, in parts of its length.
///
/// # Errors
/// [`StepError`] if material or settings are out of range.
pub fn stretch_by_weight(material: ClothMaterial, settings: BodySettings) -> Result<f32, StepError> {
    let settings = BodySettings { drag: 4.0, ..settings };
    let curtain = ClothBuilder::new(1.0, 1.0, 21, 21).material(material).pin_edge(Edge::Top);
    let curtain = curtain.build(settings).map_err(bad)?;
    let mut island = Island::of_body(curtain);
    settle(&mut island, &Environment::default(), SETTLING[1])?;
    // In the middle of the hem: at the sides a curtain draws in.
    let particles = &island.bodies[0].particles;
    Ok(particles.position(10).distance(particles.position(20 * 21 + 10)) - 1.0)
}

fn settle(island: &mut Island, environment: &Environment, seconds: f32) -> Result<(), StepError> {
    let steps = (seconds / environment.dt) as u32;
    (0..steps).try_for_each(|_| step(island, environment))
}

/// Area of the shadow of all faces on the ground in square metres.
fn shadow(island: &Island) -> f32 {
    let body = &island.bodies[0];
    let count = (SIDE / PIXEL) as usize + 20;
    let mut dark = vec![false; count * count];
    let to_grid = |p: Vec3| Vec2::new(p.x, p.z) / PIXEL + 0.5 * count as f32;
    for face in body.topology.faces() {
        let [a, b, c] = face.map(|i| to_grid(body.particles.position(i as usize)));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let sides = |p: Vec2| [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
        for row in low.y.ceil() as usize..=(high.y as usize).min(count - 1) {
            for column in low.x.ceil() as usize..=(high.x as usize).min(count - 1) {
                let sides = sides(Vec2::new(column as f32, row as f32));
                dark[row * count + column] |=
                    sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0);
            }
        }
    }
    dark.into_iter().filter(|&is_dark| is_dark).count() as f32 * PIXEL * PIXEL
}
