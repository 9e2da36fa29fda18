//! Bad input is rejected with a typed error and never panics. A rejected step moves nothing.

use drape_solver::glam::{IVec3, Quat, Vec3};
use drape_solver::parry3d::math::Pose;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::parry3d::utils::Array2;
use drape_solver::{
    Ball, BallMaterial, BodySettings, BuildError, ClothBuilder, Edge, Environment, Island, Obstacle,
    Particles, Placement, RopeBuilder, Shape, StepError, Wind, step,
};

use crate::common::*;

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

fn scene() -> Island {
    // Miri takes seconds for a substep.
    let (count, duration) = if cfg!(miri) { (5, FRAME) } else { (6, 0.1) };
    let curtain =
        ClothBuilder::new(1.0, 1.0, count, count).pin_edge(Edge::Top).build(BodySettings::default());
    let mut island = Island::of_body(curtain.expect("valid"));
    island.balls.push(ball(BallMaterial::default(), Vec3::new(0.5, -0.5, 1.0), Vec3::NEG_Z));
    run(&mut island, &gravity(FRAME), duration);
    island
}

/// Asserts that a step is rejected and moves nothing, and that the next step is good again.
#[track_caller]
fn refused(environment: &Environment) -> StepError {
    let mut island = scene();
    let before = hash(&island);
    let error = step(&mut island, environment).expect_err("must be refused");
    assert_eq!(hash(&island), before, "nothing has moved");
    step(&mut island, &gravity(FRAME)).expect("and the next step is good");
    assert!(!error.to_string().is_empty());
    error
}

#[test]
fn a_bad_time_step_is_refused() {
    for dt in [0.0, -0.0, -1.0 / 60.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert!(matches!(refused(&gravity(dt)), StepError::BadTimestep(_)), "{dt}");
    }
}

#[test]
fn bad_gravity_wind_and_time_are_refused() {
    for bad in BAD {
        let environment = Environment { time: f64::from(bad), ..gravity(FRAME) };
        assert_eq!(refused(&environment), StepError::BadEnvironment("time"));
        let environment = Environment { gravity: Vec3::new(0.0, bad, 0.0), ..gravity(FRAME) };
        assert_eq!(refused(&environment), StepError::BadEnvironment("gravity"));
        let fields = [
            Wind { velocity: Vec3::X * bad, ..Wind::default() },
            Wind { air_density: bad, ..Wind::new(Vec3::X) },
            Wind { drag_coefficient: bad, ..Wind::new(Vec3::X) },
        ];
        for wind in fields {
            let environment = Environment { wind, ..gravity(FRAME) };
            assert_eq!(refused(&environment), StepError::BadEnvironment("wind"));
        }
    }
}

/// Absurd but finite gravity and wind are either rejected or survived.
#[test]
#[cfg_attr(miri, ignore = "many substeps")]
fn absurd_but_finite_environments_do_no_harm() {
    for size in [1e10, 1e20, f32::MAX] {
        for environment in [
            Environment { gravity: Vec3::NEG_Y * size, ..gravity(FRAME) },
            Environment { wind: Wind::new(Vec3::Z * size), ..gravity(FRAME) },
            gravity(size),
        ] {
            let mut island = scene();
            if step(&mut island, &environment).is_ok() {
                assert!(particles(&island).is_finite() && island.balls[0].is_finite());
            }
        }
    }
}

#[test]
fn bad_settings_are_refused_when_set_after_building() {
    let good = BodySettings::default();
    for settings in [
        BodySettings { substeps: 0, ..good },
        BodySettings { substeps: u32::MAX, ..good },
        BodySettings { iterations: 0, ..good },
        BodySettings { iterations: u32::MAX, ..good },
        BodySettings { drag: f32::NAN, ..good },
        BodySettings { drag: -1.0, ..good },
        BodySettings { friction: f32::INFINITY, ..good },
        BodySettings { thickness: -1.0, ..good },
    ] {
        let mut island = scene();
        island.bodies[0].settings = settings;
        let before = hash(&island);
        let error = step(&mut island, &gravity(FRAME)).expect_err("must be refused");
        assert!(matches!(error, StepError::BadSettings { body: 0, .. }), "{error}");
        assert_eq!(hash(&island), before);
        assert!(ClothBuilder::new(1.0, 1.0, 4, 4).build(settings).is_err());
        assert!(RopeBuilder::new(Vec3::ZERO, Vec3::X, 4).build(settings).is_err());
    }
}

