//! Random small scenes: no step panics, makes NaN, or throws a body away.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{
    Ball, BallMaterial, Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Obstacle,
    Placement, RopeBuilder, SelfContact, Shape, StickProjection, StructuralSolve, Wind, step,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{TestCaseError, TestRunner};

use crate::common::*;
use crate::random::{between, cases};

fn vector(half: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(between(-half, half)).prop_map(Vec3::from_array)
}

fn settings() -> impl Strategy<Value = BodySettings> {
    (1_u32..6, 1_u32..4, between(0.0, 3.0), between(0.0, 1.5), between(0.0, 0.03), any::<[bool; 3]>())
        .prop_map(|(substeps, iterations, drag, friction, thickness, [exact, lines, tethers])| BodySettings {
            substeps,
            iterations,
            tolerance: 0.0,
            drag,
            friction,
            static_friction: 2.0 * friction,
            thickness,
            projection: if exact { StickProjection::Exact } else { StickProjection::SquareRootFree },
            structural: if lines { StructuralSolve::Lines } else { StructuralSolve::Sweeps },
            tethers,
            self_contact: SelfContact::Off,
        })
}

fn cloth() -> impl Strategy<Value = Body> {
    let stiffness = || between(0.0, 1.0);
    let material = (stiffness(), stiffness(), stiffness(), between(0.0, 20.0));
    let grid = (2_u32..9, 2_u32..9, between(0.2, 2.0));
    (settings(), material, grid, vector(1.0), proptest::bits::u32::masked(0xffff)).prop_map(
        |(
            settings,
            (stretch_stiffness, shear_stiffness, bend_stiffness, damping),
            (columns, rows, size),
            origin,
            pins,
        )| {
            let material = ClothMaterial {
                stretch_stiffness,
                shear_stiffness,
                bend_stiffness,
                damping,
                ..ClothMaterial::default()
            };
            ClothBuilder::new(size, size, columns, rows)
                .placed(origin, Vec3::X, Vec3::Z)
                .material(material)
                .pin_where(|column, row, _| pins >> ((row * columns + column) % 32) & 1 == 1)
                .build(settings)
                .expect("valid")
        },
    )
}

fn rope() -> impl Strategy<Value = Body> {
    (settings(), vector(1.0), vector(1.0), 2_u32..20, between(0.0, 1.0), between(0.0, 1.0)).prop_map(
        |(settings, start, way, count, stretch, bend)| {
            RopeBuilder::new(start, start + way + Vec3::X * 1.1, count)
                .stretch_stiffness(stretch)
                .bend_stiffness(bend)
                .pin_start()
                .build(settings)
                .expect("valid")
        },
    )
}

fn balls() -> impl Strategy<Value = Vec<Ball>> {
    let ball =
        (between(0.03, 0.4), between(0.01, 10.0), between(0.0, 1.0), vector(1.5), vector(25.0), vector(20.0))
            .prop_map(|(radius, mass, friction, position, velocity, spin)| {
                let material = BallMaterial { radius, mass, friction, ..BallMaterial::default() };
                let mut ball = Ball::new(material, position, velocity).expect("valid");
                ball.set_spin(spin);
                ball
            });
    proptest::collection::vec(ball, 0..4)
}

fn obstacles() -> impl Strategy<Value = Vec<Obstacle>> {
    let size = || between(0.05, 0.8);
    let shape = prop_oneof![
        size().prop_map(|radius| Shape::Sphere { radius }),
        (size(), size()).prop_map(|(half_length, radius)| Shape::Capsule { half_length, radius }),
        (size(), size(), size()).prop_map(|(half_length, bottom_radius, top_radius)| {
            Shape::TaperedCapsule { half_length, bottom_radius, top_radius }
        }),
        (size(), size(), size()).prop_map(|(x, y, z)| Shape::Cuboid { half_extents: Vec3::new(x, y, z) }),
        Just(Shape::HalfSpace { normal: Vec3::Y }),
        between(2.0, 4.0).prop_map(|half| Shape::Container { half_extents: Vec3::splat(half) }),
        (size(), size()).prop_map(|(half, radius)| Shape::Parry(SharedShape::cylinder(half, radius))),
        (size(), size()).prop_map(|(half, radius)| Shape::Parry(SharedShape::cone(half, radius))),
    ];
    let placement = (vector(1.5), vector(3.0)).prop_map(|(translation, turn)| Placement {
        translation: translation - Vec3::Y,
        rotation: Quat::from_scaled_axis(turn),
    });
    let obstacle = (shape, placement, between(0.0, 1.5))
        .prop_map(|(shape, placement, friction)| Obstacle::new(shape, placement, friction).expect("valid"));
    proptest::collection::vec(obstacle, 0..4)
}

/// Balls with a density between cork and iron that start above everything else.
fn shots() -> impl Strategy<Value = Vec<Ball>> {
    let shot = (
        between(0.03, 0.2),
        between(100.0, 8000.0),
        between(0.0, 1.0),
        vector(1.0),
        vector(10.0),
        between(0.0, 25.0),
    );
    let shot = shot.prop_map(|(radius, density, friction, place, sideways, down)| {
        let mass = density * 4.2 * radius * radius * radius;
        let material = BallMaterial { radius, mass, friction, ..BallMaterial::default() };
        let velocity = sideways.with_y(-down);
        Ball::new(material, place + Vec3::Y * 4.0, velocity).expect("valid")
    });
    proptest::collection::vec(shot, 0..3)
}

