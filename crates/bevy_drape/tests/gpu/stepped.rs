//! Bodies on the GPU do what they do on the processor.

use crate::*;

/// The greatest distance between particles of two bodies.
fn apart(app: &App, [a, b]: [Entity; 2]) -> f32 {
    let places = positions(app, a).into_iter().zip(positions(app, b));
    places.map(|(a, b)| a.distance(b)).fold(0.0, f32::max)
}

#[test]
fn a_cloth_swings_as_on_the_processor() {
    let mut app = app();
    let here = app.world_mut().spawn(swinging()).id();
    let there = spawn(&mut app, swinging());
    run(&mut app, 64);
    assert!(is_on_gpu(&app, there) && !is_on_gpu(&app, here));
    let moved = positions(&app, here)[80].distance(Vec3::new(0.5, -0.5, 0.0));
    assert!(moved > 0.3, "it swings: {moved} m");
    // Rounding differs, and a free cloth amplifies it.
    assert!(apart(&app, [here, there]) < 0.01, "{} m apart", apart(&app, [here, there]));
}

#[test]
fn gravity_and_wind_act() {
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    app.insert_resource(Wind { velocity: Vec3::new(0.0, 0.0, 6.0), ..default() });
    let flag = spawn(&mut app, Cloth::new(1.0, 1.0).with_particles(9, 9).with_pins(ClothPins::Left));
    run(&mut app, 48);
    let places = positions(&app, flag);
    assert!(places[80].z > 0.2, "it blows out, to {}", places[80]);
    app.insert_resource(Wind::default());
    app.insert_resource(DrapeGravity(Vec3::new(0.0, -9.81, 0.0)));
    run(&mut app, 96);
    assert!(positions(&app, flag)[80].y < places[80].y - 0.1, "it falls");
}

/// Once no preset went to the GPU, as all of them damp their sticks.
#[test]
fn settings_and_fabrics_are_those_of_the_components() {
    let mut app = app();
    let parts = || {
        let settings = SolverSettings { substeps: 5, iterations: 1, ..swept() };
        let surface = BodySurface { drag: 3.0, ..default() };
        (
            swinging(),
            Fabric { damping: 0.0, ..Fabric::DENIM },
            settings,
            surface,
            Transform::from_xyz(0.0, 3.0, 0.0),
        )
    };
    let here = app.world_mut().spawn(parts()).id();
    let there = spawn(&mut app, parts());
    let plain = spawn(&mut app, (swinging(), Transform::from_xyz(0.0, 3.0, 0.0)));
    let damped = spawn(&mut app, (swinging(), Fabric::DENIM));
    run(&mut app, 48);
    assert!([there, plain, damped].iter().all(|&body| is_on_gpu(&app, body)));
    assert!(apart(&app, [here, there]) < 0.01, "{} m apart", apart(&app, [here, there]));
    assert!(apart(&app, [plain, there]) > 0.03, "another cloth moves in another way");
}

#[test]
fn a_cloth_meets_obstacles_of_its_layers_only() {
    let mut app = app();
    let lying = |x: f32| Transform::from_xyz(x, 1.5, 0.0).with_rotation(Quat::from_rotation_x(-1.57));
    let cloth = || Cloth::new(0.6, 0.6).with_particles(9, 9).with_pins(ClothPins::None);
    app.world_mut().spawn((Obstacle::ground(), DrapeLayers { memberships: 2, ..default() }));
    let met = spawn(&mut app, (cloth(), lying(0.0), DrapeLayers { memberships: 1, filters: 2 }));
    let passed = spawn(&mut app, (cloth(), lying(3.0), DrapeLayers { memberships: 1, filters: 4 }));
    run(&mut app, 64);
    assert!(is_on_gpu(&app, met) && is_on_gpu(&app, passed));
    let height = |body| positions(&app, body)[40].y;
    assert!(
        (0.0..0.1).contains(&height(met)) && height(passed) < -0.5,
        "{}, {}",
        height(met),
        height(passed)
    );
}

#[test]
fn soft_balls_fall_and_keep_their_size() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let ball = spawn(&mut app, (SoftBall::default(), Transform::from_xyz(0.0, 2.0, 0.0)));
    run(&mut app, 1);
    let size = |app: &App| {
        let places = positions(app, ball);
        places.iter().map(|a| a.x).fold(-9.0, f32::max) - places.iter().map(|a| a.x).fold(9.0, f32::min)
    };
    let before = size(&app);
    run(&mut app, 96);
    assert!(is_on_gpu(&app, ball));
    let lowest = positions(&app, ball).iter().map(|place| place.y).fold(9.0, f32::min);
    assert!((-0.01..0.2).contains(&lowest), "it is on the ground: {lowest}");
    assert!(size(&app) > 0.6 * before, "it is {} m wide instead of {before}", size(&app));
}

