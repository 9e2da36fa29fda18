//! S7: Coulomb friction, on an incline.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    BallMaterial, Body, BodySettings, ClothBuilder, CombineRule, Environment, Island, Obstacle, Placement,
    Shape,
};

use crate::common::*;

const COEFFICIENTS: [f32; 3] = [0.2, 0.5, 1.0];

/// An incline about the Z axis that falls towards +X, and the direction downhill.
fn incline(angle: f32, friction: f32) -> (Obstacle, Vec3) {
    let rotation = Quat::from_rotation_z(-angle);
    let placement = Placement { rotation, ..Placement::default() };
    let plane = Obstacle::new(Shape::HalfSpace { normal: Vec3::Y }, placement, friction).expect("valid");
    (plane, rotation * Vec3::X)
}

/// The distance in metres that the middle of `body` goes downhill in `seconds` on an incline of `angle` (radians). Both
/// surfaces have the coefficient `friction`.
fn slid(body: Body, angle: f32, friction: f32, seconds: f32) -> f32 {
    slid_on(incline(angle, friction), body, seconds)
}

fn slid_on((plane, downhill): (Obstacle, Vec3), body: Body, seconds: f32) -> f32 {
    let environment = Environment { obstacles: vec![plane].into(), ..gravity(FRAME) };
    let mut island = Island::of_body(body);
    let middle =
        |island: &Island| particles(island).positions().sum::<Vec3>() / particles(island).len() as f32;
    let start = middle(&island);
    run(&mut island, &environment, seconds);
    (middle(&island) - start).dot(downhill)
}

fn particle(angle: f32, friction: f32, substeps: u32) -> Body {
    let normal = Quat::from_rotation_z(-angle) * Vec3::Y;
    let settings = BodySettings { friction, substeps, iterations: 2, thickness: 0.005, ..bare() };
    loose(&[normal * 0.005], settings)
}

fn sheet(angle: f32, friction: f32, substeps: u32) -> Body {
    let rotation = Quat::from_rotation_z(-angle);
    let settings =
        BodySettings { friction, substeps, iterations: 2, thickness: 0.005, tethers: true, ..bare() };
    ClothBuilder::new(0.8, 0.8, 9, 9)
        .placed(rotation * Vec3::Y * 0.005, rotation * Vec3::X, Vec3::Z)
        .build(settings)
        .expect("valid")
}

/// S7: a fifth of a degree below the angle of friction, nothing moves by a millimetre in two seconds.
#[test]
fn below_the_angle_of_friction_nothing_creeps() {
    for friction in COEFFICIENTS {
        let angle = friction.atan() - 0.2_f32.to_radians();
        for substeps in [1, 8] {
            for (name, body) in [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ] {
                let way = slid(body, angle, friction, 2.0);
                assert!(way.abs() < 1e-3, "{name}, friction {friction}, {substeps} substeps: {way} m");
            }
        }
    }
}

/// S7: a fifth of a degree above it everything slides.
#[test]
fn above_the_angle_of_friction_everything_slides() {
    for friction in COEFFICIENTS {
        let angle = friction.atan() + 0.2_f32.to_radians();
        for substeps in [1, 8] {
            for (name, body) in [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ] {
                let way = slid(body, angle, friction, 2.0);
                assert!(way > 0.03, "{name}, friction {friction}, {substeps} substeps: {way} m");
            }
        }
    }
}

/// S7: sliding, the acceleration is `g (sin - mu cos)`.
#[test]
fn sliding_accelerates_by_what_friction_leaves_of_gravity() {
    for friction in [0.0, 0.2, 0.5] {
        for substeps in [1, 8] {
            let angle = 40.0_f32.to_radians();
            let h = FRAME / substeps as f32;
            let expected = G * (angle.sin() - friction * angle.cos());
            let bodies = [
                ("particle", particle(angle, friction, substeps)),
                ("sheet", sheet(angle, friction, substeps)),
            ];
            for (name, body) in bodies {
                // Under constant acceleration n substeps cover a h^2 n (n + 1) / 2.
                let found = slid(body, angle, friction, 1.0) * 2.0 / (1.0 + h);
                let case = format!("{name}, friction {friction}, {substeps} substeps");
                law(&format!("incline, {case}"), found.into(), expected.into(), 2e-6);
            }
        }
    }
}

