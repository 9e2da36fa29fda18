//! Hits move dynamic obstacles: momentum is kept over the whole hit, and energy does not rise.

use drape_solver::glam::{DVec3, Vec3};
use drape_solver::state::measure;
use drape_solver::{BallMaterial, Environment, Island, Obstacle, RigidBody, Shape, step};

use crate::common::*;

/// A box that hits can move, alone with an island.
struct Scene {
    island: Island,
    environment: Environment,
    body: RigidBody,
}

impl Scene {
    fn new(island: Island, gravity: Vec3, at: Vec3, mass: f32, velocity: Vec3) -> Self {
        let mut environment = Environment { gravity, ..weightless(FRAME) };
        let shape = Shape::Cuboid { half_extents: Vec3::splat(HALF) };
        environment.obstacles.push(obstacle(shape, at, 0.5).reporting_reaction());
        Self { island, environment, body: flying_cube(mass, velocity) }
    }

    fn step(&mut self) {
        let Self { island, environment, body } = self;
        body.accelerate(environment.gravity, FRAME);
        let next = body.advance(environment.obstacles[0].placement(), FRAME);
        environment.obstacles[0].move_to(next, FRAME);
        step(island, environment).expect("a good step");
        for reaction in &island.reactions {
            body.receive(reaction, next);
        }
    }

    fn momentum(&self) -> DVec3 {
        momentum(&self.island) + momentum_of(self.body)
    }

    fn angular_momentum(&self) -> DVec3 {
        let placement = self.environment.obstacles[0].placement();
        angular_momentum(&self.island) + angular_momentum_of(self.body, placement)
    }

    fn kinetic_energy(&self) -> f64 {
        let placement = self.environment.obstacles[0].placement();
        kinetic_energy(&self.island) + f64::from(self.body.kinetic_energy(placement))
    }
}

/// A spinning box with the cloth's mass to a hundred times that flies into a free cloth off its middle. The hit keeps linear
/// momentum to 1e-5 and angular momentum to 2 %, and kinetic energy never rises.
#[test]
fn a_box_and_a_free_cloth_keep_momentum_and_gain_no_energy() {
    for mass in [0.2, 1.0, 20.0] {
        for thickness in [0.0, 0.01] {
            let cloth = free_cloth(thickness);
            let middle = centre(&cloth);
            let normal = normal(&cloth);
            let at = middle + normal * 0.4 + along(&cloth) * 0.15;
            let mut scene = Scene::new(Island::of_body(cloth), Vec3::ZERO, at, mass, -normal * 6.0);
            scene.body.angular_velocity = Vec3::new(1.0, 2.0, -1.0);
            let (linear, angular) = (scene.momentum(), scene.angular_momentum());
            let start = scene.kinetic_energy();
            let mut least = start;
            let mut given = 0.0;
            for index in 0..45 {
                scene.step();
                let lost = (scene.momentum() - linear).length() / linear.length();
                assert!(lost < 1e-5, "{mass} kg, {thickness} m: {lost} of the momentum at step {index}");
                let lost = (scene.angular_momentum() - angular).length() / angular.length();
                assert!(lost < 0.02, "{mass} kg, {thickness} m: {lost} of the angular momentum at {index}");
                let energy = scene.kinetic_energy();
                let what = format!("{mass} kg, {thickness} m, step {index}");
                assert!(energy <= start, "{what}: {start} to {energy} J");
                // Sticks give back the energy that they have stored.
                assert!(energy < least + 0.01 * start, "{what}: {least} to {energy} J");
                least = least.min(energy);
                given += scene.island.reactions.iter().map(|r| r.impulse.length()).sum::<f32>();
            }
            assert!(given > 0.05, "it has hit: {given} N s");
        }
    }
}

