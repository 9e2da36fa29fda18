//! S30: rigid bodies of four particles and six sticks that touch obstacles with the corners of an embedded mesh.

use drape_solver::build::rigid_tetrahedron::placement_of;
use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, EmbeddedPoint, Environment, Isa, Island, Obstacle, Placement, RigidBody,
    RigidTetrahedronBuilder, Shape, StateHasher, step,
};

use crate::common::*;

const HALF: Vec3 = Vec3::new(0.3, 0.15, 0.2);

fn settings() -> BodySettings {
    BodySettings { substeps: 8, iterations: 4, thickness: 0.005, ..bare() }
}

fn brick(placement: Placement, settings: BodySettings) -> Body {
    RigidTetrahedronBuilder::cuboid(6.0, HALF).placed(placement).build(settings).expect("valid")
}

/// The placement of a brick from its particles, by `placement_of`.
fn placement(island: &Island) -> Placement {
    let rest = RigidTetrahedronBuilder::cuboid(6.0, HALF).particles().expect("valid");
    placement_of(rest, core::array::from_fn(|i| particles(island).position(i))).expect("it is not flat")
}

/// Mass, centre of mass and inertia have the given values.
#[test]
fn four_particles_have_the_mass_centre_and_inertia_of_the_box() {
    let centre = Vec3::new(1.0, 2.0, 3.0);
    let body = brick(Placement { translation: centre, rotation: Quat::from_rotation_x(0.7) }, settings());
    law("mass of the box", measure::mass(&body.particles), 6.0, 1e-6);
    let arms: Vec<DVec3> = body.particles.positions().map(|place| (place - centre).as_dvec3()).collect();
    assert!(arms.iter().sum::<DVec3>().length() < 1e-6);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| (Quat::from_rotation_x(0.7) * axis).as_dvec3());
    let squares = HALF.as_dvec3() * HALF.as_dvec3();
    let expected = [squares.y + squares.z, squares.z + squares.x, squares.x + squares.y];
    for (k, (axis, sum)) in axes.into_iter().zip(expected).enumerate() {
        let moment: f64 = arms.iter().map(|arm| 1.5 * axis.cross(*arm).length_squared()).sum();
        law(&format!("moment of the box about axis {k}"), moment, 2.0 * sum, 1e-5);
        let product: f64 = arms.iter().map(|arm| 1.5 * axis.dot(*arm) * axes[(k + 1) % 3].dot(*arm)).sum();
        assert!(product.abs() < 1e-6, "no deviation moment: {product}");
    }
}

#[test]
fn a_body_that_cannot_be_is_refused() {
    let refused =
        |builder: RigidTetrahedronBuilder| builder.build(settings()).expect_err("refused").to_string();
    assert!(refused(RigidTetrahedronBuilder::new(0.0, Vec3::ONE)).contains("mass"));
    assert!(
        refused(RigidTetrahedronBuilder::new(1.0, Vec3::new(3.0, 1.0, 1.0))).contains("moments of inertia")
    );
    assert!(refused(RigidTetrahedronBuilder::cuboid(1.0, Vec3::new(1.0, 0.0, 1.0))).contains("inertia"));
    assert!(refused(RigidTetrahedronBuilder::cuboid(1.0, HALF).corners([Vec3::NAN])).contains("corner"));
    assert_eq!(
        EmbeddedPoint::new([0, 1, 2, 3], [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::ONE - Vec3::Y], Vec3::Y),
        None
    );
}

/// Without forces it flies and spins on. It keeps momentum, and angular momentum except for the part `w^2 h` that projection
/// takes each second, as from every tetrahedron of sticks.
#[test]
fn a_free_box_keeps_its_momentum_and_its_spin() {
    let (velocity, spin) = (Vec3::new(1.0, 0.5, -2.0), Vec3::new(0.0, 0.0, 2.0));
    let builder = RigidTetrahedronBuilder::cuboid(6.0, HALF).moving(velocity, spin);
    let mut island =
        Island::of_body(builder.build(BodySettings { iterations: 8, ..settings() }).expect("valid"));
    let before = particles(&island).clone();
    run(&mut island, &weightless(FRAME), 1.0);
    let after = particles(&island);
    let change = (measure::momentum(after) - measure::momentum(&before)).length();
    law_of_error("momentum of a free box, parts", change / measure::momentum(&before).length(), 1e-5);
    let spin_of = |p: &drape_solver::Particles| {
        let centre = p.positions().map(Vec3::as_dvec3).sum::<DVec3>() * 0.25;
        measure::angular_momentum(p) - centre.cross(measure::momentum(p))
    };
    let kept = spin_of(after).length() / spin_of(&before).length();
    law("spin of a free box after a second, parts", kept, 1.0 - 4.0 / 480.0, 5e-3);
    let centre = after.positions().sum::<Vec3>() * 0.25;
    law_of_error("way of a free box in m", f64::from(centre.distance(velocity)), 1e-4);
}

