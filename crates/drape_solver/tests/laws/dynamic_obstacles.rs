//! Obstacles with a rigid body of their own, and those that another physics engine moves: for all masses, the hit keeps
//! momentum, and energy never rises.

use drape_solver::glam::{BVec3, DVec3, Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    BallMaterial, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, Placement,
    RigidBody, Shape, StructuralSolve, step,
};

use crate::common::*;

/// The one that moves the box between hits.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pilot {
    /// The solver.
    Solver,
    /// Another engine, with four substeps.
    Engine,
    /// The same, with a ground at height 0, on which the box does not bounce.
    EngineWithGround,
}

const PILOTS: [Pilot; 2] = [Pilot::Solver, Pilot::Engine];

/// A box that hits can move, alone with an island.
struct Scene {
    island: Island,
    environment: Environment,
    pilot: Pilot,
}

impl Scene {
    fn new(island: Island, at: Vec3, body: RigidBody, restitution: f32) -> Self {
        let mut environment = weightless(FRAME);
        let shape = Shape::Cuboid { half_extents: Vec3::splat(HALF) };
        let cube = obstacle(shape, at, 0.5).with_restitution(restitution).expect("in range");
        environment.obstacles.push(cube.with_rigid_body(body).reporting_reaction());
        Self { island, environment, pilot: Pilot::Solver }
    }

    fn piloted_by(self, pilot: Pilot) -> Self {
        Self { pilot, ..self }
    }

    fn step(&mut self) {
        let Self { island, environment, pilot } = self;
        let (gravity, dt) = (environment.gravity, environment.dt);
        let cube = &mut environment.obstacles[0];
        match pilot {
            Pilot::Solver => cube.fly(gravity, dt),
            Pilot::Engine | Pilot::EngineWithGround => {
                let (mut body, mut place) = (cube.rigid_body().expect("it has one"), cube.placement());
                for _ in 0..4 {
                    body.accelerate(gravity, dt / 4.0);
                    place = body.advance(place, dt / 4.0);
                    if *pilot == Pilot::EngineWithGround && place.translation.y < HALF {
                        (place.translation.y, body.velocity.y) = (HALF, body.velocity.y.max(0.0));
                    }
                }
                cube.set_rigid_body(Some(body));
                cube.fly_to(place, dt);
            }
        }
        step(island, environment).expect("a good step");
        for moved in &island.moved {
            environment.obstacles[moved.obstacle].land(moved);
        }
    }

    fn obstacle(&self) -> &Obstacle {
        &self.environment.obstacles[0]
    }

    /// Velocity and angular velocity of the box after the last step.
    fn body(&self) -> RigidBody {
        self.obstacle().rigid_body().expect("it has one")
    }

    fn momentum(&self) -> DVec3 {
        momentum(&self.island) + momentum_of(self.body())
    }

    fn angular_momentum(&self) -> DVec3 {
        angular_momentum(&self.island) + angular_momentum_of(self.body(), self.obstacle().placement())
    }

    fn kinetic_energy(&self) -> f64 {
        let placement = self.obstacle().placement();
        kinetic_energy(&self.island) + f64::from(self.body().kinetic_energy(placement))
    }
}