/// The coefficients that each rule makes of 0.2 and 0.8.
const COMBINED: [(CombineRule, f32); 6] = [
    (CombineRule::Average, 0.5),
    (CombineRule::GeometricMean, 0.4),
    (CombineRule::Min, 0.2),
    (CombineRule::Multiply, 0.16),
    (CombineRule::Max, 0.8),
    (CombineRule::ClampedSum, 1.0),
];

/// A particle slides on an obstacle above the angle of friction that the obstacle's rule makes.
#[test]
fn a_rule_combines_the_friction_of_both_surfaces() {
    for (rule, friction) in COMBINED {
        for (degrees, slides) in [(-0.5_f32, false), (0.5, true)] {
            let angle = friction.atan() + degrees.to_radians();
            let (plane, downhill) = incline(angle, 0.2);
            let plane = plane.with_combine_rules(rule, CombineRule::Average);
            let way = slid_on((plane, downhill), particle(angle, 0.8, 8), 2.0);
            assert_eq!(way > 0.03, slides, "{rule:?}, {degrees} degrees beyond the angle: {way} m");
        }
    }
}

/// A ball leaves a wall with the part of its speed that the wall's rule makes.
#[test]
fn a_rule_combines_the_restitution_of_both_surfaces() {
    for (rule, restitution) in COMBINED {
        let wall = obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::ZERO, 0.0)
            .with_combine_rules(CombineRule::Average, rule)
            .with_restitution(0.2)
            .expect("in range");
        let environment = Environment { obstacles: vec![wall].into(), ..weightless(FRAME) };
        let material = BallMaterial { radius: 0.1, restitution: 0.8, drag: 0.0, ..BallMaterial::default() };
        let mut island = Island::of_ball(ball(material, Vec3::Y * 0.5, Vec3::Y * -10.0));
        run(&mut island, &environment, 0.2);
        law(
            &format!("rebound, {rule:?}"),
            island.balls[0].velocity().y.into(),
            f64::from(10.0 * restitution),
            1e-4,
        );
    }
}

/// S7: friction stops a slide after `v^2 / (2 mu g)` and never reverses it.
#[test]
fn a_slide_ends_after_the_distance_of_coulomb() {
    let (speed, friction) = (3.0, 0.5);
    for (substeps, tolerance) in [(1, 0.041), (8, 5.2e-3)] {
        let settings = BodySettings { substeps, friction, iterations: 2, ..bare() };
        let mut body = loose(&[Vec3::ZERO], settings);
        body.particles.set_velocity(0, Vec3::X * speed);
        let mut island = Island::of_body(body);
        let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
        run_with(&mut island, &environment, 2.0, |island, _| {
            assert!(particles(island).velocity(0).x >= 0.0, "never reversed");
        });
        assert_eq!(particles(&island).velocity(0).x, 0.0, "at rest");
        let way = particles(&island).position(0).x;
        let expected = f64::from(speed * speed / (2.0 * friction * G));
        law(&format!("way to a stop, {substeps} substeps"), way.into(), expected, tolerance);
    }
}

/// S7: two surfaces in contact use the mean of their coefficients.
#[test]
fn the_coefficients_of_two_surfaces_are_averaged() {
    let angle = 20.0_f32.to_radians();
    let way = |own: f32, planes: f32| {
        let (plane, _) = incline(angle, planes);
        let environment = Environment { obstacles: vec![plane].into(), ..gravity(FRAME) };
        let mut island = Island::of_body(particle(angle, own, 4));
        run(&mut island, &environment, 1.0);
        particles(&island).position(0).length()
    };
    let even = way(0.2, 0.2);
    assert!((way(0.4, 0.0) - even).abs() < 1e-4 && (way(0.0, 0.4) - even).abs() < 1e-4);
    assert!(way(0.0, 0.0) > even + 0.1);
}

