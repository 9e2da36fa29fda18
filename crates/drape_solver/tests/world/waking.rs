//! Forces, edits and moving bodies wake bodies at rest.

use drape_solver::glam::Vec3;
use drape_solver::{
    Activity, Layers, Placement, SelfContact, Turbulence, Wind, WindFlow, WindRegion, WindZone,
};

use crate::common::*;

#[test]
fn a_force_wakes() {
    let (mut world, curtain) = sleeping_curtain();
    let before = centre(&world[curtain]);
    let body = world.body_mut(curtain).expect("it is there");
    body.particles.add_force(LOWER_EDGE, Vec3::Z * 0.5);
    assert_wakes(&mut world, curtain);
    assert!(centre(&world[curtain]).distance(before) > 1e-5);
}

#[test]
fn a_change_of_settings_wakes() {
    let (mut world, curtain) = sleeping_curtain();
    world.body_mut(curtain).expect("it is there").settings.iterations = 4;
    assert_wakes(&mut world, curtain);
}

#[test]
fn another_gravity_and_another_wind_wake() {
    let (mut world, curtain) = sleeping_curtain();
    world.gravity = Vec3::new(0.0, -9.0, 3.0);
    assert_wakes(&mut world, curtain);

    let (mut world, curtain) = sleeping_curtain();
    world.wind = Wind::new(Vec3::Z * 0.4);
    assert_wakes(&mut world, curtain);

    let (mut world, curtain) = sleeping_curtain();
    world.wind_zones.push(WindZone {
        region: WindRegion::Sphere(1.0),
        placement: Placement::at(Vec3::Y),
        flow: WindFlow::Along(Vec3::Z * 0.4),
        falloff: 0.0,
    });
    assert_wakes(&mut world, curtain);
}

#[test]
fn nothing_sleeps_in_gusts() {
    let (mut world, curtain) = sleeping_curtain();
    // The force is too weak to move anything.
    world.wind.turbulence = Turbulence { speed: 1e-3, ..Turbulence::default() };
    assert_wakes(&mut world, curtain);
    for _ in 0..600 {
        world.step().expect("a good step");
        // It falls asleep at the end of a step and wakes at the start of the next, so that each step moves it.
        assert_eq!(world.island_count(), 1);
    }
}

#[test]
fn a_ball_wakes_before_it_touches() {
    let (mut world, curtain) = sleeping_curtain();
    let ball = world.add_ball(ball(Vec3::new(0.0, 1.5, -6.0), Vec3::new(0.0, 1.9, 15.0)));
    let mut woken_at = None;
    let mut touched_at = None;
    for count in 0..60 {
        world.step().expect("a good step");
        if world.activity(curtain) == Some(Activity::Active) && woken_at.is_none() {
            woken_at = Some(count);
            let gap = -0.15 - world[ball].position().z;
            assert!(gap < 15.0 * world.dt + 0.1, "it woke while the ball was {gap} m away");
        }
        let touches = &world.events().touches;
        if let Some(touch) = touches.iter().find(|touch| touch.other == curtain.into())
            && touched_at.is_none()
        {
            assert_eq!(touch.ball, ball);
            touched_at = Some((count, f64::from(touch.touch.time) + world.time() - f64::from(world.dt)));
        }
    }
    let (touched_in, time) = touched_at.expect("a hit");
    assert!(woken_at.expect("it wakes") <= touched_in);
    // The ball reaches the curtain's plane after 5.85 m at 15 m/s.
    let start = world.time() - 1.0;
    assert!((time - start - 5.845 / 15.0).abs() < 0.01, "hit after {} s", time - start);
}

#[test]
fn a_ball_that_flies_past_wakes_nothing_nor_does_one_of_another_layer() {
    let (mut world, curtain) = sleeping_curtain();
    let past = world.add_ball(ball(Vec3::new(1.2, 1.5, -6.0), Vec3::Z * 15.0));
    let mut ghost = ball(Vec3::new(0.0, 1.5, -6.0), Vec3::Z * 15.0);
    ghost.set_layers(Layers::NONE);
    world.add_ball(ghost);
    for _ in 0..60 {
        world.step().expect("a good step");
        assert_eq!(world.activity(curtain), Some(Activity::Resting));
    }
    assert!(world[past].position().z > 5.0);
}

#[test]
fn a_whole_row_of_balls_wakes_at_once() {
    let mut world = on_ground();
    let row = [0.0, 1.0, 2.0, 3.0].map(|i| world.add_ball(ball(Vec3::new(0.31 * i, 0.15, 0.0), Vec3::ZERO)));
    for id in row {
        if world.activity(id) != Some(Activity::Resting) {
            settle(&mut world, id);
        }
    }
    world.add_ball(ball(Vec3::new(-0.5, 0.15, 0.0), Vec3::X * 20.0));
    world.step().expect("a good step");
    assert!(row.iter().all(|&id| world.activity(id) == Some(Activity::Active)));
}

#[test]
fn a_sheet_wakes_when_the_ball_below_it_goes() {
    let mut world = on_ground();
    let below = world.add_ball(ball(Vec3::Y * 0.15, Vec3::ZERO));
    let sheet = world.add_body(sheet(Vec3::Y * 0.32));
    settle(&mut world, sheet);
    assert_eq!(world.activity(below), Some(Activity::Resting));
    assert!(world.remove_ball(below).is_some() && world.ball(below).is_none());
    assert_wakes(&mut world, sheet);
    settle(&mut world, sheet);
    let highest = world[sheet].particles.positions().map(|p| p.y).fold(0.0, f32::max);
    assert!(highest < 0.1, "it lies on the ground: {highest} m");
}

#[test]
fn what_lay_on_something_that_is_taken_away_or_lifted_wakes() {
    for lifted in [false, true] {
        let mut world = on_ground();
        let layered = |height: f32| {
            let mut body = sheet(Vec3::Y * height);
            body.settings.self_contact = SelfContact::On;
            body
        };
        let (lower, upper) = (world.add_body(layered(0.011)), world.add_body(layered(0.022)));
        settle(&mut world, upper);
        assert_eq!(world.counts().resting, 2);
        let before = centre(&world[upper]).y;
        if lifted {
            let body = world.body_mut(lower).expect("it is there");
            body.particles.translate(Vec3::X * 10.0);
        } else {
            assert!(world.remove_body(lower).is_some());
        }
        assert_wakes(&mut world, upper);
        assert!(centre(&world[upper]).y < before - 5e-3, "it sinks");
        assert_eq!(world.remove_body(lower).is_some(), lifted);
    }
}