/// A ball hits a box, centrally and off centre, with a hundredth to a hundred times its mass. Momentum is kept to 1e-5,
/// angular momentum to 2 %, and no energy is gained. After a central hit they separate by Newton's law of restitution.
#[test]
fn a_ball_and_a_box_keep_momentum_and_gain_no_energy() {
    const MASS: f32 = 4.0;
    const SPEED: f32 = 12.0;
    for mass in [0.04, 0.4, 4.0, 40.0, 400.0] {
        for off in [0.0, 0.1] {
            for restitution in [0.0, 0.5, 1.0] {
                for (friction, pilot) in each_with([0.0, 0.6], PILOTS) {
                    let what = format!(
                        "{mass} kg, {off} m off, restitution {restitution}, friction {friction}, {pilot:?}"
                    );
                    let material = BallMaterial {
                        radius: 0.1,
                        mass: MASS,
                        friction,
                        restitution,
                        drag: 0.0,
                        ..BallMaterial::default()
                    };
                    let shot = ball(material, Vec3::new(-0.6, off, 0.02), Vec3::X * SPEED);
                    let mut scene = Scene::new(Island::of_ball(shot), Vec3::ZERO, cube(mass), restitution)
                        .piloted_by(pilot);
                    let (linear, angular) = (scene.momentum(), scene.angular_momentum());
                    let start = scene.kinetic_energy();
                    let mut least = start;
                    for index in 0..12 {
                        scene.step();
                        let lost = (scene.momentum() - linear).length() / linear.length();
                        assert!(lost < 1e-5, "{what}: {lost} of the momentum at step {index}");
                        let lost = (scene.angular_momentum() - angular).length();
                        assert!(lost <= 0.02 * angular.length(), "{what}: {lost} of {angular} at {index}");
                        let energy = scene.kinetic_energy();
                        assert!(energy < least + 1e-4 * start, "{what}: {least} to {energy} J at {index}");
                        least = least.min(energy);
                    }
                    if off == 0.0 {
                        let common = f64::from(SPEED * MASS / (mass + MASS));
                        let apart = f64::from(restitution * SPEED);
                        let expected = common + apart * f64::from(MASS / (mass + MASS));
                        let found = f64::from(scene.body().velocity.x);
                        assert!((found / expected - 1.0).abs() < 0.03, "{what}: {found} m/s, not {expected}");
                    }
                }
            }
        }
    }
}

/// A spinning box of a fiftieth to a hundred times the cloth's mass flies into a free cloth off its middle.
#[test]
fn a_box_and_a_free_cloth_keep_momentum_and_gain_no_energy() {
    for mass in [0.004, 0.04, 0.2, 1.0, 20.0] {
        for (thickness, pilot) in each_with([0.0, 0.01], PILOTS) {
            let what = format!("{mass} kg, {thickness} m, {pilot:?}");
            let cloth = free_cloth(thickness);
            let (middle, along, normal) = (centre(&cloth), along(&cloth), normal(&cloth));
            let mut body = flying_cube(mass, -normal * 6.0);
            body.angular_velocity = Vec3::new(1.0, 2.0, -1.0);
            let at = middle + normal * 0.4 + along * 0.15;
            let mut scene = Scene::new(Island::of_body(cloth), at, body, 0.0).piloted_by(pilot);
            let (linear, angular) = (scene.momentum(), scene.angular_momentum());
            let start = scene.kinetic_energy();
            let (mut least, mut most_risen) = (start, 0.0_f64);
            let mut given = 0.0;
            for index in 0..45 {
                scene.step();
                let lost = (scene.momentum() - linear).length() / linear.length();
                assert!(lost < 1e-5, "{what}: {lost} of the momentum at step {index}");
                let lost = (scene.angular_momentum() - angular).length() / angular.length();
                assert!(lost < 0.02, "{what}: {lost} of the angular momentum at {index}");
                let energy = scene.kinetic_energy();
                assert!(energy <= 1.00001 * start, "{what}: {start} to {energy} J at step {index}");
                most_risen = most_risen.max((energy - least) / start);
                least = least.min(energy);
                given += scene.island.reactions.iter().map(|r| r.impulse.length()).sum::<f32>();
            }
            // Sticks give back the energy that they have stored.
            let most = if mass < 0.1 { 0.05 } else { 0.003 };
            assert!(most_risen < most, "{what}: {most_risen} of the energy risen");
            assert!(given > 1.2 * mass.min(0.2), "{what}: it has hit: {given} N s");
        }
    }
}

