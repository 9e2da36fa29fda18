//! Cloths thrown at each other and at obstacles at random do not pass through themselves or each other, gain no energy, and
//! fly no faster than they were thrown.
//!
//! As many scenes as you like, in release: the scene of a seed is always the same.
//!
//! ```text
//! THROWN=0..10000 cargo test --release -p drape_solver --test laws -- --ignored --nocapture cloths_of_many_seeds
//! ```

use core::ops::Range;
use std::panic::catch_unwind;

use drape_solver::glam::{Quat, Vec3};
use drape_solver::state::crossings::CrossingCounter;
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, SelfContact, Shape, step,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use crate::common::*;
use crate::random::{between, cases};

/// Metres between the middles of the cloths and that of the scene: none touches another when it starts.
const START: f32 = 0.8;

/// Sides from which the cloths come.
const SIDES: [Vec3; 5] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::Z, Vec3::NEG_Z];

/// Steps of a scene: a second.
const STEPS: usize = 60;

/// A particle may fly so much faster than the fastest that was thrown, with what it fell added: a cloth whose middle is
/// stopped cracks its hem like a whip.
const WHIP: f32 = 3.0;

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
            let settings = BodySettings {
                thickness,
                friction,
                self_contact: SelfContact::On,
                ..BodySettings::default()
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

fn fastest(island: &Island) -> f32 {
    let speeds = island.bodies.iter().flat_map(|body| body.particles.velocities().map(Vec3::length));
    speeds.fold(0.0, f32::max)
}

/// Plays a scene for a second. Gives its greatest speed in parts of what the input explains, or what went wrong.
fn play(cloths: Vec<Body>, obstacles: Vec<Obstacle>) -> Result<f32, String> {
    let mut island = Island { bodies: cloths, ..Island::default() };
    let environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
    let mut counter = CrossingCounter::of(island.bodies.iter().map(|body| &*body.topology));
    let (before, thrown) = (energy(&island, &environment), fastest(&island));
    let mut most = 0.0_f32;
    for index in 0..STEPS {
        step(&mut island, &environment).map_err(|error| format!("{error} in step {index}"))?;
        let corners: Vec<_> =
            island.bodies.iter().flat_map(|body| measure::positions(&body.particles)).collect();
        let crossings = counter.count(&corners);
        if crossings > 0 {
            return Err(format!("{crossings} crossings in step {index}"));
        }
        let gain = energy(&island, &environment) - before;
        if gain >= 1e-3 * before.abs() {
            return Err(format!("{gain} J gained of {before} in step {index}"));
        }
        let fallen = G * FRAME * (index + 1) as f32;
        most = most.max(fastest(&island) / (thrown + fallen));
        if most > WHIP {
            return Err(format!("{} m/s after {thrown} m/s in step {index}", fastest(&island)));
        }
    }
    Ok(most)
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn random_cloths_thrown_at_each_other_do_not_cross(cloths in cloths(), obstacles in obstacles()) {
        let played = play(cloths, obstacles);
        prop_assert!(played.is_ok(), "{played:?}");
    }
}

/// The scene of a seed.
fn scene(seed: u64) -> (Vec<Body>, Vec<Obstacle>) {
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed.to_le_bytes(); 4].concat());
    let mut runner = TestRunner::new_with_rng(cases(1), random);
    (cloths(), obstacles()).new_tree(&mut runner).expect("nothing is rejected").current()
}

/// The seeds that `THROWN` names, as `first..end`.
fn seeds() -> Range<u64> {
    let text = std::env::var("THROWN").unwrap_or_else(|_| "0..100".into());
    let (first, end) = text.split_once("..").expect("THROWN=first..end");
    let number = |text: &str| text.parse().expect("a number");
    number(first)..number(end)
}

#[test]
#[ignore = "as many scenes as one likes, see the head of this file"]
fn cloths_of_many_seeds_do_not_cross() {
    let (mut faults, mut most) = (Vec::new(), 0.0_f32);
    for seed in seeds() {
        let played = catch_unwind(|| {
            let (cloths, obstacles) = scene(seed);
            play(cloths, obstacles)
        });
        match played.unwrap_or_else(|_| Err("a panic".into())) {
            Ok(speed) => most = most.max(speed),
            Err(fault) => {
                println!("seed {seed}: {fault}");
                faults.push(seed);
            }
        }
        if seed % 100 == 99 {
            println!("up to seed {seed}: {} faults, at most {most} of the speed thrown", faults.len());
        }
    }
    assert!(faults.is_empty(), "faults in the scenes of {faults:?}");
}

/// Scenes in which cloths lie so crumpled that a face turns over within a step: corners that it then lets through are listed in time.
#[test]
fn cloths_whose_faces_turn_over_do_not_cross_themselves() {
    for seed in [2004, 2646, 4355, 4405, 6864, 9173, 9330, 10_645, 15_218] {
        let (cloths, obstacles) = scene(seed);
        assert_eq!(play(cloths, obstacles).err(), None, "seed {seed}");
    }
}
