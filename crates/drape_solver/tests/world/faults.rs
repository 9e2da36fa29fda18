//! A world leaves out and names members that cannot be stepped; the rest goes on.

use std::sync::Arc;

use drape_solver::glam::Vec3;
use drape_solver::{Activity, Fault, StepError, Wind, World};

use crate::common::*;

#[test]
fn a_bad_body_is_left_out_and_the_rest_goes_on_as_without_it() {
    // The ball lies on both curtains, so all are in one island.
    let run = |breaks: bool| {
        let mut world = World::new();
        let [good, bad] = [0.0, 0.1].map(|z| world.add_body(curtain(Vec3::new(0.0, 2.0, z))));
        let thrown = world.add_ball(ball(Vec3::new(0.0, 1.5, -0.2), Vec3::Z * 3.0));
        if breaks {
            let particles = &mut world.body_mut(bad).expect("it is there").particles;
            particles.set_position(LOWER_EDGE, Vec3::NAN);
        } else {
            world.remove_body(bad);
        }
        world.step().expect("a good step");
        if breaks {
            assert_eq!(world.events().faults, [Fault::NonFiniteBody(bad)]);
            assert_eq!(world.activity(bad), Some(Activity::Culled));
        }
        steps(&mut world, 60);
        assert!(world.events().faults.is_empty(), "it is told once");
        (hash(&world[good]), world[thrown].position())
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn bad_settings_are_named_and_a_mended_body_goes_on() {
    let (mut world, curtain) = sleeping_curtain();
    world.body_mut(curtain).expect("it is there").settings.friction = -1.0;
    world.step().expect("a good step");
    let [fault @ Fault::BadSettings { body, .. }] = &world.events().faults[..] else {
        panic!("{:?}", world.events().faults);
    };
    assert_eq!(*body, curtain);
    assert!(fault.to_string().contains("friction"), "{fault}");
    world.body_mut(curtain).expect("it is there").settings.friction = 0.5;
    assert_wakes(&mut world, curtain);
}

#[test]
fn a_bad_ball_and_a_body_with_other_particles_are_left_out() {
    let mut world = on_ground();
    let good = world.add_body(sheet(Vec3::Y));
    let thrown = world.add_ball(ball(Vec3::new(0.0, 1.2, 0.0), Vec3::ZERO));
    let empty = world.add_body(Default::default());
    let other = sheet(Vec3::X * 3.0);
    let torn = world.add_body(curtain(Vec3::X * 6.0));
    let small = drape_solver::ClothBuilder::new(1.0, 1.0, 5, 5).build(other.settings).expect("valid");
    world.body_mut(torn).expect("it is there").topology = Arc::clone(&small.topology);
    world.ball_mut(thrown).expect("it is there").set_velocity(Vec3::INFINITY);
    world.step().expect("a good step");
    let mut faults = world.events().faults.clone();
    faults.sort_by_key(Fault::member);
    assert_eq!(
        faults,
        [
            Fault::WrongParticles { body: empty, particles: 0, joined: 0 },
            Fault::WrongParticles { body: torn, particles: 81, joined: 25 },
            Fault::NonFiniteBall(thrown),
        ]
    );
    steps(&mut world, 30);
    assert!(centre(&world[good]).y < 0.9, "the sheet falls");
}

#[test]
fn bad_surroundings_move_nothing_and_harm_nothing() {
    let mut world = World::new();
    let curtain = world.add_body(curtain(Vec3::Y * 2.0));
    let before = hash(&world[curtain]);
    for (dt, gravity, wind) in [
        (0.0, Vec3::ZERO, Wind::default()),
        (f32::NAN, Vec3::ZERO, Wind::default()),
        (0.01, Vec3::NAN, Wind::default()),
        (0.01, Vec3::ZERO, Wind::new(Vec3::INFINITY)),
    ] {
        (world.dt, world.gravity, world.wind) = (dt, gravity, wind);
        assert!(world.step().is_err());
        assert_eq!(hash(&world[curtain]), before);
    }
    world.dt = -1.0;
    assert_eq!(world.step(), Err(StepError::BadTimestep(-1.0)));
    let good = World::new();
    (world.dt, world.gravity, world.wind) = (good.dt, good.gravity, good.wind);
    steps(&mut world, 1);
    assert_ne!(hash(&world[curtain]), before);
    assert_eq!(world.time(), f64::from(good.dt));
}
