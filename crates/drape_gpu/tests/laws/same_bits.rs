//! The same device gives the same bits, run after run, whatever else is in the world.

use drape_gpu::{Gpu, GpuWorld};
use drape_solver::glam::Vec3;
use drape_solver::{Body, BodySettings, ClothBuilder, Edge, Environment, Shape, Turbulence, Wind};

use crate::common::*;

fn stormy() -> Environment {
    let obstacles = vec![
        obstacle(Shape::Sphere { radius: 0.3 }, Vec3::new(0.5, -0.4, 0.3), 0.5),
        obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::NEG_Y, 0.5),
    ];
    let turbulence = Turbulence { speed: 3.0, ..Turbulence::default() };
    let wind = Wind { turbulence, lift_coefficient: 0.7, ..Wind::new(Vec3::new(2.0, 0.0, 4.0)) };
    Environment { obstacles: obstacles.into(), wind, ..gravity() }
}

fn flags() -> Vec<Body> {
    // One in a workgroup, one by tiles, and a mesh too large for either.
    let settings = BodySettings::default();
    let flag = |n| ClothBuilder::new(1.0, 1.0, n, n).pin_edge(Edge::Left).build(settings).expect("valid");
    vec![flag(16), flag(50), mesh(40)]
}

/// A grid whose sticks are listed one by one, as those of a mesh.
fn mesh(n: u32) -> Body {
    let grid =
        ClothBuilder::new(1.0, 1.0, n, n).pin_edge(Edge::Top).build(BodySettings::default()).expect("valid");
    let places: Vec<Vec3> = grid.particles.positions().collect();
    let masses: Vec<f32> = (0..places.len()).map(|i| grid.particles.inverse_mass(i)).collect();
    let topology = &grid.topology;
    let structural = topology.batches().iter().take(4).flat_map(drape_solver::StickBatch::range);
    let sticks: Vec<[u32; 2]> = structural.map(|stick| topology.stick(stick)).collect();
    joined(&places, &masses, &sticks, BodySettings::default())
}

#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn two_runs_give_the_same_bits() {
    for body in flags() {
        let end = |others: usize| {
            let mut world = GpuWorld::new(gpu());
            for _ in 0..others {
                world.add(&level(9, Vec3::Y, BodySettings::default())).expect("a body");
            }
            let id = world.add(&body).expect("a body");
            run(&mut world, &stormy(), 60);
            positions(&world, id)
        };
        let once = end(0);
        assert_eq!(once, end(0), "{} particles", body.particles.len());
        assert_eq!(once, end(3), "{} particles among others", body.particles.len());
    }
}

/// Thousands of bodies are stepped by smaller workgroups than a few: each moves as it does alone.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_crowd_moves_as_each_would_alone() {
    let settings = BodySettings { substeps: 2, ..BodySettings::default() };
    let flag = ClothBuilder::new(1.0, 1.0, 14, 14).pin_edge(Edge::Left).build(settings).expect("valid");
    let (mut alone, one) = world_of(&flag);
    run(&mut alone, &stormy(), 5);
    let mut world = GpuWorld::new(gpu());
    let crowd: Vec<_> = (0..1100).map(|_| world.add(&flag).expect("a body")).collect();
    run(&mut world, &stormy(), 5);
    let expected = positions(&alone, one);
    for id in [crowd[0], crowd[550], crowd[1099]] {
        assert_eq!(positions(&world, id), expected);
    }
}

/// Bodies that come and go in the middle leave the others alone.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn bodies_come_and_go() {
    let bodies = flags();
    let alone: Vec<_> = bodies
        .iter()
        .map(|body| {
            let (mut world, id) = world_of(body);
            run(&mut world, &stormy(), 40);
            positions(&world, id)
        })
        .collect();
    let mut world = GpuWorld::new(gpu());
    let ids: Vec<_> = bodies.iter().map(|body| world.add(body).expect("a body")).collect();
    let mut environment = stormy();
    let mut guests = Vec::new();
    for step in 0..40 {
        if step % 3 == 0 {
            guests.push(
                world
                    .add(&level([9, 20, 45][step / 3 % 3], Vec3::Z * 5.0, BodySettings::default()))
                    .expect("a body"),
            );
        }
        if step % 4 == 3 {
            world.remove(guests.remove(0)).expect("it is there");
        }
        world.step(&environment).expect("a good step");
        environment.time += f64::from(environment.dt);
    }
    assert_eq!(world.len(), bodies.len() + guests.len());
    for (id, alone) in ids.into_iter().zip(alone) {
        assert_eq!(positions(&world, id), alone);
    }
}

