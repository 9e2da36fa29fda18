//! Obstacles: nothing passes, friction obeys Coulomb's law.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    BodySettings, ClothBuilder, Environment, Island, Layers, Obstacle, Placement, Shape, step,
};

use crate::common::*;

/// A sheet that falls onto each shape ends outside of it, at the thickness of the cloth.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn nothing_ends_inside_a_shape() {
    let shapes = [
        Shape::HalfSpace { normal: Vec3::Y },
        Shape::Sphere { radius: 0.4 },
        Shape::Capsule { half_length: 0.3, radius: 0.2 },
        Shape::TaperedCapsule { half_length: 0.4, bottom_radius: 0.3, top_radius: 0.1 },
        Shape::Cuboid { half_extents: Vec3::new(0.4, 0.3, 0.2) },
        Shape::Container { half_extents: Vec3::new(0.6, 1.0, 0.7) },
    ];
    for n in [20, 40] {
        for shape in &shapes {
            let place =
                Placement { translation: Vec3::new(0.5, -0.6, 0.5), rotation: Quat::from_rotation_z(0.4) };
            let place = match shape {
                Shape::HalfSpace { .. } => Placement::at(place.translation),
                // The sheet hangs within it from the start.
                Shape::Container { .. } => Placement::at(Vec3::new(0.5, 0.0, 0.5)),
                _ => place,
            };
            let obstacles = vec![Obstacle::new(shape.clone(), place, 0.5).expect("valid")];
            let environment = Environment { obstacles: obstacles.into(), ..gravity() };
            let settings = BodySettings { substeps: 16, thickness: 0.01, ..BodySettings::default() };
            let (mut world, id) = world_of(&level(n, Vec3::ZERO, settings));
            let mut nearest = f32::INFINITY;
            for _ in 0..10 {
                run(&mut world, &environment, 8);
                let inverse = place.rotation.inverse();
                for position in positions(&world, id) {
                    nearest = nearest.min(distance(shape, inverse * (position - place.translation)));
                }
            }
            assert!(
                (0.008..0.012).contains(&nearest),
                "{n} on {shape:?}: {nearest} m instead of the thickness"
            );
        }
    }
}

/// Distance of a point from the surface, negative inside.
fn distance(shape: &Shape, point: Vec3) -> f32 {
    match *shape {
        Shape::HalfSpace { normal } => normal.dot(point),
        Shape::Sphere { radius } => point.length() - radius,
        Shape::Capsule { half_length, radius } => {
            (point - Vec3::Y * point.y.clamp(-half_length, half_length)).length() - radius
        }
        // The nearest of many balls.
        Shape::TaperedCapsule { half_length, bottom_radius, top_radius } => (0..=1000)
            .map(|i| {
                let part = i as f32 / 1000.0;
                let centre = Vec3::Y * half_length * (2.0 * part - 1.0);
                point.distance(centre) - (bottom_radius + (top_radius - bottom_radius) * part)
            })
            .fold(f32::INFINITY, f32::min),
        Shape::Cuboid { half_extents } => {
            let beyond = point.abs() - half_extents;
            beyond.max(Vec3::ZERO).length() + beyond.max_element().min(0.0)
        }
        Shape::Container { half_extents } => (half_extents - point.abs()).min_element(),
        _ => unreachable!("not in the list"),
    }
}

/// On a slope of angle `a` a sheet stays where `tan a < mu` and else slides with `g (sin a - mu cos a)` (Coulomb 1785).
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn friction_on_a_slope_obeys_coulombs_law() {
    for n in [8, 40] {
        for (angle, is_sliding) in [(0.4_f32, false), (0.6, true)] {
            let slope = Quat::from_rotation_z(-angle);
            let ground = Shape::HalfSpace { normal: slope * Vec3::Y };
            let environment =
                Environment { obstacles: vec![obstacle(ground, Vec3::ZERO, 0.5)].into(), ..gravity() };
            let settings = BodySettings { friction: 0.5, thickness: 0.005, substeps: 8, ..bare() };
            let cloth = ClothBuilder::new(1.0, 1.0, n, n);
            let cloth = cloth
                .placed(slope * (Vec3::Y * 0.005), slope * Vec3::X, Vec3::Z)
                .build(settings)
                .expect("valid");
            let (mut world, id) = world_of(&cloth);
            let start = centre(&positions(&world, id));
            run(&mut world, &environment, 60);
            let slid = (centre(&positions(&world, id)) - start).length() as f32;
            let expected = if is_sliding { 0.5 * G * (angle.sin() - 0.5 * angle.cos()) } else { 0.0 };
            let tolerance = if is_sliding { 0.02 * expected } else { 1e-3 };
            assert!(
                (slid - expected).abs() < tolerance,
                "{n}: slid {slid} m instead of {expected} m at {angle}"
            );
        }
    }
}

