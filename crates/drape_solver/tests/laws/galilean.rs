//! Cloth moves alike at the origin, far from it, and in a moving frame.

use drape_solver::glam::Vec3;
use drape_solver::{Body, BodySettings, ClothBuilder, Edge, Environment, Island, Placement, Shape, Wind};

use crate::common::*;

/// Position and velocity of the scene.
struct Frame {
    name: &'static str,
    origin: Vec3,
    velocity: Vec3,
}

const HOME: Frame = Frame { name: "at home", origin: Vec3::ZERO, velocity: Vec3::ZERO };

const AWAY: [Frame; 3] = [
    Frame { name: "on a train at 50 m/s", origin: Vec3::ZERO, velocity: Vec3::new(30.0, 0.0, 40.0) },
    Frame { name: "1 km from the origin", origin: Vec3::new(600.0, 0.0, -800.0), velocity: Vec3::ZERO },
    Frame {
        name: "on a train 1 km away",
        origin: Vec3::new(600.0, 0.0, -800.0),
        velocity: Vec3::new(0.0, 0.0, 50.0),
    },
];

/// A sheet that is pinned at its upper edge, the wind, and a sphere that hits the sheet.
struct Scene {
    name: &'static str,
    /// Direction from its upper to its lower edge at the start.
    down: Vec3,
    wind: Vec3,
    /// Velocity of a sphere that approaches from behind.
    sphere: Vec3,
    seconds: f32,
}

fn sheet(scene: &Scene, frame: &Frame) -> Body {
    let settings = BodySettings { drag: 0.0, ..BodySettings::default() };
    let sheet = ClothBuilder::new(1.2, 1.0, 25, 21).placed(Vec3::NEG_X * 0.6, Vec3::X, scene.down);
    let mut body = sheet.pin_edge(Edge::Top).build(settings).expect("valid");
    body.particles.translate(frame.origin);
    (0..body.particles.len()).for_each(|i| body.particles.set_velocity(i, frame.velocity));
    body
}

/// The final positions of the particles relative to the frame.
fn after(scene: &Scene, frame: &Frame) -> Vec<Vec3> {
    let mut island = Island::of_body(sheet(scene, frame));
    let at_rest = sheet(scene, &HOME).particles;
    let start = Vec3::new(0.1, -0.7, -0.3);
    let sphere = obstacle(Shape::Sphere { radius: 0.2 }, frame.origin + start, 0.6);
    let wind = if scene.wind == Vec3::ZERO { scene.wind } else { frame.velocity + scene.wind };
    let mut environment =
        Environment { wind: Wind::new(wind), obstacles: vec![sphere].into(), ..gravity(FRAME) };
    let steps = (scene.seconds / FRAME).round() as usize;
    let place = |index: usize| frame.origin + frame.velocity * (index as f32 * FRAME);
    for index in 1..=steps {
        for pin in 0..25 {
            island.bodies[0].particles.set_pin_target(pin, place(index) + at_rest.position(pin));
        }
        let way = start + scene.sphere * (index as f32 * FRAME);
        environment.obstacles[0].move_to(Placement::at(place(index) + way), FRAME);
        drape_solver::step(&mut island, &environment).expect("a good step");
    }
    let body = particles(&island);
    (0..body.len()).map(|i| body.local_position(i) + (body.origin() - place(steps))).collect()
}

/// Galileo 1632: aboard a ship in uniform motion everything moves as on land, if the air moves along. There is no drag here.
/// The remaining difference is the rounding of positions, which grows in a sheet that flutters or slides.
#[test]
fn a_train_and_a_distant_place_leave_the_cloth_as_it_is() {
    let aside = Vec3::new(0.0, -0.8, 0.6);
    let calm =
        Scene { name: "at rest", down: Vec3::NEG_Y, wind: Vec3::ZERO, sphere: Vec3::ZERO, seconds: 2.0 };
    let scenes = [
        (Scene { name: "swinging", down: aside, seconds: 0.5, ..calm }, 1e-3),
        (Scene { name: "in a draught", wind: Vec3::new(1.0, 0.0, 1.5), seconds: 0.9, ..calm }, 1e-3),
        (Scene { name: "pushed by a sphere", sphere: Vec3::Z * 1.2, seconds: 0.2, ..calm }, 1e-3),
        (calm, 5e-5),
    ];
    for (scene, tolerance) in scenes {
        let home = after(&scene, &HOME);
        for frame in AWAY {
            let there = after(&scene, &frame);
            let greatest = home.iter().zip(&there).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max);
            let case = format!("Galilean invariance in m, {}, {}", scene.name, frame.name);
            law_of_error(&case, greatest.into(), tolerance);
        }
    }
}

/// Positions of balls have no local origin. At 1 km the spacing of single precision is 0.06 mm, and a ball may drift by a
/// part of that in each substep.
#[test]
fn a_ball_keeps_its_speed_far_from_the_origin() {
    for (distance, tolerance) in [(1.0, 3e-5), (100.0, 3e-3), (1000.0, 0.03)] {
        let velocity = Vec3::new(-0.4, 2.5, -4.0);
        let mut island = Island::of_ball(ball(smooth(0.1, 1.0), Vec3::splat(distance), velocity));
        island
            .bodies
            .push(Body { settings: BodySettings { substeps: 8, ..bare() }, ..loose(&[Vec3::ZERO], bare()) });
        run(&mut island, &weightless(FRAME), 1.0);
        let error = (island.balls[0].position() - Vec3::splat(distance) - velocity).length();
        law_of_error(&format!("ball's drift in m/s, {distance} m away"), error.into(), tolerance);
    }
}
