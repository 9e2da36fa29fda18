//! A mirrored scene gives the mirrored result.

use drape_solver::glam::Vec3;
use drape_solver::{BallMaterial, BodySettings, ClothBuilder, Environment, Island, Placement, Shape, Wind};

use crate::common::*;

/// A sheet on two corners in the wind above the ground. A spinning ball hits it, and a moving sphere sweeps it. `mirror` has
/// the signs of components in the mirror.
fn scene(mirror: Vec3, settings: BodySettings) -> (Island, Environment) {
    let sheet = ClothBuilder::new(1.2, 1.0, 25, 21)
        .placed(Vec3::new(-0.61, 1.4, 0.03) * mirror, Vec3::X * mirror, Vec3::NEG_Y * mirror)
        .pin(0)
        .pin(24);
    let mut island = Island::of_body(sheet.build(settings).expect("valid"));
    let material = BallMaterial { radius: 0.12, mass: 0.7, ..BallMaterial::default() };
    let mut shot = ball(material, Vec3::new(0.2, 0.9, 1.0) * mirror, Vec3::new(-0.4, 1.0, -6.0) * mirror);
    // Spin is an axial vector: a mirror keeps the component along its normal and reverses those in its plane.
    shot.set_spin(Vec3::new(2.0, -3.0, 1.0) * mirror * mirror.element_product());
    island.balls.push(shot);
    let mut environment = gravity(FRAME);
    environment.gravity *= mirror;
    environment.wind = Wind::new(Vec3::new(1.5, 0.2, 2.5) * mirror);
    environment.obstacles = vec![
        obstacle(Shape::HalfSpace { normal: Vec3::Y * mirror }, Vec3::ZERO, 0.4),
        obstacle(Shape::Sphere { radius: 0.2 }, Vec3::new(-1.0, 0.9, 0.1) * mirror, 0.6),
    ]
    .into();
    (island, environment)
}

/// Greatest distance of a particle or ball from the mirror image of its twin, over two seconds, in metres.
fn greatest_error(mirror: Vec3, settings: BodySettings) -> f32 {
    let mut scenes = [Vec3::ONE, mirror].map(|mirror| (mirror, scene(mirror, settings)));
    let mut greatest = 0.0_f32;
    for index in 1..=120 {
        for (mirror, (island, environment)) in &mut scenes {
            let way = Vec3::new(1.2 * FRAME * index as f32 - 1.0, 0.9, 0.1) * *mirror;
            environment.obstacles[1].move_to(Placement::at(way), FRAME);
            drape_solver::step(island, environment).expect("a good step");
        }
        let [(_, (one, _)), (_, (other, _))] = &scenes;
        let balls = one.balls[0].position().distance(other.balls[0].position() * mirror);
        let all = particles(one).positions().zip(particles(other).positions());
        greatest = all.map(|(p, q)| p.distance(q * mirror)).fold(greatest.max(balls), f32::max);
    }
    greatest
}

/// Mirrored in any plane, or in a point, the scene gives the mirrored result to the last bit, as rounding does not depend on
/// signs. (Not tested: contacts of faces with corners of obstacles, as parry searches their nearest points along fixed axes,
/// and self-contact.)
#[test]
fn a_mirrored_scene_gives_the_mirrored_result() {
    for structural in BOTH {
        let settings = BodySettings { structural, ..BodySettings::default() };
        let planes = [Vec3::X, Vec3::Y, Vec3::Z].map(|normal| Vec3::ONE - 2.0 * normal);
        for mirror in planes.into_iter().chain([Vec3::NEG_ONE]) {
            let found = greatest_error(mirror, settings);
            let case = format!("mirror symmetry in m, {structural:?}, signs {mirror}");
            law_of_error(&case, found.into(), 0.0);
        }
    }
}