/// A board that moves evenly takes a sheet along, and one that moves up lifts it.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_moving_obstacle_takes_a_sheet_along() {
    for n in [10, 40] {
        let board = Shape::Cuboid { half_extents: Vec3::new(2.0, 0.1, 2.0) };
        let mut environment =
            Environment { obstacles: vec![obstacle(board, Vec3::NEG_Y * 0.1, 0.8)].into(), ..gravity() };
        let settings = BodySettings { friction: 0.8, ..BodySettings::default() };
        let (mut world, id) = world_of(&level(n, Vec3::Y * 0.005, settings));
        run(&mut world, &environment, 10);
        let start = centre(&positions(&world, id));
        for step in 1..=60 {
            // It gets going with half of what friction bears.
            let time = step as f32 * FRAME;
            let way = Vec3::new(0.5 * 0.4 * G * time * time, 0.3 * time, 0.0);
            environment.obstacles[0].move_to(Placement::at(way - Vec3::Y * 0.1), FRAME);
            run(&mut world, &environment, 1);
        }
        let moved = centre(&positions(&world, id)) - start;
        assert!((moved.x - 0.2 * f64::from(G)).abs() < 0.03, "{n}: taken along by {moved}");
        assert!((moved.y - 0.3).abs() < 5e-3, "{n}: lifted by {moved}");
    }
}

/// A sheet that starts inside a ball comes out gently: overlap that no motion made gives no speed.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn an_overlap_at_the_start_throws_nothing() {
    for n in [16, 40] {
        let ball = obstacle(Shape::Sphere { radius: 0.3 }, Vec3::new(0.5, 0.02, 0.5), 0.5);
        let environment = Environment { gravity: Vec3::ZERO, obstacles: vec![ball].into(), ..gravity() };
        let (mut world, id) = world_of(&level(n, Vec3::ZERO, swept()));
        let [mut fastest, mut on_processor] = [0.0_f32; 2];
        let mut island = Island::of_body(level(n, Vec3::ZERO, swept()));
        for _ in 0..60 {
            step(&mut island, &environment).expect("a good step");
            on_processor =
                island.bodies[0].particles.velocities().map(Vec3::length).fold(on_processor, f32::max);
            run(&mut world, &environment, 1);
            fastest = fastest.max(world.read_status(id).expect("a body").expect("stepped").greatest_speed);
        }
        let nearest =
            positions(&world, id).iter().map(|p| p.distance(Vec3::new(0.5, 0.02, 0.5))).fold(1.0, f32::min);
        assert!(nearest > 0.3, "{n}: still {nearest} m from the centre");
        // A projection that took out all of it at once would give some 150 m/s.
        assert!(
            fastest < 1.2 * on_processor,
            "{n}: thrown at {fastest} m/s, and by the processor at {on_processor} m/s"
        );
    }
}

/// Layers decide what touches, and of hundreds of obstacles each is found by those near it.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn each_sheet_meets_the_obstacles_of_its_place_and_layer() {
    let mut world = drape_gpu::GpuWorld::new(gpu());
    let mut obstacles = Vec::new();
    let mut bodies = Vec::new();
    for i in 0..300 {
        let place = Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32) * 3.0;
        let shape = Shape::Cuboid { half_extents: Vec3::new(1.2, 0.2, 1.2) };
        let layer = 1 << (i % 2);
        obstacles
            .push(obstacle(shape, place + Vec3::new(0.5, -0.5, 0.5), 0.5).with_layers(Layers::new(layer, 1)));
        let mut body = level(8, place, BodySettings::default());
        // Both sides have a say.
        body.layers = Layers::new(if i % 3 == 0 { 2 } else { 1 }, 1);
        bodies.push(world.add(&body).expect("a body"));
    }
    let environment = Environment { obstacles: obstacles.into(), ..gravity() };
    run(&mut world, &environment, 60);
    for (i, id) in bodies.into_iter().enumerate() {
        let height = centre(&positions(&world, id)).y;
        let is_held = (height + 0.295).abs() < 0.01;
        assert_eq!(is_held, i % 2 == 0 && i % 3 != 0, "sheet {i} at {height} m");
    }
}

