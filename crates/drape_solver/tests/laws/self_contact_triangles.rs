//! Cloth and ropes against themselves and each other, by faces and edges.

use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::step::{accumulate_forces, begin, detect_collisions, finish, substep};
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Edge, Environment, Island, Obstacle, Quality,
    RopeBuilder, SelfContact, Shape, StateHasher, step,
};

use crate::common::*;

fn settings(thickness: f32) -> BodySettings {
    BodySettings { thickness, self_contact: SelfContact::On, ..BodySettings::default() }
}

fn silk() -> ClothMaterial {
    ClothMaterial { bend_stiffness: 0.05, ..ClothMaterial::default() }
}

/// A thin cloth that is dropped on its edge lies down in layers, and none passes through another.
#[test]
fn a_thin_cloth_dropped_on_its_edge_folds_in_layers() {
    let thickness = 0.008;
    let sheet = ClothBuilder::new(0.8, 0.8, 17, 17)
        .placed(Vec3::new(-0.4, 0.85, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .material(silk())
        .build(settings(thickness))
        .expect("valid");
    let rest: Vec<Vec3> = sheet.particles.positions().collect();
    let mut island = Island::of_body(sheet);
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    let (mut fastest, mut crossed) = (0.0_f32, 0);
    run_with(&mut island, &environment, 5.0, |island, index| {
        fastest = fastest.max(greatest_speed(island));
        if index % 10 == 0 {
            crossed += crossings(island);
        }
    });
    let now: Vec<Vec3> = particles(&island).positions().collect();
    let pairs = (0..now.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let apart =
        pairs.filter(|&(a, b)| rest[a].distance(rest[b]) > 0.06).map(|(a, b)| now[a].distance(now[b]));
    let least = apart.fold(f32::INFINITY, f32::min) / (2.0 * thickness);
    let high = now.iter().map(|p| p.y).fold(0.0, f32::max);
    println!(
        "{crossed} crossings, {least} of the distance, {high} m high, at most {fastest} m/s, at last {}",
        greatest_speed(&island)
    );
    assert_eq!(crossed + crossings(&island), 0);
    assert!(least > 0.9, "{least} of the distance is left between layers");
    assert!(fastest < 8.0, "{fastest} m/s");
    assert!(high < 0.3, "it must have fallen over itself, but is {high} m high");
}

/// A towel is twisted by two turns at each end, and held: no layer passes through another.
#[test]
fn a_twisted_towel_holds() {
    let (columns, rows) = (9, 33);
    let (width, length) = (0.3, 1.2);
    let towel = ClothBuilder::new(width, length, columns, rows)
        .placed(Vec3::new(-0.5 * width, 0.0, 0.0), Vec3::X, Vec3::Z)
        .material(silk())
        .pin_edge(Edge::Top)
        .pin_edge(Edge::Bottom)
        .build(settings(0.006))
        .expect("valid");
    let start: Vec<Vec3> = towel.particles.positions().collect();
    let mut island = Island::of_body(towel);
    let environment = gravity(FRAME);
    let (mut crossed, mut most) = (0, 0.0_f64);
    let twist_steps = 240;
    for index in 1..=300 {
        let part = (index as f32 / twist_steps as f32).min(1.0);
        let angle = part * 2.0 * core::f32::consts::TAU;
        for (i, &from) in start.iter().enumerate() {
            if island.bodies[0].particles.is_pinned(i) {
                let side = if from.z < 0.5 * length { 1.0 } else { -1.0 };
                let turned = Quat::from_rotation_z(side * angle) * Vec3::new(from.x, from.y, 0.0);
                let along = from.z + side * 0.12 * length * part;
                island.bodies[0].particles.set_pin_target(i, turned + Vec3::Z * along);
            }
        }
        run(&mut island, &environment, FRAME);
        most = most.max(kinetic_energy(&island));
        if index % 10 == 0 {
            crossed = crossed.max(crossings(&island));
        }
    }
    let last = kinetic_energy(&island);
    println!("at most {crossed} crossings, {most} J, at last {last} J, {:?}", stretch(&island));
    assert_eq!(crossed, 0);
    assert!(most < 1.0, "{most} J");
    assert!(last < 0.02, "{last} J are left of {most} J a second after");
}

/// Two free sheets are shot at each other at 100 m/s: they stop each other, and do not pass.
#[test]
fn free_sheets_shot_at_each_other_do_not_pass() {
    let shot = |self_contact, thickness, turn: f32| {
        let settings = BodySettings { self_contact, drag: 0.0, ..settings(thickness) };
        let sheet = |at: f32, velocity: f32, turn: Quat| {
            let (right, down) = (turn * Vec3::X, turn * Vec3::Y);
            let builder = ClothBuilder::new(0.6, 0.6, 13, 13);
            let origin = Vec3::Z * at - (right + down) * 0.3;
            let mut body = builder.placed(origin, right, down).build(settings).expect("valid");
            (0..body.particles.len()).for_each(|i| body.particles.set_velocity(i, Vec3::Z * velocity));
            body
        };
        let bodies = vec![sheet(-1.0, 50.0, Quat::IDENTITY), sheet(1.0, -50.0, Quat::from_rotation_z(turn))];
        let mut island = Island { bodies, ..Island::default() };
        let (mut crossed, mut most) = (0, 0.0_f64);
        let before = kinetic_energy(&island);
        run_with(&mut island, &weightless(FRAME), 0.5, |island, _| {
            crossed = crossed.max(crossings(island));
            most = most.max(kinetic_energy(island));
        });
        let middle = |body: &Body| body.particles.positions().map(|p| p.z).sum::<f32>() / 169.0;
        println!(
            "{self_contact:?} {thickness} {turn}: {crossed} crossings, {before} J, at most {most} J, momentum {}",
            momentum(&island).length()
        );
        assert!(most < 1.001 * before, "{most} J from {before} J");
        (crossings(&island), middle(&island.bodies[0]) < middle(&island.bodies[1]))
    };
    for turn in [0.0, 0.3, 0.7] {
        for thickness in [0.004, 0.01] {
            assert_eq!(shot(SelfContact::On, thickness, turn), (0, true), "{thickness} m, {turn}");
        }
    }
    assert!(!shot(SelfContact::Off, 0.004, 0.3).1, "without contact they pass");
}

/// A corner of one sheet is stuck through another when the scene begins. It comes free, and nothing is thrown.
#[test]
fn layers_that_cross_come_apart() {
    let sheet = |origin: Vec3, right: Vec3, down: Vec3| {
        ClothBuilder::new(0.6, 0.6, 13, 13).placed(origin, right, down).material(silk())
    };
    let lower = sheet(Vec3::new(-0.3, 0.0, -0.3), Vec3::X, Vec3::Z).build(settings(0.005)).expect("valid");
    let slant = Vec3::new(0.7, 0.5, 0.1).normalize();
    let across = slant.cross(Vec3::new(0.1, 0.6, -0.7)).normalize();
    let upper = sheet(Vec3::new(0.02, -0.08, 0.03), slant, across.cross(slant).normalize());
    let mut island =
        Island { bodies: vec![lower, upper.build(settings(0.005)).expect("valid")], ..Island::default() };
    let before = crossings(&island);
    let mut fastest = 0.0_f32;
    let mut counts = vec![];
    run_with(&mut island, &weightless(FRAME), 3.0, |island, index| {
        let speeds = island.bodies.iter().flat_map(|body| body.particles.velocities().map(Vec3::length));
        fastest = speeds.fold(fastest, f32::max);
        if index % 20 == 0 {
            counts.push(crossings(island));
        }
    });
    println!("{before} crossings at first, then {counts:?}, at most {fastest} m/s");
    assert!(before > 3, "{before}");
    assert_eq!(crossings(&island), 0, "{counts:?}");
    assert!(fastest < 3.0, "{fastest} m/s");
}

/// A rope falls across another whose particles are farther apart than its thickness, and is caught between two of them.
#[test]
fn a_rope_does_not_fall_through_a_rope() {
    let lowest = |self_contact| {
        let settings = BodySettings { self_contact, friction: 0.8, ..settings(0.01) };
        let held = RopeBuilder::new(Vec3::new(-0.55, 0.0, 0.03), Vec3::new(0.55, 0.0, 0.03), 12)
            .pin_start()
            .pin_end()
            .build(settings)
            .expect("valid");
        let falling = RopeBuilder::new(Vec3::new(0.02, 0.2, -0.5), Vec3::new(0.02, 0.2, 0.55), 12)
            .build(settings)
            .expect("valid");
        let mut island = Island { bodies: vec![held, falling], ..Island::default() };
        run(&mut island, &gravity(FRAME), 2.0);
        island.bodies[1].particles.positions().map(|p| p.y).fold(f32::NEG_INFINITY, f32::max)
    };
    let [with, without] = [SelfContact::On, SelfContact::Off].map(lowest);
    println!("the highest particle is at {with} m with contact, {without} m without");
    assert!(without < -5.0);
    assert!(with > -0.5, "{with} m");
}

/// A sheet that lies on another keeps the sum of the two thicknesses from it.
#[test]
fn a_sheet_lies_on_another_at_the_sum_of_their_thicknesses() {
    let sheet = |count: u32, at: Vec3| {
        let size = 0.04 * (count - 1) as f32;
        ClothBuilder::new(size, size, count, count).placed(at, Vec3::X, Vec3::Z)
    };
    let lower = sheet(17, Vec3::ZERO).pin_where(|_, _, _| true).build(settings(0.02)).expect("valid");
    // A third of a spacing out of line.
    let upper = sheet(9, Vec3::new(0.173, 0.045, 0.173)).build(settings(0.02)).expect("valid");
    let mut island = Island { bodies: vec![lower, upper], ..Island::default() };
    run(&mut island, &gravity(FRAME), 0.4);
    let heights = island.bodies[1].particles.positions().map(|p| f64::from(p.y));
    law("distance of two layers in m", heights.sum::<f64>() / 81.0, 0.04, 6e-4);
}

/// A pinned sheet moves into one that is pinned at three corners, right beside the line between two of them. The push came
/// on the fourth corner alone, with a leverage of fifty: it flew off at thousands of metres a second.
#[test]
fn a_push_beside_pinned_corners_does_not_throw_the_free_one() {
    let sheet = |at: Vec3| ClothBuilder::new(1.0, 1.0, 2, 2).placed(at, Vec3::X, Vec3::Z);
    let held = sheet(Vec3::ZERO).pin_where(|column, row, _| column + row < 2).build(settings(0.005));
    let carried = sheet(Vec3::new(-0.48, 0.05, -0.46)).pin_where(|_, _, _| true).build(settings(0.005));
    let mut island =
        Island { bodies: [held, carried].map(|body| body.expect("valid")).into(), ..Island::default() };
    let mut fastest = 0.0_f32;
    for _ in 0..30 {
        let carried = &mut island.bodies[1].particles;
        for pin in 0..4 {
            carried.set_pin_target(pin, carried.position(pin) - Vec3::Y * FRAME);
        }
        run(&mut island, &weightless(FRAME), FRAME);
        fastest = island.bodies[0].particles.velocities().map(Vec3::length).fold(fastest, f32::max);
    }
    println!("at most {fastest} m/s");
    assert!(fastest > 0.1, "it is pushed: {fastest} m/s");
    assert!(fastest < 10.0, "{fastest} m/s");
}

/// A rope in a loose overhand knot, with a weight of `load` kilograms at its end: the polynomial trefoil of Shastri 1992
/// ("Polynomial representations of knots"), with particles at even distances.
fn knotted(settings: BodySettings, load: f32) -> Island {
    let curve =
        |t: f64| DVec3::new(t.powi(3) - 3.0 * t, t.powi(4) - 4.0 * t * t, 0.25 * (t.powi(5) - 10.0 * t));
    let fine: Vec<DVec3> = (-2400..=2400).map(|i| curve(f64::from(i) * 1e-3)).collect();
    let mut ways = vec![0.0];
    for pair in fine.windows(2) {
        ways.push(ways[ways.len() - 1] + pair[0].distance(pair[1]));
    }
    let scale = ROPE_LENGTH / ways[ways.len() - 1];
    let place = |part: f64| {
        let i = ways.partition_point(|way| way * scale < part * ROPE_LENGTH).min(fine.len() - 1);
        (fine[i] * scale).as_vec3()
    };
    let straight = RopeBuilder::new(Vec3::ZERO, Vec3::NEG_Y * ROPE_LENGTH as f32, 121).pin_start();
    let mut rope = straight.build(settings).expect("valid");
    for i in 0..121 {
        // The knot's ends lie apart along Z, which becomes down.
        let [x, y, z] = place(i as f64 / 120.0).to_array();
        rope.particles.set_position(i, Vec3::new(x, -z, y));
    }
    rope.particles.set_inverse_mass(120, 1.0 / load);
    Island::of_body(rope)
}

/// Length of the rope in metres.
const ROPE_LENGTH: f64 = 2.4;

/// Length of the rope that the knot takes up in metres after so many seconds.
fn taken_up(settings: BodySettings, load: f32, seconds: f32) -> f64 {
    let mut island = knotted(settings, load);
    let mut fastest = 0.0_f32;
    run_with(&mut island, &gravity(FRAME), seconds, |island, _| {
        fastest = fastest.max(greatest_speed(island));
    });
    let apart = particles(&island).position(0).distance(particles(&island).position(120));
    let BodySettings { thickness, self_contact, .. } = settings;
    println!(
        "{self_contact:?}, {thickness} m, {load} kg: the ends are {apart} m apart, stretch {:?}, at most {fastest} m/s",
        stretch(&island)
    );
    // The rope is as long as its weight has stretched it.
    let place = |i: usize| particles(&island).position(i).as_dvec3();
    let length: f64 = (0..120).map(|i| place(i).distance(place(i + 1))).sum();
    length - f64::from(apart)
}

/// A knot draws tight and holds by self-contact alone. Without it the rope passes through itself and hangs straight.
#[test]
fn a_knot_holds() {
    let settings = BodySettings { friction: 0.3, substeps: 16, ..settings(0.006) };
    let with = taken_up(settings, 0.2, 5.0);
    let without = taken_up(BodySettings { self_contact: SelfContact::Off, ..settings }, 0.2, 10.0);
    assert!(without < 1e-3, "{without} m");
    // About ten diameters.
    assert!(with > 0.1 && with < 0.5 * ROPE_LENGTH, "{with} m");
}

/// Self-contact of ropes once ran only once in a substep, after all iterations. Knots then opened under twice the rope's own
/// weight, or in a thick rope, and strands passed through each other at 20 m/s and more.
#[test]
fn knots_hold_in_thin_and_thick_ropes_under_twice_their_weight() {
    let many = |substeps| BodySettings { substeps, iterations: 4, ..BodySettings::default() };
    for accuracy in [many(12), many(16), Quality::High.into()] {
        for thickness in [0.006, 0.012, 0.022] {
            let settings =
                BodySettings { friction: 0.3, thickness, self_contact: SelfContact::On, ..accuracy };
            // The rope itself weighs 0.24 kg.
            for load in [0.02, 0.5] {
                let knot = taken_up(settings, load, 5.0);
                assert!(knot > 16.0 * f64::from(thickness) && knot < 0.5 * ROPE_LENGTH, "{knot} m");
            }
        }
    }
}

/// A sheet whose ends are turned against each other by more than a turn, and stay apart: its rims would have to stretch by more than
/// sticks let them, and pushes alone cannot keep its folds apart.
#[test]
fn a_sheet_that_is_wrung_too_far_does_not_pass_through_itself() {
    const TURNS: f32 = 1.25;
    const SECONDS: f32 = 0.75;
    let sheet = ClothBuilder::new(0.5, 0.5, 14, 14).pin_edge(Edge::Left).pin_edge(Edge::Right);
    let mut island = Island::of_body(sheet.build(settings(0.005)).expect("valid"));
    let places: Vec<Vec3> = island.bodies[0].particles.positions().collect();
    let centre = places.iter().sum::<Vec3>() / places.len() as f32;
    let mut truncated = 0;
    for step in 1..=(SECONDS / FRAME) as usize {
        let angle = core::f32::consts::PI * TURNS * (step as f32 * FRAME / SECONDS);
        let particles = &mut island.bodies[0].particles;
        for i in (0..14).flat_map(|row| [row * 14, row * 14 + 13]) {
            let way = places[i] - centre;
            let turn = Quat::from_rotation_x(angle * way.x.signum());
            particles.set_pin_target(i, centre + turn * way);
        }
        run(&mut island, &weightless(FRAME), FRAME);
        let counts = island.self_contact_counts();
        assert_eq!(counts.crossings, 0, "in step {step}");
        truncated += counts.truncated;
    }
    assert!(truncated > 0, "it is wrung too far for pushes alone");
}

/// A sheet of 1 m that hangs by its top edge, `down` its sides.
fn hanging(columns: u32, rows: u32, down: Vec3) -> Island {
    let sheet = ClothBuilder::new(1.0, 1.0, columns, rows).placed(Vec3::Y, Vec3::X, down).pin_edge(Edge::Top);
    Island::of_body(sheet.build(settings(0.005)).expect("valid"))
}

/// A sheet that hangs and swings a little touches nothing. Lists of pairs were made in each step, at three times the price of
/// the step.
#[test]
fn a_sheet_that_touches_nothing_lists_nothing() {
    let mut island = hanging(33, 33, Vec3::new(0.0, -0.995, 0.0998));
    let mut lists = 0;
    run_with(&mut island, &gravity(FRAME), 2.0, |island, _| lists += island.self_contact_counts().lists);
    assert_eq!(lists, 0);
}

/// Takes the same steps in sweeps and substep by substep, which end in the same bits. A sheet that comes first is pulled aside by
/// its pins now and then. Returns the number of calm steps.
fn check_sweeps(mut swept: Island, environment: &Environment) -> u32 {
    let mut staged = swept.clone();
    let mut calm = 0;
    for number in 0..30 {
        for island in [&mut swept, &mut staged].into_iter().filter(|_| number % 5 == 4) {
            let particles = &mut island.bodies[0].particles;
            for i in 0..50 {
                particles.set_pin_target(i, particles.position(i) + Vec3::new(0.0, 0.01, 0.04));
            }
        }
        step(&mut swept, environment).expect("valid");
        begin(&mut staged, environment).expect("valid");
        accumulate_forces(&mut staged, environment);
        detect_collisions(&mut staged, environment);
        (0..8).for_each(|_| substep(&mut staged, environment));
        finish(&mut staged).expect("valid");
        for (place, (one, other)) in swept.bodies.iter().zip(&staged.bodies).enumerate() {
            let [one, other] =
                [one, other].map(|body| StateHasher::new().particles(&body.particles).finish());
            assert_eq!(one, other, "body {place} in step {number}");
        }
        calm += u32::from(swept.self_contact_counts().lists == 0);
    }
    calm
}

/// Steps in which nothing is expected to touch are taken in sweeps, and taken back where particles leave their ways; with the
/// hem in the air or on the ground.
#[test]
fn steps_taken_in_sweeps_end_as_those_taken_substep_by_substep() {
    let ground = obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::Y * 0.1, 0.3);
    let ground = ground.with_static_friction(0.9).expect("in range");
    for obstacles in [vec![], vec![ground]] {
        let environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
        let calm = check_sweeps(hanging(50, 49, Vec3::new(0.0, -0.8, 0.6)), &environment);
        assert!(calm > 15, "{calm} steps are calm");
    }
}

/// A rope without self-contact went on from the end of the step when that of the sheet beside it was taken back.
#[test]
fn what_has_no_self_contact_takes_no_step_twice() {
    let rope = RopeBuilder::new(Vec3::Z * 5.0, Vec3::new(1.0, 0.0, 5.0), 9);
    let mut island = hanging(50, 49, Vec3::new(0.0, -0.8, 0.6));
    island.bodies.push(rope.build(BodySettings::default()).expect("valid"));
    assert!(check_sweeps(island, &gravity(FRAME)) > 15);
}

/// Two sheets hang apart when a step begins, and a ball drives one into the other within that step.
#[test]
fn layers_that_a_ball_drives_together_within_a_step_do_not_cross() {
    let crossed = |self_contact| {
        let settings = BodySettings { self_contact, ..settings(0.005) };
        let sheet = |z: f32| {
            ClothBuilder::new(1.0, 1.0, 25, 25)
                .placed(Vec3::new(-0.5, 0.5, z), Vec3::X, Vec3::NEG_Y)
                .pin_edge(Edge::Top)
        };
        let bodies = [0.0, 0.06].map(|z| sheet(z).build(settings).expect("valid"));
        let mut island = Island { bodies: bodies.into(), ..Island::default() };
        run(&mut island, &gravity(FRAME), FRAME);
        assert_eq!(island.self_contact_counts().lists, 0, "they are apart");
        island.balls.push(ball(smooth(0.1, 3.0), Vec3::new(0.02, 0.01, -0.3), Vec3::Z * 25.0));
        let mut most = 0;
        run_with(&mut island, &gravity(FRAME), 0.5, |island, _| most = most.max(crossings(island)));
        most
    };
    assert_eq!(crossed(SelfContact::On), 0);
    assert!(crossed(SelfContact::Off) > 0, "without contact they cross");
}
