//! Cloth with self-contact against obstacles.

use drape_solver::glam::Vec3;
use drape_solver::{ClothBuilder, ClothMaterial, Environment, Island, Obstacle, SelfContact, SolverSettings};

use crate::common::*;

/// The greatest kinetic energy in joules in a few steps of a slanted sheet that starts below the ground, held there by a pin at a corner.
fn greatest_energy(self_contact: SelfContact) -> f64 {
    let settings =
        SolverSettings { thickness: 0.005, iterations: 4, self_contact, ..SolverSettings::default() };
    let right = Vec3::new(0.2019, -0.8793, 0.4315).normalize();
    let down = Vec3::new(0.842, -0.0693, -0.5351);
    let down = (down - right * right.dot(down)).normalize();
    let material = ClothMaterial { areal_density: 2.0, shear_stiffness: 1.0, ..ClothMaterial::default() };
    let sheet = ClothBuilder::new(0.2, 0.5, 9, 7)
        .placed(Vec3::NEG_Y * 0.43 - 0.5 * (0.2 * right + 0.5 * down), right, down)
        .material(material)
        .pin(0)
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(sheet);
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..weightless(FRAME) };
    let mut most = 0.0_f64;
    run_with(&mut island, &environment, 4.0 * FRAME, |island, _| {
        most = most.max(kinetic_energy(island));
    });
    most
}

/// What the ground lifts and a pin holds below cannot be: sheets are stretched and tremble. Self-contact must not add to that. It does,
/// four hundred times over in four steps, and more later.
#[test]
#[ignore = "a known limit: energy pours in between a pin, an obstacle and self-contact"]
fn a_pin_below_the_ground_does_not_throw_the_cloth() {
    let [with, without] = [SelfContact::On, SelfContact::Off].map(greatest_energy);
    println!("law: energy of a cloth pinned below the ground: {with} J, without self-contact {without} J");
    assert!(with < 10.0 * without, "{with} J, and {without} J without self-contact");
}