/// A ball hits a box whose effective mass at the contact is its own mass or more: the box gains the momentum that the ball
/// loses, and no energy is gained. Also with slipping spin, and with a bounce.
#[test]
fn a_ball_hands_its_momentum_to_a_box() {
    for (mass, off, friction, spin, restitution) in [
        (4.0, 0.0, 0.0, 0.0, 0.0),
        (6.0, 0.05, 0.6, 0.0, 0.0),
        (40.0, 0.05, 0.6, 0.0, 0.0),
        (40.0, 0.05, 0.6, 50.0, 0.0),
        (40.0, 0.0, 0.0, 0.0, 0.4),
    ] {
        let material = BallMaterial {
            radius: 0.1,
            mass: 4.0,
            friction,
            restitution,
            drag: 0.0,
            ..BallMaterial::default()
        };
        let mut shot = ball(material, Vec3::new(-0.6, off, 0.0), Vec3::X * 12.0);
        shot.set_spin(Vec3::Z * spin);
        let mut scene = Scene::new(Island::of_ball(shot), Vec3::ZERO, Vec3::ZERO, mass, Vec3::ZERO);
        let (linear, angular) = (scene.momentum(), scene.angular_momentum());
        let mut most = scene.kinetic_energy();
        for _ in 0..30 {
            scene.step();
            assert!((scene.momentum() - linear).length() < 1e-5 * linear.length());
            let lost = (scene.angular_momentum() - angular).length();
            assert!(lost < 1e-5, "{mass} kg, {off} m off: {lost} of {angular} N m s");
            assert!(scene.kinetic_energy() < 1.0001 * most, "{mass} kg: {} J", scene.kinetic_energy());
            most = most.min(scene.kinetic_energy());
        }
        // The contact takes the mean restitution, and that of the box is 0.
        let expected = 48.0 * (1.0 + 0.5 * restitution) / (mass + 4.0);
        assert!(scene.body.velocity.x > 0.8 * expected, "{mass} kg: {} m/s", scene.body.velocity.x);
        if spin > 0.0 {
            assert!(scene.body.velocity.y > 0.1, "it was rubbed up: {} m/s", scene.body.velocity.y);
        }
    }
}

/// A cloth meets a box, and both fall freely: only gravity changes their momentum.
#[test]
fn a_cloth_that_falls_on_a_box_changes_no_momentum_of_the_two() {
    let cloth = free_cloth(0.01);
    let down = -normal(&cloth);
    let at = centre(&cloth) + down * 0.5;
    // All fall alike, so the box starts upwards to meet the cloth.
    let mut scene = Scene::new(Island::of_body(cloth), down * G, at, 1.0, -down * 5.0);
    let mass = 1.0 + measure::mass(particles(&scene.island));
    let mut expected = scene.momentum();
    let mut is_hit = false;
    for index in 0..40 {
        scene.step();
        expected += (down * G * FRAME).as_dvec3() * mass;
        is_hit |= !scene.island.reactions.is_empty();
        let error = (scene.momentum() - expected).length();
        assert!(error < 1e-5 * 5.0, "{error} N s at step {index}");
    }
    assert!(is_hit);
}

/// A body presses with its weight on the obstacle under it. An obstacle that does not collect reactions gets none.
#[test]
fn the_ground_feels_the_weight_that_lies_on_it() {
    let material = BallMaterial { mass: 3.0, radius: 0.2, ..BallMaterial::default() };
    for asks in [true, false] {
        let ground = if asks { Obstacle::ground().reporting_reaction() } else { Obstacle::ground() };
        let mut environment = gravity(FRAME);
        environment.obstacles.push(ground);
        let mut island = Island::of_ball(ball(material, Vec3::new(0.0, 0.2, 0.0), Vec3::ZERO));
        run(&mut island, &environment, 1.0);
        if asks {
            let force = island.reactions[0].impulse / FRAME;
            assert!((force - Vec3::NEG_Y * 3.0 * G).length() < 0.01 * 3.0 * G, "{force} N");
        } else {
            assert!(island.reactions.is_empty());
        }
    }
}