/// A push acts at its corner: momentum changes by the push, and angular momentum by its moment, for all masses.
#[test]
fn a_contact_gives_the_momentum_and_the_moment_of_a_push_at_the_point() {
    let tilt = Quat::from_rotation_z(0.5) * Quat::from_rotation_x(0.3);
    let mut body = brick(
        Placement { translation: Vec3::ZERO, rotation: tilt },
        BodySettings { substeps: 1, iterations: 1, thickness: 0.0, ..bare() },
    );
    for (i, mass) in [1.0, 2.0, 4.0, 0.5].into_iter().enumerate() {
        body.particles.set_inverse_mass(i, 1.0 / mass);
        body.particles.set_velocity(i, Vec3::NEG_Y * 3.0);
    }
    // Its lowest corner is just above the ground.
    let places = |body: &Body| core::array::from_fn(|i| body.particles.position(i));
    let height = |point: &EmbeddedPoint, body: &Body| point.position(places(body)).y;
    let points = body.topology.embedded().to_vec();
    let lowest = points.iter().min_by(|a, b| height(a, &body).total_cmp(&height(b, &body))).expect("corners");
    let corner = lowest.position(places(&body));
    let ground = obstacle(Shape::HalfSpace { normal: Vec3::Y }, Vec3::Y * (corner.y - 0.01), 0.0);
    let before = (measure::momentum(&body.particles), measure::angular_momentum(&body.particles));
    let mut island = Island::of_body(body);
    step(&mut island, &Environment { obstacles: vec![ground].into(), ..weightless(FRAME) }).expect("valid");
    let push = measure::momentum(particles(&island)) - before.0;
    let moment = measure::angular_momentum(particles(&island)) - before.1;
    assert!(push.y > 0.5 && push.x.abs() < 1e-4 && push.z.abs() < 1e-4, "{push}");
    // Momenta are taken at the end of the step; by then the corner has moved less than 5 cm.
    let expected = corner.as_dvec3().cross(push);
    let off = (moment - expected).length() / expected.length();
    law_of_error("moment of a push at a corner, parts", off, 0.35);
}

/// A brick that is set down on the ground keeps its placement, and comes to rest.
#[test]
fn a_box_at_rest_stays_and_sleeps() {
    let start = Placement::at(Vec3::Y * (HALF.y + 0.005));
    let mut island = Island::of_body(brick(start, BodySettings { friction: 0.5, ..settings() }));
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    run(&mut island, &environment, 4.0);
    let now = placement(&island);
    law_of_error("creep of a brick at rest in m", now.translation.distance(start.translation).into(), 1e-3);
    let turn = now.rotation.angle_between(Quat::IDENTITY);
    law_of_error("turn of a brick at rest in rad", turn.into(), 2e-3);
    assert!(island.bodies[0].still_for() > 2.0, "still for {} s", island.bodies[0].still_for());
}

/// A brick dropped on an edge tumbles, and comes to rest on one of its sides, with no corner in the ground.
#[test]
fn a_box_that_is_dropped_comes_to_lie_on_a_side() {
    for tilt in [Quat::from_rotation_z(0.6), Quat::from_rotation_x(0.9) * Quat::from_rotation_z(0.4)] {
        let start = Placement { translation: Vec3::Y * 1.0, rotation: tilt };
        let mut island = Island::of_body(brick(start, BodySettings { friction: 0.5, ..settings() }));
        let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
        let mut deepest = 0.0_f32;
        run_with(&mut island, &environment, 6.0, |island, _| {
            let body = &island.bodies[0];
            let places = core::array::from_fn(|i| body.particles.position(i));
            let lowest = body.topology.embedded().iter().map(|point| point.position(places).y);
            deepest = deepest.min(lowest.fold(f32::MAX, f32::min));
        });
        assert!(deepest > -0.002, "a corner is {deepest} m high");
        let now = placement(&island);
        let up = now.rotation.inverse() * Vec3::Y;
        assert!(up.abs().max_element() > 0.9999, "it stands on an edge: {up}");
        let half = HALF.dot(up.abs());
        law(
            "height of the middle of a box that has come to lie",
            now.translation.y.into(),
            (half + 0.005).into(),
            0.01,
        );
        assert!(island.bodies[0].still_for() > 1.0, "still for {} s", island.bodies[0].still_for());
        let stretch = measure::stretch(&island.bodies[0].particles, &island.bodies[0].topology).max;
        law_of_error("strain of a box at rest", stretch, 1e-3);
    }
}

/// On an incline it holds below the angle of friction, and slides with Coulomb's acceleration above it.
#[test]
fn a_box_slides_on_an_incline_as_coulomb_has_it() {
    let friction = 0.5_f32;
    for degrees in [15.0_f32, 22.0, 30.0, 35.0] {
        let angle = degrees.to_radians();
        let rotation = Quat::from_rotation_z(-angle);
        let plane = Obstacle::new(
            Shape::HalfSpace { normal: Vec3::Y },
            Placement { rotation, ..Placement::default() },
            friction,
        );
        let start = Placement { translation: rotation * Vec3::Y * (HALF.y + 0.005), rotation };
        let mut island = Island::of_body(brick(start, BodySettings { friction, ..settings() }));
        let environment = Environment { obstacles: vec![plane.expect("valid")].into(), ..gravity(FRAME) };
        run(&mut island, &environment, 1.0);
        let way = (placement(&island).translation - start.translation).dot(rotation * Vec3::X);
        let pull = angle.sin() - friction * angle.cos();
        if pull < 0.0 {
            law_of_error(&format!("creep of a box at {degrees} degrees in m"), way.into(), 2e-3);
        } else {
            law(&format!("way of a box at {degrees} degrees"), way.into(), (0.5 * G * pull).into(), 0.03);
        }
    }
}