/// Bad values that a caller writes into a built body are found before anything moves.
#[test]
fn non_finite_states_are_found_and_named() {
    type Spoil = fn(&mut Island, f32);
    let spoils: [(Spoil, StepError); 9] = [
        (|i, bad| i.bodies[0].particles.set_position(9, Vec3::X * bad), StepError::NonFiniteBody(0)),
        (|i, bad| i.bodies[0].particles.set_velocity(9, Vec3::Y * bad), StepError::NonFiniteBody(0)),
        (|i, bad| i.bodies[0].particles.apply_impulse(9, Vec3::Z * bad), StepError::NonFiniteBody(0)),
        (|i, bad| i.bodies[0].particles.add_force(9, Vec3::Z * bad), StepError::NonFiniteBody(0)),
        (|i, bad| i.bodies[0].particles.set_pin_target(0, Vec3::splat(bad)), StepError::NonFiniteBody(0)),
        (|i, bad| i.balls[0].set_position(Vec3::X * bad), StepError::NonFiniteBall(0)),
        (|i, bad| i.balls[0].set_velocity(Vec3::X * bad), StepError::NonFiniteBall(0)),
        (|i, bad| i.balls[0].set_spin(Vec3::X * bad), StepError::NonFiniteBall(0)),
        (|i, bad| i.balls[0].add_force(Vec3::X * bad), StepError::NonFiniteBall(0)),
    ];
    for bad in BAD {
        for (index, (spoil, expected)) in spoils.iter().enumerate() {
            let mut island = scene();
            spoil(&mut island, bad);
            let before = hash(&island);
            assert_eq!(step(&mut island, &gravity(FRAME)).as_ref(), Err(expected), "case {index}");
            assert_eq!(hash(&island), before, "case {index}: nothing has moved");
        }
    }
    let mut island = scene();
    island.bodies[0].particles.translate(Vec3::X * f32::NAN);
    assert_eq!(step(&mut island, &gravity(FRAME)), Err(StepError::NonFiniteBody(0)));
}

/// A fuzzed checkpoint put a particle so far away that the area of its faces was NaN, and wind on them panicked, as
/// `f32::clamp` does with NaN limits. The step rejects such a state.
#[test]
fn wind_on_a_face_without_a_finite_area_does_not_panic() {
    for far in [1e13, 1e20, 1e30, f32::MAX] {
        let curtain = ClothBuilder::new(1.0, 1.0, 4, 4).pin_edge(Edge::Top).build(BodySettings::default());
        let mut island = Island::of_body(curtain.expect("valid"));
        // Both are corners of one face, whose normal is NaN.
        island.bodies[0].particles.set_position(9, Vec3::X * far);
        island.bodies[0].particles.set_position(10, Vec3::Y * far);
        let wind = Wind { lift_coefficient: 1.0, ..Wind::new(Vec3::X * 5.0) };
        let environment = Environment { wind, ..gravity(FRAME) };
        let outcome = (0..3).try_for_each(|_| step(&mut island, &environment));
        assert!(outcome.is_err() || particles(&island).is_finite(), "{far}");
    }
}

#[test]
fn bad_particles_are_refused() {
    for bad in BAD {
        assert!(Particles::new(Vec3::ZERO, &[Vec3::Y * bad], &[1.0]).is_err());
        assert!(Particles::new(Vec3::Y * bad, &[Vec3::Y], &[1.0]).is_err());
        assert!(Particles::new(Vec3::ZERO, &[Vec3::Y], &[bad]).is_err());
    }
    // A bad mass that is set later pins the particle, and spreads no NaN.
    let mut island = scene();
    for (i, bad) in [f32::NAN, f32::INFINITY, -1.0].into_iter().enumerate() {
        island.bodies[0].particles.set_inverse_mass(20 + i, bad);
        assert!(particles(&island).is_pinned(20 + i));
    }
    run(&mut island, &gravity(FRAME), 0.5);
}

#[test]
fn bad_cloths_and_ropes_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        assert!(ClothBuilder::new(bad, 1.0, 4, 4).build_parts().is_err());
        assert!(ClothBuilder::new(1.0, bad, 4, 4).build_parts().is_err());
        assert!(RopeBuilder::new(Vec3::ZERO, Vec3::X, 4).linear_density(bad).build_parts().is_err());
    }
    for (columns, rows) in [(0, 0), (1, 1), (1, 5), (5, 1)] {
        let error = ClothBuilder::new(1.0, 1.0, columns, rows).build_parts().expect_err("too few");
        assert!(matches!(error, BuildError::TooFewParticles { .. }), "{error}");
    }
    for count in [0, 1] {
        assert!(RopeBuilder::new(Vec3::ZERO, Vec3::X, count).build_parts().is_err());
    }
    // Particles so close that single precision cannot separate them.
    let error =
        ClothBuilder::new(1e-6, 1.0, 4000, 2).placed(Vec3::ONE * 1e3, Vec3::X, Vec3::NEG_Y).build_parts();
    assert!(matches!(error, Err(BuildError::ZeroRestLength { .. })), "{:?}", error.map(|_| ()));
}