/// Forty steps in which obstacles move to and fro and jump once. Checks the island after each.
fn run_scene(
    island: &mut Island,
    environment: &mut Environment,
    moves: &[Vec3],
    look: impl Fn(&Island) -> Result<(), TestCaseError>,
) -> Result<(), TestCaseError> {
    let dt = environment.dt;
    for index in 0..40 {
        for (place, &way) in (0..environment.obstacles.len()).zip(moves) {
            let obstacle = &mut environment.obstacles[place];
            let sign = if index % 20 < 10 { 5.0 * dt } else { -5.0 * dt };
            let mut placement = obstacle.placement();
            placement.translation += way * sign;
            if index == 20 {
                placement.translation += way;
                obstacle.teleport(placement);
            } else {
                obstacle.move_to(placement, dt);
            }
        }
        prop_assert_eq!(step(island, environment), Ok(()));
        look(island)?;
    }
    Ok(())
}

fn fastest(island: &Island) -> (f32, f32) {
    let bodies = island.bodies.iter().map(|body| body.particles.greatest_speed());
    let balls = island.balls.iter().map(|ball| ball.velocity().length());
    (bodies.fold(0.0, f32::max), balls.fold(0.0, f32::max))
}

#[test]
fn random_numbers_fill_their_range_and_shrink_towards_zero() {
    let mut runner = TestRunner::new(cases(1));
    for (low, high) in [(-3.0, 5.0), (0.002, 0.04), (-7.0, -6.0), (0.0, 8000.0), (1.0, 1.0)] {
        let mut draw = || between(low, high).new_tree(&mut runner).expect("a number");
        let numbers: Vec<f32> = (0..2000).map(|_| draw().current()).collect();
        assert!(numbers.iter().all(|x| (low..=high).contains(x)));
        for tenth in 0..10 {
            let [from, to] = [tenth, tenth + 1].map(|i| low + (high - low) * i as f32 / 10.0);
            let count = numbers.iter().filter(|x| (from..=to).contains(x)).count();
            assert!(count > 150, "{count} of 2000 from {from} to {to}");
        }
        let mut drawn = draw();
        while drawn.simplify() {}
        let off = (drawn.current() - 0.0_f32.clamp(low, high)).abs();
        assert!(off <= 1e-6 * low.abs().max(high.abs()), "{} of {low} to {high}", drawn.current());
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// Bodies overlap at random: a ball in the middle of a cloth, in another ball, in a wall. There may be no good way out,
    /// but there is no panic and no NaN.
    #[test]
    fn random_scenes_stay_finite(
        cloth in cloth(),
        rope in rope(),
        balls in balls(),
        obstacles in obstacles(),
        wind in vector(15.0),
        moves in proptest::collection::vec(vector(1.0), 4),
        dt in between(0.002, 0.04),
    ) {
        let mut island = Island { bodies: vec![cloth, rope], balls, ..Island::default() };
        let mut environment = Environment { wind: Wind::new(wind), obstacles: obstacles.into(), ..gravity(dt) };
        run_scene(&mut island, &mut environment, &moves, |_| Ok(()))?;
    }

    /// Balls from outside hit, slide and rest, and throw nothing. The bound for cloth is its worst case: a heavy ball
    /// stretches slack sticks by a metre and lets go, and tethers bring them back in one substep.
    #[test]
    fn random_shots_throw_nothing(
        cloth in cloth(),
        rope in rope(),
        balls in shots(),
        obstacles in obstacles(),
        wind in vector(15.0),
        moves in proptest::collection::vec(vector(1.0), 4),
        dt in between(0.002, 0.04),
    ) {
        let mut island = Island { bodies: vec![cloth, rope], balls, ..Island::default() };
        let mut environment = Environment { wind: Wind::new(wind), obstacles: obstacles.into(), ..gravity(dt) };
        run_scene(&mut island, &mut environment, &moves, |island| {
            let (bodies, balls) = fastest(island);
            prop_assert!(bodies < 1000.0, "a particle at {bodies} m/s");
            prop_assert!(balls < 60.0, "a ball at {balls} m/s");
            Ok(())
        })?;
    }

    /// Free bodies and balls in random motion, which collide only with each other, keep their momentum.
    #[test]
    fn random_hits_keep_momentum(
        cloth in cloth(),
        balls in balls(),
        velocity in vector(5.0),
    ) {
        let mut island = Island { bodies: vec![cloth], balls, ..Island::default() };
        let body = &mut island.bodies[0];
        body.settings.drag = 0.0;
        for i in 0..body.particles.len() {
            body.particles.set_inverse_mass(i, 100.0);
            body.particles.set_velocity(i, velocity);
        }
        let before = momentum(&island);
        let size: f64 = 0.01 * 5.0 * particles(&island).len() as f64
            + island.balls.iter().map(|b| f64::from(b.material().mass * 25.0)).sum::<f64>();
        run(&mut island, &weightless(FRAME), 0.5);
        let error = (momentum(&island) - before).length();
        prop_assert!(error < 2e-5 * size, "{error} kg m/s of {size}");
    }
}
