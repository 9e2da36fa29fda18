//! No choice of settings gains energy.

use drape_solver::glam::Vec3;
use drape_solver::{BodySettings, ClothBuilder, Edge, Island, StickProjection, step};

use crate::common::*;

/// Kinetic and potential energy in joules, from the positions of two steps that follow each other.
fn energy(masses: &[f64], before: &[Vec3], after: &[Vec3]) -> f64 {
    let of_one = |((mass, before), after): ((&f64, &Vec3), &Vec3)| {
        let velocity = (*after - *before).as_dvec3() / f64::from(FRAME);
        mass * (0.5 * velocity.length_squared() + f64::from(G) * f64::from(before.midpoint(*after).y))
    };
    masses.iter().zip(before).zip(after).map(of_one).sum()
}

/// A hanging sheet that was torn out of shape by a violent start has no more energy later than after a few steps, whatever the settings, or
/// gains no more than on the processor.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn no_settings_gain_energy() {
    for n in [12, 40] {
        for (substeps, iterations) in [(1, 1), (1, 8), (2, 3), (4, 1), (8, 2), (16, 1)] {
            for projection in [StickProjection::Exact, StickProjection::SquareRootFree] {
                for tethers in [false, true] {
                    let settings = BodySettings {
                        substeps,
                        iterations,
                        projection,
                        tethers,
                        drag: 0.0,
                        ..BodySettings::default()
                    };
                    let cloth = ClothBuilder::new(1.0, 1.0, n, n).pin_edge(Edge::Top);
                    let mut body = cloth.build(settings).expect("valid");
                    for i in 0..body.particles.len() {
                        let way = if i % 2 == 0 { 3.0 } else { -3.0 };
                        body.particles.set_velocity(i, Vec3::new(way, 0.5 * way, 2.0));
                    }
                    let mass = |i| match body.particles.inverse_mass(i) {
                        0.0 => 0.0,
                        inverse => 1.0 / f64::from(inverse),
                    };
                    let masses: Vec<f64> = (0..body.particles.len()).map(mass).collect();
                    let (mut world, id) = world_of(&body);
                    let mut island = Island::of_body(body);
                    // Of the GPU and of the processor.
                    let mut energies_after = |steps: usize| {
                        run(&mut world, &gravity(), steps - 1);
                        (1..steps).for_each(|_| step(&mut island, &gravity()).expect("a good step"));
                        let places = |island: &Island| island.bodies[0].particles.positions().collect();
                        let before: [Vec<Vec3>; 2] = [positions(&world, id), places(&island)];
                        run(&mut world, &gravity(), 1);
                        step(&mut island, &gravity()).expect("a good step");
                        let after = [positions(&world, id), places(&island)];
                        [0, 1].map(|i| energy(&masses, &before[i], &after[i]))
                    };
                    let starts = energies_after(10);
                    let weight = masses.iter().sum::<f64>() * f64::from(G);
                    let mut most = [0.0_f64; 2];
                    for _ in 0..5 {
                        let energies = energies_after(30);
                        // A joule for each newton of weight lifts the sheet by a metre.
                        (0..2).for_each(|i| most[i] = most[i].max((energies[i] - starts[i]) / weight));
                    }
                    // One sweep in a step of 1/60 s leaves a hum, on the processor too.
                    let ways = format!("{n}: {substeps} x {iterations}, {projection:?}, tethers {tethers}");
                    assert!(most[0] < 2e-3 + 1.5 * most[1], "{ways}: it has gained {most:?} m");
                    assert!(most[0] < 0.1, "{ways}: it has gained {most:?} m");
                }
            }
        }
    }
}