/// A ball that flies into a free sheet gives it the momentum that it loses.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_ball_gives_the_momentum_that_it_loses() {
    for n in [20, 40] {
        let (mass, radius) = (0.5_f32, 0.2_f32);
        let still = Environment { gravity: Vec3::ZERO, ..gravity() };
        let settings = BodySettings { drag: 0.0, substeps: 16, ..BodySettings::default() };
        let body = ClothBuilder::new(1.0, 1.0, n, n).build(settings).expect("valid");
        let masses: Vec<f32> =
            (0..body.particles.len()).map(|i| 1.0 / body.particles.inverse_mass(i)).collect();
        let (mut world, id) = world_of(&body);
        let mut place = Vec3::new(0.45, -0.55, -0.5);
        let mut velocity = Vec3::new(0.3, 0.2, 6.0);
        let start = velocity * mass;
        let ball = obstacle(Shape::Sphere { radius }, place, 0.5).reporting_reaction();
        let mut environment = Environment { obstacles: vec![ball].into(), ..still.clone() };
        let mut hits = 0;
        for _ in 0..40 {
            place += velocity * FRAME;
            environment.obstacles[0].move_to(Placement::at(place), FRAME);
            run(&mut world, &environment, 1);
            for reaction in world.read_reactions().expect("a step") {
                assert_eq!(reaction.obstacle, 0);
                velocity += reaction.impulse / mass;
                hits += 1;
            }
        }
        // The momentum of the sheet, in free flight without the ball.
        let [first, second] = [0, 1].map(|_| {
            run(&mut world, &still, 1);
            positions(&world, id)
        });
        let moved =
            second.iter().zip(&first).zip(&masses).map(|((now, before), mass)| (*now - *before) * *mass);
        let sum = moved.sum::<Vec3>() / FRAME + velocity * mass;
        assert!(hits > 3 && velocity.z < 5.5, "{n}: {hits} steps with a hit, {velocity} m/s");
        assert!((sum - start).length() < 1e-3 * start.length(), "{n}: {sum} instead of {start}");
    }
}

/// A sheet that lies on a table presses it down by its weight.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_table_bears_the_weight_of_what_lies_on_it() {
    for n in [12, 40] {
        let table = Shape::Cuboid { half_extents: Vec3::new(1.0, 0.1, 1.0) };
        let table = obstacle(table, Vec3::new(0.3, -0.1, 0.5), 0.5).reporting_reaction();
        let bystander = obstacle(Shape::Sphere { radius: 0.1 }, Vec3::X * 9.0, 0.5);
        let environment = Environment { obstacles: vec![bystander, table].into(), ..gravity() };
        let (mut world, id) = world_of(&level(n, Vec3::Y * 0.005, BodySettings::default()));
        run(&mut world, &environment, 60);
        let [mut impulse, mut moment] = [Vec3::ZERO; 2];
        for _ in 0..30 {
            run(&mut world, &environment, 1);
            for reaction in world.read_reactions().expect("a step") {
                assert_eq!(reaction.obstacle, 1);
                impulse += reaction.impulse;
                moment += reaction.angular_impulse;
            }
        }
        let weight = 0.25 * G * 0.5;
        let down = Vec3::NEG_Y * weight;
        assert!((impulse - down).length() < 0.01 * weight, "{n}: {impulse} instead of {weight} N s");
        // The sheet's middle lies 0.2 m beside that of the table.
        let middle = centre(&positions(&world, id)).as_vec3() - Vec3::new(0.3, -0.1, 0.5);
        let expected = middle.cross(down);
        assert!((moment - expected).length() < 0.01 * weight, "{n}: {moment} instead of {expected}");
    }
}

/// A flat sheet that is thrown at a board does not pass: it finds obstacles as far away as it can come in a step.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_fast_sheet_does_not_pass() {
    for n in [12, 40] {
        let board =
            obstacle(Shape::Cuboid { half_extents: Vec3::new(2.0, 0.2, 2.0) }, Vec3::NEG_Y * 0.2, 0.5);
        let environment = Environment { obstacles: vec![board].into(), ..gravity() };
        for height in [0.3, 0.45, 0.6, 0.75] {
            let mut body = level(n, Vec3::Y * height, BodySettings::default());
            (0..body.particles.len()).for_each(|i| body.particles.set_velocity(i, Vec3::NEG_Y * 30.0));
            let (mut world, id) = world_of(&body);
            run(&mut world, &environment, 5);
            let lowest = positions(&world, id).iter().map(|place| place.y).fold(1.0, f32::min);
            assert!(lowest > 0.004, "{n}, thrown from {height} m: {lowest} m");
        }
    }
}