/// Obstacles that are far from all bodies of the processor are not read by it.
#[test]
fn obstacles_that_come_from_afar_push() {
    let mut app = app();
    let ball = app.world_mut().spawn((Obstacle::sphere(0.3), Transform::from_xyz(0.0, 0.0, -200.0))).id();
    run(&mut app, 2);
    let curtain = spawn(&mut app, Cloth::new(1.0, 1.0).with_particles(17, 17));
    run(&mut app, 2);
    for z in [-100.0, -3.0, -2.0] {
        app.world_mut().entity_mut(ball).insert(Transform::from_xyz(0.0, 0.0, z));
        run(&mut app, 1);
    }
    for i in 0..60 {
        let place = Transform::from_xyz(0.0, -0.2, -2.0 + 2.0 * i as f32 / 60.0);
        app.world_mut().entity_mut(ball).insert(place);
        run(&mut app, 1);
    }
    let farthest = positions(&app, curtain).into_iter().map(|place| place.z).fold(0.0, f32::max);
    assert!(farthest > 0.2, "the ball pushes it ahead, by {farthest} m");
    let place = Vec3::new(0.0, -0.2, -2.0 + 2.0 * 59.0 / 60.0);
    let nearest = positions(&app, curtain).into_iter().map(|p| p.distance(place)).fold(9.0, f32::min);
    assert!(nearest > 0.295, "it is {nearest} m from the centre of the ball");
}

/// The processor leaves obstacles that move far from all its bodies out of its searches.
#[test]
fn an_obstacle_that_came_before_the_body_carries_it() {
    let mut app = app();
    let ball = app.world_mut().spawn((Obstacle::sphere(0.3), Transform::from_xyz(0.0, 0.0, -200.0))).id();
    run(&mut app, 2);
    app.world_mut().entity_mut(ball).insert(Transform::from_xyz(0.0, 0.5, 0.0));
    run(&mut app, 2);
    let lying = Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(-1.57));
    let cloth = Cloth::new(0.6, 0.6).with_particles(9, 9).with_pins(ClothPins::None);
    let sheet = spawn(&mut app, (cloth, lying));
    run(&mut app, 48);
    let height = positions(&app, sheet)[40].y;
    assert!((0.79..0.83).contains(&height), "its middle lies on the ball: {height}");
    assert!(is_on_gpu(&app, sheet));
}

/// One obstacle without an inside once stopped the steps of all bodies.
#[test]
fn an_obstacle_that_cannot_be_sampled_is_left_out_alone() {
    let mut app = app();
    let plate = app.world_mut().resource_mut::<Assets<Mesh>>().add(Plane3d::default().mesh().size(2.0, 2.0));
    app.world_mut().spawn((Obstacle::trimesh(), Mesh3d(plate), Transform::from_xyz(0.0, 1.0, 0.0)));
    app.world_mut().spawn(Obstacle::ground());
    let lying = Transform::from_xyz(0.0, 1.5, 0.0).with_rotation(Quat::from_rotation_x(-1.57));
    let cloth = Cloth::new(0.6, 0.6).with_particles(9, 9).with_pins(ClothPins::None);
    let sheet = spawn(&mut app, (cloth, lying));
    run(&mut app, 96);
    let height = positions(&app, sheet)[40].y;
    assert!((0.0..0.1).contains(&height), "it fell through the plate to the ground: {height}");
}

#[test]
fn pins_follow_the_entity_and_a_leap_brings_the_first_shape() {
    let mut app = app();
    let curtain = spawn(&mut app, Cloth::new(1.0, 1.0).with_particles(9, 9));
    run(&mut app, 2);
    for i in 1..=32 {
        let place = Transform::from_xyz(i as f32 / 32.0, 0.0, 0.0);
        app.world_mut().entity_mut(curtain).insert(place);
        run(&mut app, 1);
    }
    let places = positions(&app, curtain);
    assert!(places[0].distance(Vec3::new(0.5, 0.5, 0.0)) < 1e-4, "{}", places[0]);
    assert!(places[80].x > 1.0, "the cloth is drawn along: {}", places[80]);
    let there = Vec3::new(500.0, 20.0, 3.0);
    app.world_mut().entity_mut(curtain).insert(Transform::from_translation(there));
    run(&mut app, 1);
    for (index, local) in [(0, Vec3::new(-0.5, 0.5, 0.0)), (80, Vec3::new(0.5, -0.5, 0.0))] {
        let place = positions(&app, curtain)[index];
        assert!(place.distance(there + local) < 0.01, "{index} is at {place}");
    }
}