/// A free cloth flies flat onto a plate of a tenth to ten times its mass, which stops all of it at once. The two go on
/// together, no particle passes, and no energy is gained.
#[test]
fn a_cloth_that_lands_flat_on_a_light_plate_carries_it_along() {
    const SPEED: f32 = 5.0;
    let masses = [(0.02, 4), (0.2, 4), (2.0, 4), (0.02, 1), (0.002, 1)];
    for ((mass, iterations), pilot) in each_with(masses, PILOTS) {
        let mut cloth = free_cloth(0.01);
        cloth.settings.iterations = iterations;
        let count = cloth.particles.len();
        let (middle, normal) = (centre(&cloth), normal(&cloth));
        let velocity = -normal * SPEED;
        (0..count).for_each(|i| cloth.particles.set_velocity(i, velocity));
        let half = Vec3::new(0.6, 0.6, 0.6) - normal.abs() * 0.5;
        let squares = 4.0 * half * half;
        let inertia = (Vec3::splat(squares.element_sum()) - squares) * (mass / 12.0);
        let body = RigidBody::new(mass, inertia).expect("a valid body");
        let mut environment = weightless(FRAME);
        let plate = obstacle(Shape::Cuboid { half_extents: half }, middle - normal * 0.3, 0.5);
        environment.obstacles.push(plate.with_rigid_body(body));
        let mut scene = Scene { island: Island::of_body(cloth), environment, pilot };
        let start = scene.kinetic_energy();
        for index in 0..30 {
            scene.step();
            let energy = scene.kinetic_energy();
            assert!(
                energy <= 1.0001 * start,
                "{mass} kg, {iterations}: {start} to {energy} J at step {index}"
            );
        }
        let weight = 0.2;
        let common = SPEED * weight / (weight + mass);
        let speed = -scene.body().velocity.dot(normal);
        assert!((speed / common - 1.0).abs() < 0.1, "{mass} kg, {iterations}: {speed} m/s, not {common}");
        let surface = scene.obstacle().placement().translation + normal * 0.1;
        for i in 0..count {
            let above = (particles(&scene.island).position(i) - surface).dot(normal);
            assert!(above > -0.01, "{mass} kg: particle {i} is {above} m above");
        }
    }
}

/// A box between two cloths, with few substeps and many: the box passes the push of one cloth on to the other, and momentum
/// is kept. It is also kept if each cloth is an island of its own.
#[test]
fn a_box_between_two_cloths_keeps_the_momentum_of_all_three() {
    let cloth = |z: f32, speed: f32, substeps: u32| {
        let settings = BodySettings { substeps, friction: 0.5, thickness: 0.01, ..bare() };
        let corner = Vec3::new(-0.5, 0.5, z);
        let sheet = ClothBuilder::new(1.0, 1.0, 17, 17).placed(corner, Vec3::X, Vec3::NEG_Y);
        let mut cloth = sheet.build(settings).expect("valid");
        (0..cloth.particles.len()).for_each(|i| cloth.particles.set_velocity(i, Vec3::Z * speed));
        cloth
    };
    for (substeps, are_apart) in [(16, false), (4, false), (16, true)] {
        let what = format!("{substeps} substeps, apart: {are_apart}");
        let mut islands =
            [(-0.3, 8.0), (0.3, -1.0)].map(|(z, speed)| Island::of_body(cloth(z, speed, substeps)));
        if !are_apart {
            let other = islands[1].bodies.remove(0);
            islands[0].bodies.push(other);
        }
        let [first, mut second] = islands;
        let mut scene = Scene::new(first, Vec3::ZERO, flying_cube(1.0, Vec3::Z * 6.0), 0.0);
        let total = |scene: &Scene, second: &Island| scene.momentum() + momentum(second);
        let turning = |scene: &Scene, second: &Island| scene.angular_momentum() + angular_momentum(second);
        let (linear, angular) = (total(&scene, &second), turning(&scene, &second));
        for index in 0..60 {
            scene.environment.obstacles[0].fly(Vec3::ZERO, FRAME);
            for island in [&mut scene.island, &mut second] {
                step(island, &scene.environment).expect("a good step");
            }
            for moved in scene.island.moved.iter().chain(&second.moved) {
                scene.environment.obstacles[0].land(moved);
            }
            let lost = (total(&scene, &second) - linear).length() / linear.length();
            assert!(lost < 1e-5, "{what}: {lost} of the momentum at step {index}");
            let lost = (turning(&scene, &second) - angular).length() / linear.length();
            assert!(lost < 2e-3, "{what}: {lost} m of angular momentum at step {index}");
        }
        let ahead = if are_apart { &second.bodies[0] } else { &scene.island.bodies[1] };
        let pushed = measure::momentum(&ahead.particles) / measure::mass(&ahead.particles);
        assert!(pushed.z > 3.0, "{what}: the cloth ahead goes at {pushed} m/s");
    }
}

