//! Measurements of textile laboratories: the drape of a cloth over a disc, and its stretch by its own weight.
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
use crate::error::StepError;
use crate::geometry::pose::Placement;
use crate::geometry::shape::Shape;
use crate::island::Island;
use crate::motion::environment::Environment;
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
    // Strong drag, so that the cloth does not swing.
    let settings = BodySettings { drag: 4.0, thickness: 0.002, ..settings };
    let bad = |source| StepError::BadSettings { body: 0, source };
    let cloth = ClothBuilder::new(SIDE, SIDE, 16, 16)
        .placed(Vec3::new(-0.5 * SIDE, settings.thickness, -0.5 * SIDE), Vec3::X, Vec3::Z)
        .material(material);
    let mut island = Island::of_body(cloth.build(settings).map_err(bad)?);
    let disc = Shape::from_parry(SharedShape::cylinder(0.01, 0.5 * DISC)).map_err(bad)?;
    let place = Placement { translation: Vec3::NEG_Y * 0.01, rotation: Quat::IDENTITY };
    let disc = Obstacle::new(disc, place, 0.5).map_err(bad)?;
    settle(
        &mut island,
        &Environment { obstacles: vec![disc].into(), ..Environment::default() },
        SETTLING[0],
    )?;
    let disc = core::f32::consts::PI * DISC * DISC / 4.0;
    Ok((shadow(&island) - disc) / (SIDE * SIDE - disc))
}

/// Stretch of a curtain of 1 m x 1 m and 21 x 21 particles under its own weight, in parts of its length.
///
/// # Errors
/// [`StepError`] if material or settings are out of range.
pub fn stretch_by_weight(material: ClothMaterial, settings: BodySettings) -> Result<f32, StepError> {
    let settings = BodySettings { drag: 4.0, ..settings };
    let curtain = ClothBuilder::new(1.0, 1.0, 21, 21).material(material).pin_edge(Edge::Top);
    let curtain = curtain.build(settings).map_err(|source| StepError::BadSettings { body: 0, source })?;
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
