//! The drape coefficient, by which textile laboratories measure how stiff a cloth is.

use drape_solver::glam::{Vec2, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{ClothBuilder, ClothMaterial, Environment, Island, Shape, SolverSettings};

use crate::common::*;

/// Side of the cloth, and diameter of the disc that it hangs over, in metres.
const SIDE: f32 = 0.30;
const DISC: f32 = 0.18;

/// Area of the shadow of all faces on the ground in square metres, counted by squares of a millimetre and a half.
fn shadow(island: &Island) -> f32 {
    const SIZE: f32 = 0.0015;
    let body = &island.bodies[0];
    let count = (SIDE / SIZE) as usize + 20;
    let mut dark = vec![false; count * count];
    let to_grid = |p: Vec3| Vec2::new(p.x, p.z) / SIZE + 0.5 * count as f32;
    for face in body.topology.faces() {
        let [a, b, c] = face.map(|i| to_grid(body.particles.position(i as usize)));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let sides = |p: Vec2| [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p - from));
        for row in low.y.ceil() as usize..=high.y as usize {
            for column in low.x.ceil() as usize..=high.x as usize {
                let sides = sides(Vec2::new(column as f32, row as f32));
                dark[row * count + column] |=
                    sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0);
            }
        }
    }
    dark.into_iter().filter(|&is_dark| is_dark).count() as f32 * SIZE * SIZE
}

/// Drape coefficient of a square cloth with bend sticks of this stiffness: the part of the overhang that its shadow covers.
fn drape_coefficient(bend: f32) -> f32 {
    let material = ClothMaterial { bend, ..ClothMaterial::default() };
    let settings = SolverSettings { drag: 4.0, thickness: 0.002, substeps: 16, ..SolverSettings::default() };
    let cloth = ClothBuilder::new(SIDE, SIDE, 16, 16)
        .placed(Vec3::new(-0.5 * SIDE, 0.002, -0.5 * SIDE), Vec3::X, Vec3::Z)
        .material(material)
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(cloth);
    let disc = Shape::from_parry(SharedShape::cylinder(0.01, 0.5 * DISC)).expect("valid");
    let environment =
        Environment { obstacles: vec![obstacle(disc, Vec3::NEG_Y * 0.01, 0.5)].into(), ..gravity(FRAME) };
    run(&mut island, &environment, 2.0);
    let disc = core::f32::consts::PI * DISC * DISC / 4.0;
    (shadow(&island) - disc) / (SIDE * SIDE - disc)
}

/// The stiffer in bending, the more of the overhang stands out (Cusick 1968; here of a square): from limp to board.
#[test]
fn the_drape_coefficient_rises_with_the_stiffness_in_bending() {
    let stiffnesses = [0.0, 0.3, 0.9, 1.0];
    let found = stiffnesses.map(drape_coefficient);
    println!(
        "law: drape coefficients at bend stiffness {stiffnesses:?}: measured {found:.3?}, expected to rise"
    );
    assert!(found.windows(2).all(|pair| pair[1] > pair[0] + 0.01), "{found:?}");
}