/// What another engine has moved and nothing touches ends exactly where the engine has put it, though something is near.
#[test]
fn an_obstacle_that_an_engine_moves_arrives_as_planned_if_nothing_touches_it() {
    let cloth = free_cloth(0.01);
    let at = centre(&cloth) + normal(&cloth) * (HALF + 0.06);
    let mut body = flying_cube(2.0, along(&cloth) * 1.3);
    body.angular_velocity = Vec3::new(0.3, -0.2, 0.5);
    let mut scene = Scene::new(Island::of_body(cloth), at, body, 0.0);
    // It has bounced off something on its way: place and velocity do not fit.
    let there = Placement {
        translation: at + Vec3::new(0.004, -0.003, 0.002),
        rotation: Quat::from_rotation_y(0.07) * Quat::from_rotation_x(0.2),
    };
    let Scene { island, environment, .. } = &mut scene;
    environment.obstacles[0].fly_to(there, FRAME);
    step(island, environment).expect("a good step");
    assert_eq!(environment.obstacles[0].rigid_body(), Some(body));
    let [moved] = island.moved[..] else { panic!("the cloth is near it: {:?}", island.moved) };
    assert!(moved.placement.translation.distance(there.translation) < 1e-6, "{moved:?}");
    assert!(moved.placement.rotation.angle_between(there.rotation) < 1e-3, "{moved:?}");
    assert!(moved.body.velocity.distance(body.velocity) < 1e-4, "{moved:?}");
    assert!(moved.body.angular_velocity.distance(body.angular_velocity) < 1e-4, "{moved:?}");
}

/// A pinned sheet carries the weight of a box that falls on it, from a quarter of its own weight to 25 times that.
/// Light boxes come to rest; heavy ones swing for longer.
#[test]
fn a_trampoline_carries_the_weight_of_a_box() {
    for (mass, pilot) in each_with([0.05, 0.5, 5.0], PILOTS) {
        let lying = ClothBuilder::new(1.0, 1.0, 17, 17).placed(Vec3::new(-0.5, 0.0, -0.5), Vec3::X, Vec3::Z);
        let settings = BodySettings { thickness: 0.01, friction: 0.5, ..BodySettings::default() };
        let mut sheet = lying.build(settings).expect("valid");
        for i in 0..17 * 17 {
            if [0, 16].contains(&(i % 17)) || [0, 16].contains(&(i / 17)) {
                sheet.particles.set_inverse_mass(i, 0.0);
            }
        }
        let at = Vec3::Y * (HALF + 0.05);
        let mut scene = Scene::new(Island::of_body(sheet), at, cube(mass), 0.0).piloted_by(pilot);
        scene.environment.gravity = Vec3::NEG_Y * 9.81;
        let mut given = 0.0;
        for index in 0..600 {
            scene.step();
            if index >= 300 {
                given += scene.island.reactions.iter().map(|r| r.impulse.y).sum::<f32>();
            }
        }
        let what = format!("{mass} kg, {pilot:?}");
        let weight = mass * 9.81 * 300.0 * FRAME;
        assert!((given / weight - 1.0).abs() < 0.03, "{what}: {given} N s carried, not {weight}");
        let speed = scene.body().velocity.length();
        assert!(mass > 1.0 || speed < 0.1, "{what}: {speed} m/s at rest");
    }
}

/// A light net of 1.6 m with a box above it, which falls.
fn box_over_a_net(structural: StructuralSolve, mass: f32, turn: f32, speed: f32, pilot: Pilot) -> Scene {
    let lying = ClothBuilder::new(1.6, 1.6, 17, 17).placed(Vec3::new(-0.8, 0.0, -0.8), Vec3::X, Vec3::Z);
    let material = ClothMaterial { areal_density: 0.1, ..ClothMaterial::default() };
    let net = lying.material(material).pin_where(|column, row, _| column % 16 == 0 || row % 16 == 0);
    let mut body = cube(mass);
    body.velocity = Vec3::NEG_Y * speed;
    let settings = BodySettings { structural, ..BodySettings::default() };
    let island = Island::of_body(net.build(settings).expect("valid"));
    let at = Vec3::new(0.03, 1.8 * HALF + 0.05, 0.02);
    let mut scene = Scene::new(island, at, body, 0.0).piloted_by(pilot);
    let rotation = Quat::from_rotation_x(turn) * Quat::from_rotation_z(0.7 * turn);
    scene.environment.obstacles[0].teleport(Placement { rotation, ..Placement::at(at) });
    scene.environment.gravity = Vec3::NEG_Y * 9.81;
    scene
}