#[test]
fn bad_obstacles_are_refused_and_bad_moves_ignored() {
    for bad in BAD {
        assert!(Obstacle::new(Shape::Sphere { radius: bad }, Placement::default(), 0.5).is_err());
        let sphere = || Shape::Sphere { radius: 1.0 };
        assert!(Obstacle::new(sphere(), Placement::at(Vec3::X * bad), 0.5).is_err());
        assert!(Obstacle::new(sphere(), Placement::default(), bad).is_err());
        let mut good = Obstacle::ground();
        good.move_to(Placement::at(Vec3::X * bad), FRAME);
        good.teleport(Placement { rotation: Quat::from_xyzw(0.0, bad, 0.0, 1.0), ..Placement::default() });
        assert_eq!(good.placement(), Placement::default());
    }
}

/// Two particles in one place, a ball in the middle of another, an obstacle on top of a particle.
#[test]
#[cfg_attr(miri, ignore = "many substeps")]
fn coincident_things_stay_finite() {
    let mut island = scene();
    let place = particles(&island).position(14);
    for i in [15, 20, 21] {
        island.bodies[0].particles.set_position(i, place);
    }
    let twin = island.balls[0].clone();
    island.balls.push(twin);
    let obstacles = vec![obstacle(Shape::Sphere { radius: 0.2 }, place, 0.5)];
    let environment = Environment { obstacles: obstacles.into(), ..gravity(FRAME) };
    run_with(&mut island, &environment, 1.0, |island, _| assert!(greatest_speed(island) < 50.0));
}

/// A frame hitch: one step of ten seconds stays finite, and the scene goes on.
#[test]
#[cfg_attr(miri, ignore = "many substeps")]
fn a_step_of_ten_seconds_is_survived() {
    let mut island = scene();
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(10.0) };
    step(&mut island, &environment).expect("long, but good");
    run(&mut island, &gravity(FRAME), 1.0);
    assert!(particles(&island).is_finite() && greatest_speed(&island) < 500.0);
}

#[test]
fn an_island_of_nothing_steps() {
    let mut island = Island::default();
    step(&mut island, &gravity(FRAME)).expect("nothing to do");
    let mut pinned = scene();
    for i in 0..particles(&pinned).len() {
        pinned.bodies[0].particles.set_inverse_mass(i, 0.0);
    }
    run(&mut pinned, &gravity(FRAME), 0.5);
}

#[test]
fn bad_balls_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        for material in [
            BallMaterial { radius: bad, ..BallMaterial::default() },
            BallMaterial { mass: bad, ..BallMaterial::default() },
        ] {
            assert!(Ball::new(material, Vec3::ZERO, Vec3::ZERO).is_err());
        }
        let launched = |v: Vec3, a: Vec3, h: f32| Ball::launch(BallMaterial::default(), Vec3::ZERO, v, a, h);
        assert!(launched(Vec3::X, Vec3::NEG_Y, bad).is_err());
    }
}

