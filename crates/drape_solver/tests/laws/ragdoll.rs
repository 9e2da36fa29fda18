//! S31, S32: ragdolls, and motion inherited from an animation.

use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, Environment, Island, Obstacle, Placement, RagdollBuilder, RagdollStick, Shape,
    StickBound,
};

use crate::common::*;

fn settings() -> BodySettings {
    BodySettings { substeps: 16, iterations: 4, thickness: 0.05, friction: 0.6, drag: 0.6, ..bare() }
}

/// Five steps of 18 by 28 cm that go down towards +X from 0.9 m.
pub fn stairs() -> Vec<Obstacle> {
    let mut obstacles = vec![Obstacle::ground()];
    for k in 0..5 {
        let (height, depth) = (0.18 * (5 - k) as f32, if k == 0 { 2.0 } else { 0.28 });
        let right = 0.28 * (k + 1) as f32;
        let half_extents = Vec3::new(0.5 * depth, 0.5 * height, 1.5);
        let at = Vec3::new(right - 0.5 * depth, 0.5 * height, 0.0);
        obstacles.push(obstacle(Shape::Cuboid { half_extents }, at, 0.5));
    }
    obstacles
}

/// The greatest strain of limbs, and the greatest violation of a limit, as parts of the rest lengths.
fn strains(island: &Island, sticks: &[RagdollStick]) -> [f64; 2] {
    let particles = particles(island);
    let mut worst = [0.0_f64; 2];
    for RagdollStick { ends, length, bound } in sticks {
        let [a, b] = ends.map(|end| particles.position(end as usize));
        let strain = bound.violation(f64::from(a.distance(b) / length) - 1.0).abs();
        let place = usize::from(*bound != StickBound::Exact);
        worst[place] = worst[place].max(strain);
    }
    worst
}

/// A ragdoll that is pushed off the top of the stairs tumbles down and comes to rest. All the way its limbs keep their length
/// to one per cent.
#[test]
fn a_ragdoll_tumbles_down_the_stairs_and_comes_to_rest() {
    let environment = Environment { obstacles: stairs().into(), ..gravity(FRAME) };
    for (turn, push) in
        [(Quat::from_rotation_y(1.57), 2.5), (Quat::from_rotation_y(-1.2), 3.0), (Quat::IDENTITY, 2.0)]
    {
        let start = Placement { translation: Vec3::new(0.0, 0.9, 0.0), rotation: turn };
        let builder = RagdollBuilder::new(1.75, 75.0).placed(start);
        let sticks = builder.sticks();
        let mut body = builder.build(settings()).expect("valid");
        for i in 0..body.particles.len() {
            let height = body.particles.position(i).y - 0.9;
            body.particles.set_velocity(i, Vec3::X * (push * height));
        }
        let mut island = Island::of_body(body);
        let mut worst = [0.0_f64; 2];
        run_with(&mut island, &environment, 12.0, |island, _| {
            let now = strains(island, &sticks);
            worst = [worst[0].max(now[0]), worst[1].max(now[1])];
        });
        let end = strains(&island, &sticks);
        law_of_error("strain of a ragdoll's limbs on the way down", worst[0], 0.05);
        law_of_error("strain of a ragdoll's limbs at rest", end[0], 0.01);
        law_of_error("breach of a ragdoll's limits at rest", end[1], 0.03);
        let centre = particles(&island).positions().sum::<Vec3>() / particles(&island).len() as f32;
        println!("law: it lies at {centre}, still for {} s", island.bodies[0].still_for());
        assert!(centre.x > 1.0 && centre.y < 0.5, "it lies at {centre}");
        assert!(island.bodies[0].still_for() > 1.0, "still for {} s", island.bodies[0].still_for());
        let lowest = particles(&island).positions().map(|place| place.y).fold(f32::MAX, f32::min);
        assert!(lowest > 0.045, "a joint is {lowest} m high");
    }
}

