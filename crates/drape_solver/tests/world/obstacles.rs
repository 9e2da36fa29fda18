//! Obstacles that appear, move, change or vanish wake nearby bodies.

use drape_solver::glam::Vec3;
use drape_solver::{Activity, BodyId, Obstacle, ObstacleId, Placement, Shape, World};

use crate::common::*;

fn cuboid(half_extents: Vec3, centre: Vec3) -> Obstacle {
    Obstacle::new(Shape::Cuboid { half_extents }, Placement::at(centre), 0.5).expect("valid")
}

fn sphere(radius: f32, centre: Vec3) -> Obstacle {
    Obstacle::new(Shape::Sphere { radius }, Placement::at(centre), 0.5).expect("valid")
}

/// A cloth asleep on a table 1 m high, and the table.
fn cloth_on_table() -> (World, BodyId, ObstacleId) {
    let mut world = World::new();
    let table = world.add_obstacle(cuboid(Vec3::new(1.0, 0.05, 1.0), Vec3::Y * 0.95));
    let cloth = world.add_body(sheet(Vec3::Y * 1.02));
    settle(&mut world, cloth);
    (world, cloth, table)
}

#[test]
fn an_obstacle_that_is_taken_away_wakes() {
    let (mut world, cloth, table) = cloth_on_table();
    assert!(world.remove_obstacle(table).is_some());
    assert!(world.obstacle(table).is_none() && world.remove_obstacle(table).is_none());
    assert_wakes(&mut world, cloth);
    assert!(centre(&world[cloth]).y < 0.9, "it falls");
}

#[test]
fn an_obstacle_that_moves_wakes_and_stands_still_after_the_step() {
    let (mut world, cloth, table) = cloth_on_table();
    let dt = world.dt;
    let lifted = Placement::at(Vec3::Y * 1.0);
    world.obstacle_mut(table).expect("it is there").move_to(lifted, dt);
    assert_wakes(&mut world, cloth);
    assert_eq!(world[table].placement(), lifted);
    assert!(!world[table].is_moving());
    settle(&mut world, cloth);
    assert!((centre(&world[cloth]).y - 1.06).abs() < 5e-3, "{}", centre(&world[cloth]));
}

#[test]
fn a_new_obstacle_wakes() {
    let (mut world, cloth, _) = cloth_on_table();
    world.add_obstacle(sphere(0.1, Vec3::Y * 1.05));
    assert_wakes(&mut world, cloth);
}

#[test]
fn an_obstacle_that_changes_its_shape_wakes() {
    let (mut world, cloth, table) = cloth_on_table();
    *world.obstacle_mut(table).expect("it is there") = sphere(0.05, Vec3::Y * 0.95);
    assert_wakes(&mut world, cloth);
}

#[test]
fn an_obstacle_elsewhere_lets_sleep() {
    let (mut world, cloth, _) = cloth_on_table();
    let other = world.add_obstacle(sphere(0.1, Vec3::X * 5.0));
    steps(&mut world, 3);
    world.obstacle_mut(other).expect("it is there").teleport(Placement::at(Vec3::X * 6.0));
    steps(&mut world, 3);
    world.remove_obstacle(other);
    steps(&mut world, 3);
    assert_eq!(world.activity(cloth), Some(Activity::Resting));
}

#[test]
fn an_obstacle_that_moves_in_wakes_and_pushes() {
    let (mut world, curtain) = sleeping_curtain();
    let knob = world.add_obstacle(sphere(0.2, Vec3::new(0.0, 1.4, -1.0)));
    steps(&mut world, 30);
    assert_eq!(world.activity(curtain), Some(Activity::Resting), "it is too far off");
    let dt = world.dt;
    for i in 1..=60 {
        let place = Placement::at(Vec3::new(0.0, 1.4, -1.0 + i as f32 / 60.0));
        world.obstacle_mut(knob).expect("it is there").move_to(place, dt);
        steps(&mut world, 1);
    }
    assert_eq!(world.activity(curtain), Some(Activity::Active));
    let gaps = world[curtain].particles.positions().map(|p| p.distance(Vec3::new(0.0, 1.4, 0.0)));
    assert!(gaps.fold(f32::INFINITY, f32::min) > 0.195, "it is pushed aside");
}

/// The last obstacle takes the index of a removed one. Names stay valid.
#[test]
fn names_outlive_the_removal_of_others() {
    let mut world = World::new();
    let [first, second, third] = [0.0, 1.0, 2.0].map(|x| world.add_obstacle(sphere(0.1, Vec3::X * x)));
    world.remove_obstacle(first);
    assert_eq!(world[third].placement().translation, Vec3::X * 2.0);
    assert_eq!(world[second].placement().translation, Vec3::X);
    world.obstacle_mut(third).expect("it is there").teleport(Placement::at(Vec3::X * 3.0));
    let fourth = world.add_obstacle(sphere(0.1, Vec3::X * 9.0));
    assert!(world.obstacle(first).is_none() && fourth != first);
    let places: Vec<f32> =
        world.obstacles().map(|(_, obstacle)| obstacle.placement().translation.x).collect();
    assert_eq!(places, [3.0, 1.0, 9.0]);
    let hit = world.add_ball(ball(Vec3::new(9.0, 0.26, 0.0), Vec3::NEG_Y));
    steps(&mut world, 2);
    let touch = world.events().touches.first().expect("a hit");
    assert_eq!((touch.ball, touch.other), (hit, fourth.into()));
}