/// A brick tumbles down a flight of stairs without getting stuck, and comes to rest below.
#[test]
fn a_box_tumbles_down_stairs_and_rests_below() {
    let mut obstacles = vec![Obstacle::ground()];
    for k in 0..5 {
        let (height, depth) = (0.18 * (5 - k) as f32, 0.28);
        let half_extents = Vec3::new(0.5 * depth, 0.5 * height, 1.0);
        let at = Vec3::new(depth * (k as f32 + 0.5), 0.5 * height, 0.0);
        obstacles.push(obstacle(Shape::Cuboid { half_extents }, at, 0.4));
    }
    let start = Placement { translation: Vec3::new(0.1, 1.4, 0.0), rotation: Quat::from_rotation_y(0.3) };
    let builder = RigidTetrahedronBuilder::cuboid(3.0, Vec3::new(0.12, 0.08, 0.1));
    let builder = builder.placed(start).moving(Vec3::X * 2.5, Vec3::NEG_Z * 6.0);
    let mut island =
        Island::of_body(builder.build(BodySettings { friction: 0.3, ..settings() }).expect("valid"));
    let environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
    run(&mut island, &environment, 8.0);
    let centre = particles(&island).positions().sum::<Vec3>() * 0.25;
    assert!(centre.x > 1.2 && centre.y < 0.2 && centre.y > 0.05, "it lies at {centre}");
    assert!(island.bodies[0].still_for() > 1.0, "still for {} s", island.bodies[0].still_for());
}

/// A thin wall stops a fast brick.
#[test]
fn a_fast_box_does_not_pass_a_thin_wall() {
    for speed in [10.0_f32, 30.0] {
        let wall = obstacle(Shape::Cuboid { half_extents: Vec3::new(0.01, 3.0, 3.0) }, Vec3::X * 2.0, 0.3);
        let builder =
            RigidTetrahedronBuilder::cuboid(3.0, Vec3::splat(0.15)).moving(Vec3::X * speed, Vec3::ZERO);
        let mut island = Island::of_body(builder.build(settings()).expect("valid"));
        run(&mut island, &Environment { obstacles: vec![wall].into(), ..weightless(FRAME) }, 1.0);
        let x = particles(&island).positions().map(|place| place.x).fold(f32::MIN, f32::max);
        assert!(x < 2.0, "at {speed} m/s it gets to {x} m");
    }
}

/// A dynamic obstacle takes the momentum that the box loses.
#[test]
fn a_box_and_a_dynamic_obstacle_share_momentum() {
    let body = RigidBody::new(3.0, Vec3::splat(0.1)).expect("valid");
    let shape = Shape::Cuboid { half_extents: Vec3::splat(0.2) };
    let target = Obstacle::new(shape, Placement::at(Vec3::new(1.0, 0.06, 0.04)), 0.3)
        .expect("valid")
        .with_rigid_body(body);
    let mut environment = Environment { obstacles: vec![target].into(), ..weightless(FRAME) };
    let builder = RigidTetrahedronBuilder::cuboid(2.0, Vec3::splat(0.1)).moving(Vec3::X * 4.0, Vec3::ZERO);
    let mut island = Island::of_body(builder.build(settings()).expect("valid"));
    for _ in 0..60 {
        environment.obstacles[0].fly(Vec3::ZERO, FRAME);
        step(&mut island, &environment).expect("valid");
        for moved in &island.moved {
            environment.obstacles[moved.obstacle].land(moved);
        }
    }
    let hit = environment.obstacles[0].rigid_body().expect("it has one").velocity.as_dvec3();
    assert!(hit.x > 0.5, "it has been hit: {hit}");
    let total = measure::momentum(particles(&island)) + hit * 3.0;
    law_of_error("momentum of box and obstacle, parts", (total - DVec3::X * 8.0).length() / 8.0, 1e-4);
}

/// All instruction sets tumble it to the same bits.
#[test]
fn a_box_tumbles_to_the_same_bits_on_every_instruction_set() {
    let run_on = |isa: Isa| {
        let start = Placement { translation: Vec3::Y * 0.6, rotation: Quat::from_rotation_z(0.6) };
        let body = brick(start, BodySettings { friction: 0.5, ..settings() });
        let mut island = Island { isa, ..Island::of_body(body) };
        let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
        run(&mut island, &environment, 1.5);
        StateHasher::new().particles(particles(&island)).finish()
    };
    let mut hashes: Vec<u64> = Isa::available().into_iter().map(run_on).collect();
    hashes.dedup();
    assert_eq!(hashes.len(), 1);
}