/// A net of 0.256 kg stops a box of up to 400 times its mass, and holds it: it stretches by less than 2 %, and the box does not come back
/// up. Particles alone passed on so little of the pull that boxes of 4 kg went through, and boxes of 100 kg through lines.
#[test]
fn a_light_net_holds_a_heavy_box() {
    // Metres: how far the middle of the net comes down if it stretches by 2 %.
    const MOST_SAG: f32 = 0.161;
    for (mass, pilot) in each_with([1.0, 4.0, 100.0], PILOTS) {
        let falls = [(0.0, 1.0), (0.0, 5.0), (0.3, 1.0)];
        for ((turn, speed), structural) in each_with(falls, BOTH) {
            let mut scene = box_over_a_net(structural, mass, turn, speed, pilot);
            let what = format!("{mass} kg, turned by {turn}, {speed} m/s, {pilot:?}, {structural:?}");
            let (mut given, mut has_fallen) = (0.0, false);
            for index in 0..240 {
                scene.step();
                let particles = &scene.island.bodies[0].particles;
                let lowest = (0..particles.len()).map(|i| particles.position(i).y).fold(0.0, f32::min);
                let height = scene.obstacle().placement().translation.y;
                assert!(lowest > -MOST_SAG, "{what}: the net is at {lowest} in step {index}");
                assert!(height > lowest, "{what}: the box is at {height}, below the net, in step {index}");
                has_fallen |= height < HALF;
                assert!(!has_fallen || height < 1.7 * HALF, "{what}: thrown back to {height}");
                if index >= 180 {
                    given += scene.island.reactions.iter().map(|r| r.impulse.y).sum::<f32>();
                }
            }
            let weight = mass * 9.81;
            assert!((given / weight - 1.0).abs() < 0.03, "{what}: {given} N s carried, not {weight}");
            let body = scene.body();
            assert!(body.velocity.length() < 0.05, "{what}: {} at rest", body.velocity);
            assert!(body.angular_velocity.length() < 0.2, "{what}: {} at rest", body.angular_velocity);
        }
    }
}

/// A net whose pins rise takes the box along: the tethers know the way of their pins.
#[test]
fn a_net_that_rises_lifts_the_box() {
    const SPEED: f32 = 1.0;
    for pilot in PILOTS {
        let mut scene = box_over_a_net(StructuralSolve::default(), 20.0, 0.0, 0.0, pilot);
        let mut height = 0.0;
        for index in 0..180 {
            let particles = &mut scene.island.bodies[0].particles;
            for i in (0..particles.len()).filter(|_| index >= 120) {
                particles.set_pin_target(i, particles.position(i) + Vec3::Y * (SPEED * FRAME));
            }
            scene.step();
            if index == 119 {
                height = scene.obstacle().placement().translation.y;
            }
        }
        let risen = scene.obstacle().placement().translation.y - height;
        assert!((risen - SPEED).abs() < 0.03, "{pilot:?}: it has risen by {risen} m");
    }
}

/// A box above a square metre of cloth, 10 mm thick, that lies on the ground.
fn box_over_a_sheet_on_the_ground(mass: f32, gap: f32, pilot: Pilot) -> Scene {
    let sheet = ClothBuilder::new(1.0, 1.0, 17, 17).placed(Vec3::new(-0.5, 0.01, -0.5), Vec3::X, Vec3::Z);
    let settings = BodySettings { thickness: 0.01, friction: 0.5, ..BodySettings::default() };
    let island = Island::of_body(sheet.build(settings).expect("valid"));
    let mut scene = Scene::new(island, Vec3::Y * (0.02 + HALF + gap), cube(mass), 0.0).piloted_by(pilot);
    let ground = Obstacle::new(Shape::HalfSpace { normal: Vec3::Y }, Placement::default(), 0.5);
    scene.environment.obstacles.push(ground.expect("valid"));
    scene.environment.gravity = Vec3::NEG_Y * 9.81;
    scene
}