/// A falling ragdoll neither collapses nor flies apart.
#[test]
fn a_ragdoll_at_rest_in_space_stays_as_it_is() {
    let builder = RagdollBuilder::new(1.75, 75.0);
    let sticks = builder.sticks();
    let mut island = Island::of_body(builder.build(settings()).expect("valid"));
    let before: Vec<Vec3> = particles(&island).positions().collect();
    run(&mut island, &weightless(FRAME), 2.0);
    let moved = particles(&island).positions().zip(&before).map(|(p, &q)| p.distance(q)).fold(0.0, f32::max);
    law_of_error("move of a ragdoll that nothing acts on, in m", moved.into(), 1e-3);
    assert!(strains(&island, &sticks).iter().all(|&strain| strain < 1e-3));
    let limbs = sticks.iter().filter(|stick| stick.bound == StickBound::Exact).count();
    assert!(limbs > 30 && sticks.len() > limbs + 20, "{limbs} of {}", sticks.len());
    law("mass of a ragdoll", measure::mass(&particles(&island).clone()), 75.0, 1e-5);
}

/// Spin of a body about its centre of mass (rad/s), and velocity of the centre (m/s).
fn motion(body: &Body) -> (DVec3, DVec3) {
    let particles = &body.particles;
    let mass = measure::mass(particles);
    let velocity = measure::momentum(particles) / mass;
    let weights = (0..particles.len()).map(|i| 1.0 / f64::from(particles.inverse_mass(i)));
    let centre = particles.positions().zip(weights).map(|(p, m)| p.as_dvec3() * m).sum::<DVec3>() / mass;
    (velocity, measure::angular_momentum(particles) - centre.cross(measure::momentum(particles)))
}

/// S32: a ragdoll continues with the velocity and spin of two frames of an animation that flies and rotates about its centre
/// of mass.
#[test]
fn a_ragdoll_goes_on_with_the_motion_of_two_frames() {
    let (velocity, spin) = (Vec3::new(2.0, 3.0, -1.0), 3.0);
    let figure = RagdollBuilder::new(1.75, 75.0);
    let standing = figure.particles().expect("valid");
    let middle = standing.iter().map(|&(place, mass)| place * (mass / 75.0)).sum::<Vec3>();
    let frame = |time: f32| {
        let rotation = Quat::from_rotation_x(spin * time);
        let translation = velocity * time - rotation * middle;
        figure.placed(Placement { translation, rotation }).particles().expect("valid").into_iter()
    };
    for rate in [30.0_f32, 60.0, 144.0] {
        let at_end = Placement::at(-middle);
        let mut body = figure.placed(at_end).build(BodySettings { drag: 0.0, ..settings() }).expect("valid");
        let mut exact = body.clone();
        for (i, ((previous, _), (now, _))) in frame(-1.0 / rate).zip(frame(0.0)).enumerate() {
            body.particles.set_motion(i, previous, now, 1.0 / rate);
            exact.particles.set_velocity(i, velocity + (Vec3::X * spin).cross(now));
        }
        let expected = motion(&exact);
        let mut island = Island::of_body(body);
        run(&mut island, &weightless(FRAME), 0.25);
        let found = motion(&island.bodies[0]);
        let off = (found.0 - expected.0).length() / expected.0.length();
        law_of_error(&format!("velocity inherited at {rate} frames a second, parts"), off, 1e-4);
        let off = (found.1 - expected.1).length() / expected.1.length();
        law_of_error(&format!("spin inherited at {rate} frames a second, parts"), off, 0.01);
    }
}

/// A pinned particle takes its place and stays there. Frames without time between them give no velocity.
#[test]
fn what_cannot_move_inherits_no_motion() {
    let mut body = joined(&[Vec3::ZERO, Vec3::X], &[0.0, 1.0], &[[0, 1]], bare());
    body.particles.set_motion(0, Vec3::ZERO, Vec3::Y, FRAME);
    body.particles.set_motion(1, Vec3::X, Vec3::X * 2.0, 0.0);
    assert_eq!((body.particles.position(0), body.particles.velocity(0)), (Vec3::Y, Vec3::ZERO));
    assert_eq!((body.particles.position(1), body.particles.velocity(1)), (Vec3::X * 2.0, Vec3::ZERO));
}
