//! Bodies outside the play area are culled, and so are sleeping bodies far from every viewer.

use drape_solver::Activity;
use drape_solver::World;
use drape_solver::glam::Vec3;

use crate::common::*;

#[test]
fn a_ball_that_leaves_the_play_area_is_culled_where_it_is() {
    let mut world = World::new();
    world.rules.play_area_min = Vec3::splat(-10.0);
    let ball = world.add_ball(ball(Vec3::ZERO, Vec3::ZERO));
    steps(&mut world, 240);
    assert_eq!(world.activity(ball), Some(Activity::Culled));
    assert_eq!(world.island_count(), 0);
    let place = world[ball].position();
    assert!(place.y < -10.0 && place.y > -11.0, "{place}");
    steps(&mut world, 60);
    assert_eq!(world[ball].position(), place);
    // A larger area brings it back.
    world.rules.play_area_min = Vec3::splat(-100.0);
    steps(&mut world, 2);
    assert_eq!(world.activity(ball), Some(Activity::Active));
    assert!(world[ball].position().y < place.y);
}

#[test]
fn sleepers_far_from_every_viewer_are_culled_until_one_comes_near() {
    let (mut world, curtain) = sleeping_curtain();
    world.viewers = vec![Vec3::X * 300.0, Vec3::Z * 300.0];
    steps(&mut world, 1);
    assert_eq!(world.activity(curtain), Some(Activity::Culled));
    let before = hash(&world[curtain]);
    world.viewers[1] = Vec3::Z * 100.0;
    steps(&mut world, 1);
    assert_eq!(world.activity(curtain), Some(Activity::Resting));
    assert_eq!(hash(&world[curtain]), before);
    // It can wake again as before.
    world.add_ball(ball(Vec3::new(0.0, 1.5, -0.25), Vec3::Z * 5.0));
    steps(&mut world, 1);
    assert_eq!(world.activity(curtain), Some(Activity::Active));
}

#[test]
fn an_edit_of_what_is_culled_wakes_it_when_it_comes_back() {
    let (mut world, curtain) = sleeping_curtain();
    world.viewers = vec![Vec3::X * 300.0];
    steps(&mut world, 1);
    world.body_mut(curtain).expect("it is there").particles.apply_impulse(LOWER_EDGE, Vec3::Z * 0.01);
    steps(&mut world, 10);
    assert_eq!(world.activity(curtain), Some(Activity::Culled));
    world.viewers.clear();
    steps(&mut world, 2);
    assert_eq!(world.activity(curtain), Some(Activity::Active));
}

#[test]
fn what_is_held_still_is_touched_by_nothing() {
    let mut world = World::new();
    let curtain = world.add_body(curtain(Vec3::Y * 2.0));
    world.set_activity(curtain, Activity::Frozen);
    let before = hash(&world[curtain]);
    let ball = world.add_ball(ball(Vec3::new(0.0, 1.7, -1.0), Vec3::Z * 10.0));
    steps(&mut world, 30);
    assert_eq!(hash(&world[curtain]), before);
    assert!(world[ball].velocity().z > 9.99 && world[ball].position().z > 3.0);
}