/// Shapes as in files and editors: each is rejected with an error that gives the reason.
#[test]
fn shapes_that_cannot_be_are_refused() {
    let mesh = |corners: &[Vec3], triangles: &[[u32; 3]]| {
        SharedShape::trimesh(corners.to_vec(), triangles.to_vec()).ok()
    };
    let field = |bad: f32| {
        SharedShape::heightfield(Array2::new(2, 2, vec![0.0, bad, 0.0, 0.0]), Vec3::new(1.0, 1.0, 1.0))
    };
    let flat = SharedShape::heightfield(Array2::new(3, 3, vec![0.0; 9]), Vec3::new(1.0, 1.0, 0.0));
    let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
    let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Z, Vec3::Z];
    let here = Pose::IDENTITY;
    let shapes = [
        ("no triangles", mesh(&square, &[])),
        ("triangles on a line", mesh(&line, &[[0, 1, 2]])),
        ("triangles of one corner", mesh(&line, &[[0, 0, 0], [1, 1, 2]])),
        ("a corner that is not finite", mesh(&[Vec3::ZERO, Vec3::X, Vec3::NAN], &[[0, 1, 2]])),
        ("a corner at infinity", mesh(&[Vec3::ZERO, Vec3::X, Vec3::Y * f32::INFINITY], &[[0, 1, 2]])),
        ("a hull of a line", SharedShape::convex_hull(&line)),
        ("a height that is no number", Some(field(f32::NAN))),
        ("a height without end", Some(field(f32::INFINITY))),
        ("a field without a width", Some(flat)),
        ("a ball of no size", Some(SharedShape::ball(0.0))),
        ("a ball of less than no size", Some(SharedShape::ball(-1.0))),
        ("a ball that is not finite", Some(SharedShape::ball(f32::NAN))),
        ("a capsule of no radius", Some(SharedShape::capsule_y(1.0, 0.0))),
        ("a capsule of no radius, lying", Some(SharedShape::capsule_x(1.0, 0.0))),
        ("a capsule, lying, that is not finite", Some(SharedShape::capsule_x(1.0, f32::NAN))),
        ("a flat box", Some(SharedShape::cuboid(1.0, 0.0, 1.0))),
        ("a flat cylinder", Some(SharedShape::cylinder(0.0, 1.0))),
        ("a cone of no radius", Some(SharedShape::cone(1.0, 0.0))),
        ("a bad part", Some(SharedShape::compound(vec![(here, SharedShape::ball(0.0))]))),
        (
            "a part without a place",
            Some(SharedShape::compound(vec![(Pose::from_translation(Vec3::NAN), SharedShape::ball(1.0))])),
        ),
        ("a part without end", Some(SharedShape::compound(vec![(here, SharedShape::halfspace(Vec3::Y))]))),
        ("voxels of nothing", Some(SharedShape::voxels(Vec3::ONE, &[]))),
        ("voxels of no size", Some(SharedShape::voxels(Vec3::ZERO, &[IVec3::ZERO]))),
    ];
    for (case, shape) in shapes {
        // parry itself rejects the other invalid shapes.
        let Some(shape) = shape else { continue };
        let error = Shape::from_parry(shape).expect_err(case);
        assert!(!error.to_string().is_empty(), "{case}");
    }
    let slope = Shape::HalfSpace { normal: Vec3::Y * 2.0 };
    assert!(slope.validate().is_err() && Shape::HalfSpace { normal: Vec3::NAN }.validate().is_err());
}

/// The scale of every kind of shape must be finite and above zero, and its placement must be finite.
#[test]
fn bad_scales_and_places_of_shapes_are_refused() {
    let corners: Vec<Vec3> =
        (0..8).map(|i| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|b| b as f32))).collect();
    let heights = Array2::new(2, 2, vec![0.0; 4]);
    let parry = [
        SharedShape::ball(1.0),
        SharedShape::capsule_y(1.0, 0.5),
        SharedShape::cuboid(1.0, 1.0, 1.0),
        SharedShape::halfspace(Vec3::Y),
        SharedShape::cone(1.0, 1.0),
        SharedShape::convex_hull(&corners).expect("a cube"),
        SharedShape::heightfield(heights, Vec3::ONE),
        SharedShape::voxels(Vec3::ONE, &[IVec3::ZERO]),
        SharedShape::compound(vec![(Pose::IDENTITY, SharedShape::ball(1.0))]),
    ];
    let nowhere = [
        Placement::at(Vec3::NAN),
        Placement::at(Vec3::X * f32::INFINITY),
        Placement { rotation: Quat::from_array([0.0; 4]), ..Placement::default() },
        Placement { rotation: Quat::from_array([f32::NAN; 4]), ..Placement::default() },
    ];
    let tapered = Shape::TaperedCapsule { half_length: 1.0, bottom_radius: 0.5, top_radius: 0.3 };
    let parry = parry.map(|shape| Shape::from_parry(shape).expect("valid"));
    for shape in parry.into_iter().chain([tapered]) {
        for bad in [0.0, -0.0, -1.0, f32::NAN, f32::INFINITY] {
            for scale in [Vec3::splat(bad), Vec3::new(1.0, bad, 1.0)] {
                assert!(shape.scaled(scale).is_err(), "{shape:?} by {scale}");
            }
        }
        for placement in nowhere {
            assert!(Obstacle::new(shape.clone(), placement, 0.5).is_err(), "{shape:?} at {placement:?}");
        }
        assert!(Obstacle::new(shape.clone(), Placement::default(), f32::NAN).is_err());
    }
}
