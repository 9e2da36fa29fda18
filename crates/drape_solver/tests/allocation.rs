//! After a warm-up a step allocates nothing.

use std::alloc::System;

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::math::Pose;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::parry3d::utils::Array2;
use drape_solver::{
    Backstop, Ball, BallMaterial, BendingFriction, BendingRigidity, BodySettings, ClothBuilder,
    ClothMaterial, Edge, Environment, Island, MeshClothBuilder, Obstacle, Placement, PoseDrive, RigidBody,
    SelfContact, Shape, StructuralSolve, Wind, World, step,
};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations in the second half of a shot at a curtain, whole and with a slit, over ground, in a sensor and beside a rotating capsule.
#[test]
fn a_warm_step_allocates_nothing() {
    for structural in [StructuralSolve::Sweeps, StructuralSolve::Lines] {
        for has_slit in [false, true] {
            allocate_nothing(BodySettings { structural, ..BodySettings::default() }, has_slit);
        }
    }
    // All cases are one test, as the count is that of the whole process.
    fold_allocating_nothing();
    meet_shapes_allocating_nothing();
    step_a_world_allocating_nothing();
    follow_a_pose_allocating_nothing();
    bend_allocating_nothing();
}

/// Warms up by the first number of steps or rounds, and asserts that the second number of them allocates nothing.
fn assert_allocates_nothing<Count>(run: &mut impl FnMut(Count), [warm_up, counted]: [Count; 2]) {
    run(warm_up);
    let region = Region::new(ALLOCATOR);
    run(counted);
    let change = region.change();
    assert_eq!((change.allocations, change.reallocations), (0, 0), "{change:?}");
}

/// A grid and a mesh that resist bending, with friction.
fn bend_allocating_nothing() {
    let material = ClothMaterial {
        bending_rigidity: BendingRigidity::isotropic(1e-4),
        bending_friction: BendingFriction::isotropic(1e-4),
        ..ClothMaterial::default()
    };
    let grid = ClothBuilder::new(1.0, 1.0, 24, 24).material(material).pin_edge(Edge::Top);
    let grid = grid.build(BodySettings::default()).expect("valid");
    let places = grid.particles.positions().collect();
    let mesh = MeshClothBuilder::new(places, grid.topology.faces().to_vec()).material(material).pin(0);
    let mesh = mesh.build(BodySettings::default()).expect("valid");
    for body in [grid, mesh] {
        let mut island = Island::of_body(body);
        let environment = Environment::default();
        let mut steps =
            |count: u32| (0..count).for_each(|_| step(&mut island, &environment).expect("a good step"));
        assert_allocates_nothing(&mut steps, [10, 10]);
    }
}

