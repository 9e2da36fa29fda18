//! Cloth with self-contact against obstacles.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, Placement, SelfContact,
    Shape, step,
};

use crate::common::*;

/// The greatest kinetic energy in joules in a few steps of a slanted sheet that starts below the ground, held there by a pin at a corner.
fn greatest_energy(self_contact: SelfContact) -> f64 {
    let settings = BodySettings { thickness: 0.005, iterations: 4, self_contact, ..BodySettings::default() };
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

/// What the ground lifts and a pin holds below cannot be: sheets are stretched and tremble. Self-contact must not add to that. It gave
/// 3.3 kJ in four steps: truncation and contacts made velocity of what undid the position-only moves of the ground.
#[test]
fn a_pin_below_the_ground_does_not_throw_the_cloth() {
    let [with, without] = [SelfContact::On, SelfContact::Off].map(greatest_energy);
    println!("law: energy of a cloth pinned below the ground: {with} J, without self-contact {without} J");
    assert!(with < 10.0 * without, "{with} J, and {without} J without self-contact");
}

/// A level sheet of 0.4 m around this place, turned about the vertical.
fn level(at: Vec3, turn: f32) -> ClothBuilder {
    let turn = Quat::from_rotation_y(turn);
    let (right, down) = (turn * Vec3::X, turn * Vec3::Z);
    ClothBuilder::new(0.4, 0.4, 11, 11).placed(at - 0.2 * (right + down), right, down)
}

fn built(cloth: ClothBuilder, self_contact: SelfContact) -> Body {
    let settings = BodySettings { thickness: 0.005, self_contact, ..BodySettings::default() };
    cloth.build(settings).expect("valid")
}

/// The greatest kinetic energy in joules in a second among these obstacles, of which the last sinks to a height of `lowest` metres at
/// 1 m/s.
fn greatest_energy_among(bodies: Vec<Body>, obstacles: Vec<Obstacle>, lowest: f32) -> f64 {
    let mut island = Island { bodies, ..Island::default() };
    let mut environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
    let last = environment.obstacles.len() - 1;
    let start = environment.obstacles[last].placement().translation;
    let mut most = 0.0_f64;
    for index in 1..=unless_miri(60, 2) {
        let height = (start.y - index as f32 * FRAME).max(lowest.min(start.y));
        environment.obstacles[last].move_to(Placement::at(Vec3::new(start.x, height, start.z)), FRAME);
        step(&mut island, &environment).expect("a good step");
        most = most.max(kinetic_energy(&island));
    }
    most
}

/// Cloth in places where it cannot be is led out, not thrown, with self-contact as without: six layers between the ground and a plate
/// that leaves a third of the room they need, a sheet with its corners pinned inside a ball, and two sheets that cross inside a ball.
#[test]
fn self_contact_throws_nothing_out_of_places_where_nothing_can_be() {
    let plate = || obstacle(Shape::Cuboid { half_extents: Vec3::new(1.0, 0.1, 1.0) }, Vec3::Y * 0.25, 0.3);
    let ball = || obstacle(Shape::Sphere { radius: 0.4 }, Vec3::Y, 0.3);
    let layers = |contact| {
        let sheets = (0..6).map(|k| level(Vec3::Y * (0.006 + 0.012 * k as f32), 0.3 * k as f32));
        let sheets = sheets.map(|sheet| built(sheet, contact)).collect();
        greatest_energy_among(sheets, vec![Obstacle::ground(), plate()], 0.12)
    };
    let pinned = |contact| {
        let sheet = level(Vec3::Y * 0.95, 0.0).pin(0).pin(10).pin(110).pin(120);
        greatest_energy_among(vec![built(sheet, contact)], vec![ball()], 1.0)
    };
    let crossed = |contact| {
        let sheets = [level(Vec3::Y * 0.9, 0.0), level(Vec3::Y * 0.9, 0.4)];
        let mut sheets = sheets.map(|sheet| built(sheet, contact));
        for i in 0..121 {
            let place = sheets[1].particles.position(i) - Vec3::Y * 0.9;
            sheets[1].particles.set_position(i, Vec3::Y * 0.9 + Quat::from_rotation_x(1.2) * place);
        }
        greatest_energy_among(sheets.into(), vec![ball()], 1.0)
    };
    type Scene<'a> = (&'a str, &'a dyn Fn(SelfContact) -> f64);
    let scenes: [Scene<'_>; 3] = [
        ("squeezed layers", &layers),
        ("a sheet pinned in a ball", &pinned),
        ("crossed sheets in a ball", &crossed),
    ];
    for (name, scene) in scenes {
        let [with, without] = [SelfContact::On, SelfContact::Off].map(scene);
        println!("law: greatest energy of {name}: {with} J, without self-contact {without} J");
        assert!(with < 3.0 * without, "{name}: {with} J, and {without} J without self-contact");
    }
}