/// Cloth between a box and the ground carries the box, however heavy that is: it lies on the cloth, at rest. It sank into the ground,
/// and a heavy one fell through, as each particle took its share of every push and the ground gave it back to the particle alone.
#[test]
fn cloth_on_the_ground_carries_a_box() {
    for (mass, pilot) in each_with([0.05, 0.5, 5.0, 500.0], PILOTS) {
        let mut scene = box_over_a_sheet_on_the_ground(mass, 0.1, pilot);
        let what = format!("{mass} kg, {pilot:?}");
        let mut before = Placement::default();
        for index in 0..120 {
            scene.step();
            let place = scene.obstacle().placement();
            let sunk = 0.02 - (place.translation.y - HALF);
            assert!(sunk < 5e-4, "{what}: sunk by {sunk} m in step {index}");
            if index == 60 {
                before = place;
            }
        }
        let place = scene.obstacle().placement();
        let (moved, turned) =
            (place.translation - before.translation, place.rotation.angle_between(before.rotation));
        assert!(place.translation.y - HALF < 0.0205, "{what}: floats at {}", place.translation.y);
        assert!(moved.length() < 1e-4 && turned < 1e-3, "{what}: moved by {moved} m, turned by {turned}");
    }
}

/// An engine stops a box on the ground beneath cloth that has stopped the box already. It threw the box back up, at a fifth of its speed.
#[test]
fn a_box_does_not_rebound_from_cloth_on_the_ground() {
    for (mass, gap) in [(0.5, 1.0), (5.0, 2.0), (5.0, 2.05), (50.0, 2.1)] {
        let mut scene = box_over_a_sheet_on_the_ground(mass, gap, Pilot::EngineWithGround);
        let (mut fastest, mut falling) = (0.0_f32, 0.0_f32);
        for _ in 0..120 {
            scene.step();
            let speed = scene.body().velocity.y;
            (fastest, falling) = (fastest.max(speed), falling.min(speed));
        }
        assert!(
            falling < -4.0 && fastest < 0.3,
            "{mass} kg from {gap} m: {falling} m/s down, {fastest} m/s up"
        );
    }
}

/// A box slides on cloth on the ground as on the ground: the one pushes on what the other holds fast.
#[test]
fn cloth_on_the_ground_stops_a_box_by_coulombs_law() {
    for (mass, pilot) in each_with([0.05, 5.0], PILOTS) {
        let mut scene = box_over_a_sheet_on_the_ground(mass, 0.0, pilot);
        let mut start = cube(mass);
        start.velocity = Vec3::X * 0.8;
        scene.environment.obstacles[0].set_rigid_body(Some(start));
        (0..60).for_each(|_| scene.step());
        let way = scene.obstacle().placement().translation.x;
        let expected = 0.8 * 0.8 / (2.0 * 0.5 * 9.81);
        assert!(
            (way / expected - 1.0).abs() < 0.1,
            "{mass} kg, {pilot:?}: stopped after {way} m, not {expected}"
        );
    }
}

/// A hit moves a box only along the axes that are not locked, and turns it only about those.
#[test]
fn locked_axes_stay_as_they_are() {
    let material = BallMaterial { radius: 0.1, mass: 1.0, friction: 0.5, ..BallMaterial::default() };
    for pilot in PILOTS {
        let shot = ball(material, Vec3::new(-0.6, 0.1, 0.08), Vec3::new(12.0, 1.0, 0.0));
        let body = cube(1.0).with_locked_axes(BVec3::new(false, true, false), BVec3::new(true, true, false));
        let mut scene = Scene::new(Island::of_ball(shot), Vec3::ZERO, body, 0.5).piloted_by(pilot);
        let start = scene.kinetic_energy();
        for _ in 0..30 {
            scene.step();
            assert!(scene.kinetic_energy() < 1.0001 * start, "{pilot:?}");
        }
        let (velocity, spin) = (scene.body().velocity, scene.body().angular_velocity);
        assert!(velocity.x > 1.0 && velocity.y == 0.0, "{pilot:?}: {velocity}");
        assert!(spin.x == 0.0 && spin.y == 0.0 && spin.z.abs() > 0.1, "{pilot:?}: {spin}");
    }
}
