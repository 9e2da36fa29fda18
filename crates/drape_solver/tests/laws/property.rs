//! Random small scenes: whatever is put together, no step panics, makes NaN, or throws anything.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{
    Ball, BallMaterial, Body, ClothBuilder, ClothMaterial, Environment, Island, Obstacle, Placement,
    RopeBuilder, Shape, SolverSettings, StickProjection, Wind, step,
};
use proptest::prelude::*;

use crate::common::*;

fn vector(half: f32) -> impl Strategy<Value = Vec3> {
    (-half..half, -half..half, -half..half).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn settings() -> impl Strategy<Value = SolverSettings> {
    (1_u32..6, 1_u32..4, 0.0_f32..3.0, 0.0_f32..1.5, 0.0_f32..0.03, any::<bool>(), any::<bool>()).prop_map(
        |(substeps, iterations, drag, friction, thickness, exact, tethers)| SolverSettings {
            substeps,
            iterations,
            drag,
            friction,
            thickness,
            projection: if exact { StickProjection::Exact } else { StickProjection::SquareRootFree },
            tethers,
        },
    )
}

fn cloth() -> impl Strategy<Value = Body> {
    let stiffness = || 0.0_f32..=1.0;
    let material = (stiffness(), stiffness(), stiffness(), 0.0_f32..20.0);
    (settings(), material, 2_u32..9, 2_u32..9, 0.2_f32..2.0, vector(1.0), proptest::bits::u32::masked(0xffff))
        .prop_map(|(settings, (structural, shear, bend, damping), columns, rows, size, origin, pins)| {
            let material = ClothMaterial { structural, shear, bend, damping, ..ClothMaterial::default() };
            ClothBuilder::new(size, size, columns, rows)
                .placed(origin, Vec3::X, Vec3::Z)
                .material(material)
                .pin_where(|column, row, _| pins >> ((row * columns + column) % 32) & 1 == 1)
                .build(settings)
                .expect("valid")
        })
}

fn rope() -> impl Strategy<Value = Body> {
    (settings(), vector(1.0), vector(1.0), 2_u32..20, 0.0_f32..=1.0, 0.0_f32..=1.0).prop_map(
        |(settings, start, way, count, stretch, bend)| {
            RopeBuilder::new(start, start + way + Vec3::X * 1.1, count)
                .stiffness(stretch, bend)
                .pin_start()
                .build(settings)
                .expect("valid")
        },
    )
}

fn balls() -> impl Strategy<Value = Vec<Ball>> {
    let ball = (0.03_f32..0.4, 0.01_f32..10.0, 0.0_f32..1.0, vector(1.5), vector(25.0), vector(20.0))
        .prop_map(|(radius, mass, friction, position, velocity, spin)| {
            let material = BallMaterial { radius, mass, friction, ..BallMaterial::default() };
            let mut ball = Ball::new(material, position, velocity).expect("valid");
            ball.set_spin(spin);
            ball
        });
    proptest::collection::vec(ball, 0..4)
}

fn obstacles() -> impl Strategy<Value = Vec<Obstacle>> {
    let size = || 0.05_f32..0.8;
    let shape = prop_oneof![
        size().prop_map(|radius| Shape::Sphere { radius }),
        (size(), size()).prop_map(|(half_length, radius)| Shape::Capsule { half_length, radius }),
        (size(), size(), size()).prop_map(|(x, y, z)| Shape::Cuboid { half_extents: Vec3::new(x, y, z) }),
        Just(Shape::HalfSpace { normal: Vec3::Y }),
        (2.0_f32..4.0).prop_map(|half| Shape::Container { half_extents: Vec3::splat(half) }),
        (size(), size()).prop_map(|(half, radius)| Shape::Parry(SharedShape::cylinder(half, radius))),
        (size(), size()).prop_map(|(half, radius)| Shape::Parry(SharedShape::cone(half, radius))),
    ];
    let placement = (vector(1.5), vector(3.0)).prop_map(|(translation, turn)| Placement {
        translation: translation - Vec3::Y,
        rotation: Quat::from_scaled_axis(turn),
    });
    let obstacle = (shape, placement, 0.0_f32..1.5)
        .prop_map(|(shape, placement, friction)| Obstacle::new(shape, placement, friction).expect("valid"));
    proptest::collection::vec(obstacle, 0..4)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Speeds stay below what the start, gravity, wind and the moving obstacles can explain several times over.
    #[test]
    fn random_scenes_stay_finite_and_slow(
        cloth in cloth(),
        rope in rope(),
        balls in balls(),
        obstacles in obstacles(),
        wind in vector(15.0),
        moves in proptest::collection::vec(vector(0.3), 4),
        dt in 0.002_f32..0.04,
    ) {
        let mut island = Island { bodies: vec![cloth, rope], balls, ..Island::default() };
        let mut environment =
            Environment { wind: Wind::new(wind), obstacles, ..gravity(dt) };
        for index in 0..40 {
            // The obstacles walk about, and one of them jumps half way through.
            for (obstacle, way) in environment.obstacles.iter_mut().zip(&moves) {
                let sign = if index % 20 < 10 { 0.1 } else { -0.1 };
                let mut placement = obstacle.placement();
                placement.translation += *way * sign;
                if index == 20 { obstacle.teleport(placement) } else { obstacle.move_to(placement, dt) }
            }
            step(&mut island, &environment).expect("a good step");
            for body in &island.bodies {
                let speed = body.particles.greatest_speed();
                prop_assert!(speed < 300.0, "{speed} m/s at step {index}");
            }
            for ball in &island.balls {
                let speed = ball.velocity().length();
                prop_assert!(speed < 100.0, "a ball at {speed} m/s at step {index}");
            }
        }
    }

    /// Free bodies and balls in random motion, in collision with each other only, keep their momentum.
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
