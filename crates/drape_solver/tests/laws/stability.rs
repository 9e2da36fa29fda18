//! The order of relaxation gains no energy: a hanging sheet only calms down.

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{BodySettings, ClothBuilder, ClothMaterial, Edge, Environment, Island, StructuralSolve};

use crate::common::*;

struct Trial {
    particles: u32,
    corners: bool,
    substeps: u32,
    iterations: u32,
    tethers: bool,
    violent: bool,
    structural: StructuralSolve,
}

/// Energy gained from step 30 to the end of four seconds, as a part of `m g L`, and the greatest gain in between.
fn gained(trial: &Trial) -> f64 {
    let &Trial { particles: n, corners, substeps, iterations, tethers, violent, structural } = trial;
    let settings =
        BodySettings { substeps, iterations, tethers, structural, drag: 0.0, ..BodySettings::default() };
    let mut island = level_sheet(n, corners, ClothMaterial::default(), settings, violent);
    let environment: Environment = gravity(FRAME);
    let energy = |island: &Island| measure::mechanical_energy(&island.bodies[0], environment.gravity);
    run(&mut island, &environment, 30.0 * FRAME);
    let early = energy(&island);
    let scale = measure::mass(particles(&island)) * f64::from(G);
    run(&mut island, &environment, 3.5);
    (energy(&island) - early) / scale
}

fn check(sizes: &[u32]) {
    for &particles in sizes {
        for corners in [false, true] {
            for (substeps, iterations) in [(1, 1), (1, 2), (4, 1), (4, 2), (16, 1), (16, 2)] {
                for tethers in [true, false] {
                    for (violent, structural) in each_with([false, true], BOTH) {
                        let trial =
                            Trial { particles, corners, substeps, iterations, tethers, violent, structural };
                        let gain = gained(&trial);
                        let what = format!(
                            "{particles} squared, corners {corners}, {substeps} x {iterations}, tethers {tethers}, \
                             violent {violent}, {structural:?}"
                        );
                        println!("{what}: {gain}");
                        assert!(gain <= 1e-3, "gained {gain} m g L: {what}");
                    }
                }
            }
        }
    }
}

/// S11: from rest and from a violent start, on both kinds of pins, the sheet ends with less energy.
#[test]
fn a_hanging_sheet_gains_no_energy() {
    check(&[16, 32]);
}

/// The same for larger sheets; takes minutes.
#[test]
#[ignore = "takes minutes"]
fn a_large_hanging_sheet_gains_no_energy() {
    check(&[64, 128]);
}

/// A curtain in a storm stays finite, and within its length of its pins.
#[test]
fn a_curtain_in_a_storm_stays_within_its_length_of_its_pins() {
    let curtain = ClothBuilder::new(1.0, 1.0, 16, 16).pin_edge(Edge::Top).build(BodySettings::default());
    let mut island = Island::of_body(curtain.expect("valid"));
    let mut environment = gravity(FRAME);
    let mut dice = Dice::new(1);
    for _ in 0..300 {
        environment.wind = drape_solver::Wind::new(dice.vector(60.0));
        run(&mut island, &environment, FRAME);
        for position in particles(&island).positions() {
            let nearest = position - Vec3::X * position.x.clamp(0.0, 1.0);
            assert!(nearest.length() < 1.3, "{position}");
        }
    }
}