/// A cloth with balls on all shapes with surface queries, so coarse that its faces touch them. Some shapes move, one of them
/// fast.
fn meet_shapes_allocating_nothing() {
    let corners: Vec<Vec3> =
        (0..8).map(|i| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| 0.3 * bit as f32))).collect();
    let hull = SharedShape::convex_hull(&corners).expect("a cube");
    let (vertices, triangles) = hull.as_convex_polyhedron().expect("a hull").to_trimesh();
    let heights = Array2::new(4, 4, (0..16).map(|i| (i * i % 5) as f32 * 0.1).collect());
    let part = SharedShape::cuboid(0.05, 0.2, 0.05);
    let shapes = [
        hull,
        SharedShape::trimesh(vertices, triangles).expect("a box"),
        SharedShape::heightfield(heights, Vec3::new(0.5, 0.5, 0.5)),
        SharedShape::cone(0.2, 0.15),
        SharedShape::compound(vec![(Pose::IDENTITY, part)]),
        SharedShape::cuboid(0.2, 0.2, 0.002),
        SharedShape::capsule_y(0.2, 0.01),
    ];
    let mut obstacles = vec![Obstacle::ground()];
    for (i, shape) in shapes.into_iter().enumerate() {
        let at = Vec3::new((i % 3) as f32 * 0.6 - 0.6, 0.4, (i / 3) as f32 * 0.6 - 0.6);
        let shape = Shape::from_parry(shape).expect("valid");
        obstacles.push(Obstacle::new(shape, Placement::at(at), 0.5).expect("valid"));
    }
    let thrown = Obstacle::new(Shape::Sphere { radius: 0.1 }, Placement::at(Vec3::new(0.3, 1.2, 0.3)), 0.5);
    let body = RigidBody::new(0.5, Vec3::splat(0.002)).expect("valid");
    obstacles.push(thrown.expect("valid").with_rigid_body(body));
    let last = obstacles.len() - 1;
    let cloth = ClothBuilder::new(2.0, 2.0, 16, 16)
        .placed(Vec3::new(-1.0, 0.8, -1.0), Vec3::X, Vec3::Z)
        .build(BodySettings { thickness: 0.01, ..BodySettings::default() })
        .expect("valid");
    let mut island = Island::of_body(cloth);
    for x in [-0.5, 0.0, 0.7] {
        let at = Vec3::new(x, 1.5, 0.05);
        island.balls.push(Ball::new(BallMaterial::default(), at, Vec3::NEG_Y).expect("valid"));
    }
    let dt = 1.0 / 60.0;
    let mut environment = Environment { dt, obstacles: obstacles.into(), ..Environment::default() };
    let mut touches = 0;
    let mut steps = |count: u32| {
        for index in 0..count {
            for i in [2, 4, 6, 7] {
                let Placement { mut translation, .. } = environment.obstacles[i].placement();
                let rise = if i == 6 { 0.1 } else { 0.01 };
                translation.y += if index % 8 < 4 { rise } else { -rise };
                let angle = 0.02 * (4 - (index % 8).abs_diff(4)) as f32;
                let rotation = Quat::from_rotation_y(angle);
                environment.obstacles[i].move_to(Placement { translation, rotation }, dt);
            }
            environment.obstacles[last].fly(environment.gravity, dt);
            step(&mut island, &environment).expect("a good step");
            island.moved.iter().for_each(|moved| environment.obstacles[last].land(moved));
            touches += island.touches.len();
        }
    };
    assert_allocates_nothing(&mut steps, [240, 64]);
    assert!(touches > 0, "the balls must have hit something");
}