/// S7: between the angles of static and of kinetic friction, a body at rest stays, and a sliding one goes on sliding.
#[test]
fn static_friction_holds_what_does_not_slide_yet() {
    let (kinetic, sticking) = (0.3_f32, 0.6_f32);
    let angle = 0.5 * (kinetic.atan() + sticking.atan());
    let body = |speed: f32| {
        let (_, downhill) = incline(angle, 0.0);
        let mut body = particle(angle, kinetic, 8);
        body.settings.static_friction = sticking;
        body.particles.set_velocity(0, downhill * speed);
        body
    };
    let (plane, downhill) = incline(angle, kinetic);
    let plane = plane.with_static_friction(sticking).expect("valid");
    let environment = Environment { obstacles: vec![plane].into(), ..gravity(FRAME) };
    let after = |speed: f32| {
        let mut island = Island::of_body(body(speed));
        run(&mut island, &environment, 1.0);
        particles(&island).velocity(0).dot(downhill)
    };
    assert!(after(0.0).abs() < 1e-6, "it holds");
    let expected = 1.0 + G * (angle.sin() - kinetic * angle.cos());
    law("speed after a second's slide", after(1.0).into(), expected.into(), 1e-5);
}

/// A ball rolls down an incline without slipping as long as `tan(angle)` is at most 3.5 times its coefficient of static
/// friction; with that of kinetic friction alone it would slide.
#[test]
fn static_friction_makes_a_ball_roll_where_kinetic_friction_would_let_it_slide() {
    let angle = 35.0_f32.to_radians();
    let speed = |sticking: f32| {
        let (plane, downhill) = incline(angle, 0.05);
        let plane = plane.with_static_friction(sticking).expect("valid");
        let material = BallMaterial { friction: 0.05, static_friction: sticking, ..smooth(0.2, 1.0) };
        let start = Quat::from_rotation_z(-angle) * Vec3::Y * 0.2;
        let mut island = Island::of_ball(ball(material, start, Vec3::ZERO));
        run(&mut island, &Environment { obstacles: vec![plane].into(), ..gravity(FRAME) }, 1.0);
        f64::from(island.balls[0].velocity().dot(downhill))
    };
    let pull = f64::from(G * angle.sin());
    law("acceleration of a ball that sticks and rolls", speed(0.4), pull * 5.0 / 7.0, 0.012);
    let slides = pull - f64::from(0.05 * G * angle.cos());
    law("acceleration of a ball that slides", speed(0.0), slides, 0.012);
}

/// Friction drives a spinning ball aside when it lands on a cloth held all round, as on the ground. Without friction it
/// stays.
#[test]
fn friction_with_cloth_turns_spin_into_motion() {
    let driven = |friction: f32| {
        let settings = BodySettings { friction, ..BodySettings::default() };
        let cloth = ClothBuilder::new(1.0, 1.0, 17, 17)
            .placed(Vec3::new(-0.5, 0.0, -0.5), Vec3::X, Vec3::Z)
            .pin_where(|column, row, _| column % 16 == 0 || row % 16 == 0);
        let mut island = Island::of_body(cloth.build(settings).expect("valid"));
        let material = BallMaterial { friction, ..smooth(0.1, 0.1) };
        let mut spinning = ball(material, Vec3::Y * 0.12, Vec3::ZERO);
        spinning.set_spin(Vec3::NEG_Z * 30.0);
        island.balls.push(spinning);
        run(&mut island, &gravity(FRAME), 0.4);
        island.balls[0].velocity().x
    };
    let (rough, smooth) = (driven(0.5), driven(0.0));
    println!("law: speed from 30 rad/s on cloth: {rough} m/s with friction, {smooth} m/s without");
    assert!(rough > 0.3 && smooth.abs() < 0.05, "{rough} m/s and {smooth} m/s");
}