/// Positions that were asked for come later, without a wait, and are those of the step after which they were asked for.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn positions_that_were_asked_for_come_later() {
    // A device of its own: another test that waits for a shared one could take what has come for it.
    let gpu = Gpu::open().expect("an adapter");
    let mut world = GpuWorld::new(&gpu);
    let id = world.add(&level(20, Vec3::ZERO, BodySettings::default())).expect("a body");
    assert!(world.request_positions(id).is_err(), "it has not been stepped");
    run(&mut world, &gravity(), 5);
    let now = positions(&world, id);
    let pending = world.request_positions(id).expect("a body");
    run(&mut world, &gravity(), 3);
    gpu.wait().expect("a device");
    assert_eq!(pending.try_take().expect("a device").ok(), Some(now));
}

/// Boxes and speeds of all bodies come later, and are those of the step after which they were asked for.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn statuses_that_were_asked_for_come_later() {
    let gpu = Gpu::open().expect("an adapter");
    let mut world = GpuWorld::new(&gpu);
    assert!(world.request_statuses().is_err(), "there is no body");
    // A large one comes first, but lies behind the small ones in the tables.
    let ids = [40, 8, 20].map(|n| {
        let body = level(n, Vec3::new(n as f32, 5.0, 0.0), BodySettings::default());
        world.add(&body).expect("a body")
    });
    assert!(world.request_statuses().is_err(), "it has not been stepped");
    run(&mut world, &gravity(), 12);
    let now = ids.map(|id| world.read_status(id).expect("a body").expect("stepped"));
    let places = ids.map(|id| positions(&world, id));
    let pending = world.request_statuses().expect("stepped");
    world.remove(ids[1]).expect("a body");
    run(&mut world, &gravity(), 3);
    gpu.wait().expect("a device");
    let statuses = pending.try_take().expect("a device").expect("it has come");
    assert_eq!(statuses, ids.into_iter().zip(now).collect::<Vec<_>>());
    for ((_, status), places) in statuses.iter().zip(places) {
        let low = places.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = places.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        assert!(status.low.distance(low) < 1e-4 && status.high.distance(high) < 1e-4);
        // After 0.2 s of free fall, in air.
        assert!((status.greatest_speed - 1.7).abs() < 0.3, "{} m/s", status.greatest_speed);
    }
}

/// A body that rests stays where it is, and goes on from there, without speed; those beside it notice nothing.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn bodies_that_rest_stay_and_go_on() {
    for n in [8, 40] {
        let body = level(n, Vec3::ZERO, BodySettings::default());
        let alone = || {
            let (mut world, id) = world_of(&body);
            run(&mut world, &gravity(), 10);
            positions(&world, id)
        };
        let mut world = GpuWorld::new(gpu());
        world.keep_last_positions().expect("room");
        let [first, second, third] = [&body; 3].map(|body| world.add(body).expect("a body"));
        run(&mut world, &gravity(), 5);
        let there = positions(&world, second);
        world.set_resting(second, true).expect("a body");
        run(&mut world, &gravity(), 5);
        assert_eq!(positions(&world, second), there, "{n}: it rests");
        assert_eq!(world.read_status(second), Ok(None));
        assert_eq!(
            world.last_step().expect("stepped").particle_count(second),
            Some(n * n),
            "{n}: it is drawn"
        );
        for id in [first, third] {
            assert_eq!(positions(&world, id), alone(), "{n}");
            world.set_resting(id, true).expect("a body");
        }
        world.set_resting(second, false).expect("a body");
        // Were its displacements kept, it would go on twice as fast.
        let slow = Environment { dt: 0.5 * FRAME, ..gravity() };
        run(&mut world, &slow, 1);
        let fallen = centre(&there).y - centre(&positions(&world, second)).y;
        let expected = 0.5 * f64::from(G * slow.dt * slow.dt);
        assert!((fallen / expected - 1.0).abs() < 0.2, "{n}: it fell by {fallen} m instead of {expected}");
        assert_eq!(positions(&world, third), alone(), "{n}");
        world.set_resting(second, true).expect("a body");
        assert!(world.is_resting());
        run(&mut world, &gravity(), 2);
        assert_eq!(positions(&world, first), alone(), "{n}");
    }
    let pinned = ClothBuilder::new(1.0, 1.0, 5, 5).pin(0).build(BodySettings::default()).expect("valid");
    let (mut world, id) = world_of(&pinned);
    world.set_resting(id, true).expect("a body");
    world.set_pin_target(id, 0, Vec3::X).expect("a pin");
    assert!(!world.is_resting(), "it wakes when it is pulled");
    world.set_resting(id, true).expect("a body");
    let added = world.add(&level(4, Vec3::ZERO, BodySettings::default())).expect("a body");
    assert!(!world.is_resting());
    world.remove(added).expect("a body");
    assert!(world.is_resting());
}