/// A world with a row of sleeping curtains. A ball that is put back again and again hits them, and they fall asleep again.
fn step_a_world_allocating_nothing() {
    let mut world = World::new();
    world.add_obstacle(Obstacle::ground());
    world.rules.sleep_time = 0.1;
    for i in 0..4 {
        let curtain = ClothBuilder::new(1.0, 1.0, 9, 9)
            .placed(Vec3::new(3.0 * i as f32, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Top)
            .build(BodySettings { drag: 8.0, ..BodySettings::default() })
            .expect("valid");
        world.add_body(curtain);
    }
    let start = (Vec3::new(0.5, 1.5, -1.0), Vec3::Z * 10.0);
    let ball = world.add_ball(Ball::new(BallMaterial::default(), start.0, start.1).expect("valid"));
    let (mut slept, mut woken) = (0, 0);
    let mut rounds = |count: u32| {
        for round in 0..count {
            let thrown = world.ball_mut(ball).expect("it is there");
            thrown.set_position(start.0 + Vec3::X * (3 * (round % 4)) as f32);
            thrown.set_velocity(start.1);
            for _ in 0..180 {
                world.step().expect("a good step");
                slept += world.events().slept.len();
                woken += world.events().woken.len();
            }
        }
    };
    assert_allocates_nothing(&mut rounds, [8, 4]);
    assert!(slept > 8 && woken > 8, "{slept} fell asleep, {woken} woke");
}

/// A curtain with limits, backstops and drives by a pose that moves.
fn follow_a_pose_allocating_nothing() {
    let mut curtain = ClothBuilder::new(1.0, 1.0, 24, 24)
        .pin_edge(Edge::Top)
        .build(BodySettings::default())
        .expect("valid");
    let rest: Vec<Vec3> = curtain.particles.positions().collect();
    let backstop = Backstop { distance: 0.01, radius: 0.3 };
    let drive = PoseDrive { angular_frequency: 5.0, damping_ratio: 0.5 };
    for (i, &place) in rest.iter().enumerate() {
        curtain.particles.set_motion_limit(i, place, 0.3);
        curtain.particles.set_backstop(i, place, Vec3::Z, backstop).expect("valid");
        curtain.particles.set_pose_drive(i, place, drive).expect("valid");
    }
    let mut island = Island::of_body(curtain);
    let mut steps = |count: usize| {
        for index in 0..count {
            let way = Vec3::new(0.0, 0.0, 0.01 * (8 - (index % 16).abs_diff(8)) as f32);
            for (i, &place) in rest.iter().enumerate() {
                let particles = &mut island.bodies[0].particles;
                particles.set_pin_target(i, place + way);
                particles.set_limit_centre(i, place + way);
                particles.set_backstop_pose(i, place + way, Vec3::Z + way);
                particles.set_drive_place(i, place + way);
            }
            step(&mut island, &Environment::default()).expect("a good step");
        }
    };
    assert_allocates_nothing(&mut steps, [32, 32]);
}

/// A cloth that has folded onto itself.
fn fold_allocating_nothing() {
    let settings = BodySettings { thickness: 0.02, self_contact: SelfContact::On, ..BodySettings::default() };
    let cloth = ClothBuilder::new(0.9, 0.9, 24, 24)
        .placed(Vec3::new(0.0, 1.0, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .build(settings)
        .expect("valid");
    let mut island = Island::of_body(cloth);
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..Environment::default() };
    let mut steps = |count: u32| {
        (0..count).for_each(|_| step(&mut island, &environment).expect("a good step"));
    };
    assert_allocates_nothing(&mut steps, [240, 60]);
    assert!(island.self_contact_counts().pairs > 0, "it must have come near itself");
}

fn allocate_nothing(settings: BodySettings, has_slit: bool) {
    let dt = 1.0 / 60.0;
    let mut curtain = ClothBuilder::new(1.5, 1.5, 24, 24)
        .placed(Vec3::new(-0.75, 1.2, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(settings)
        .expect("valid");
    if has_slit {
        let [near, far] = [-1.0, 1.0].map(|z| [-0.6, -0.3].map(|x| Vec3::new(x, 0.9, z)));
        let blade = [[near[0], near[1], far[1]], [near[0], far[1], far[0]]];
        curtain.cut(&blade).expect("can be cut").expect("opens");
    }
    let mut island = Island::of_body(curtain);
    let shot = |z: f32| Ball::new(BallMaterial::default(), Vec3::new(0.1, 0.8, z), Vec3::NEG_Z * z * 8.0);
    island.balls.push(shot(2.0).expect("valid"));
    island.balls.push(shot(2.5).expect("valid"));
    let capsule = Shape::Capsule { half_length: 0.5, radius: 0.2 };
    let capsule = Obstacle::new(capsule, Placement::at(Vec3::new(0.0, 0.3, -0.3)), 0.5).expect("valid");
    let sensor = Shape::Parry(SharedShape::cone(1.0, 1.0));
    let sensor = Obstacle::new(sensor, Placement::at(Vec3::Y), 0.5).expect("valid").as_sensor();
    island.bodies[0].reports_contacts = true;
    island.balls[0].set_reports_contacts(true);
    let mut environment = Environment {
        dt,
        wind: Wind::new(Vec3::Z),
        obstacles: vec![Obstacle::ground(), capsule, sensor].into(),
        ..Environment::default()
    };
    let (mut touches, mut contacts) = (0, 0);
    let mut passed = 0;
    let mut steps = |count: usize| {
        for index in passed..passed + count {
            let rotation = Quat::from_rotation_z(0.02 * index as f32);
            let placement = environment.obstacles[1].placement();
            environment.obstacles[1].move_to(Placement { rotation, ..placement }, dt);
            island.bodies[0].particles.add_force(300, Vec3::X);
            island.bodies[0].particles.set_pin_target(0, Vec3::new(-0.75, 1.2, 0.001 * (index % 7) as f32));
            step(&mut island, &environment).expect("a good step");
            touches += island.touches.len();
            contacts += island.contacts.len();
        }
        // The capsule turns on: a jump would be its first fast turn.
        passed += count;
    };
    // The hit is in the first seconds: then every list has reached its greatest length.
    assert_allocates_nothing(&mut steps, [240, 120]);
    assert!(touches > 10, "the balls must have hit something");
    assert!(contacts > 400, "the sensor must have told of the curtain: {contacts}");
}
