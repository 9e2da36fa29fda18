//! Cloths thrown at each other and at obstacles at random do not pass through themselves or each other, and gain no energy.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, SelfContact, Shape, SolverSettings,
};
use proptest::prelude::*;

use crate::common::*;
use crate::random::{between, cases};

/// Metres between the middles of the cloths and that of the scene: none touches another when it starts.
const START: f32 = 0.8;

/// Sides from which the cloths come.
const SIDES: [Vec3; 5] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::Z, Vec3::NEG_Z];

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(between(-1.0, 1.0)).prop_map(Vec3::from_array)
}

/// A cloth that flies to the middle from this side.
fn thrown(side: Vec3) -> impl Strategy<Value = Body> {
    let size = || (between(0.25, 0.5), 6_u32..14);
    let motion = (between(1.0, 15.0), vector(), vector());
    let surface = (between(0.002, 0.008), between(0.0, 1.0), between(0.0, 0.5));
    (size(), size(), motion, surface).prop_map(
        move |(
            (width, columns),
            (height, rows),
            (speed, turn, aside),
            (thickness, friction, bend_stiffness),
        )| {
            let settings = SolverSettings {
                thickness,
                friction,
                self_contact: SelfContact::On,
                ..SolverSettings::default()
            };
            let turn = Quat::from_scaled_axis(3.0 * turn);
            let (right, down) = (turn * Vec3::X, turn * Vec3::NEG_Y);
            let corner = START * side - 0.5 * (width * right + height * down);
            let mut cloth = ClothBuilder::new(width, height, columns, rows)
                .placed(corner, right, down)
                .material(ClothMaterial { bend_stiffness, damping: 0.0, ..ClothMaterial::default() })
                .build(settings)
                .expect("valid");
            for i in 0..cloth.particles.len() {
                cloth.particles.set_velocity(i, 0.2 * speed * aside - speed * side);
            }
            cloth
        },
    )
}

fn cloths() -> impl Strategy<Value = Vec<Body>> {
    (2_usize..=SIDES.len(), SIDES.map(thrown))
        .prop_map(|(count, cloths)| cloths.into_iter().take(count).collect())
}

/// Nothing, or a ground below, and a ball or a box in the middle.
fn obstacles() -> impl Strategy<Value = Vec<Obstacle>> {
    (0..2, 0_usize..3, between(0.05, 0.2)).prop_map(|(grounds, solids, size)| {
        let ground = (grounds > 0)
            .then(|| obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::new(0.0, -0.6, 0.0), 0.5));
        let solid = [
            None,
            Some(Shape::Sphere { radius: size }),
            Some(Shape::Cuboid { half_extents: Vec3::splat(size) }),
        ];
        let solid = solid[solids].clone().map(|shape| obstacle(shape, Vec3::ZERO, 0.3));
        ground.into_iter().chain(solid).collect()
    })
}

fn energy(island: &Island, environment: &Environment) -> f64 {
    let bodies =
        island.bodies.iter().map(|body| measure::potential_energy(&body.particles, environment.gravity));
    kinetic_energy(island) + bodies.sum::<f64>()
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn random_cloths_thrown_at_each_other_do_not_cross(cloths in cloths(), obstacles in obstacles()) {
        let mut island = Island { bodies: cloths, ..Island::default() };
        let environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
        let before = energy(&island, &environment);
        for index in 0..60 {
            run(&mut island, &environment, FRAME);
            prop_assert_eq!(crossings(&island), 0, "in step {}", index);
            let gain = energy(&island, &environment) - before;
            prop_assert!(gain < 1e-3 * before.abs(), "{} J gained of {} in step {}", gain, before, index);
        }
    }
}
