//! The result of an island depends neither on other islands, nor on order or threads.

use drape_solver::glam::Vec3;
use drape_solver::{
    Environment, Island, Obstacle, RigidBody, SelfContact, Shape, StateHasher, Threads, World, step,
};

use crate::common::*;

/// Threads of the standard library, a new one for each call.
struct Fresh(usize);

impl Threads for Fresh {
    fn count(&self) -> usize {
        self.0
    }

    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        // It has no threads.
        if cfg!(target_family = "wasm") {
            one();
            other();
            return;
        }
        std::thread::scope(|scope| {
            scope.spawn(other);
            one();
        });
    }
}

#[test]
fn two_far_bodies_are_stepped_as_if_each_were_alone() {
    let places = [Vec3::Y * 1.2, Vec3::new(5.0, 0.5, 0.0)];
    let mut world = on_ground();
    let curtains = places.map(|top| world.add_body(curtain(top)));
    // Keeps all awake, as a lone island has no sleep.
    world.rules.sleeping = false;
    steps(&mut world, 120);
    assert_eq!(world.island_count(), 2);
    let environment = Environment { obstacles: [Obstacle::ground()].into(), ..Environment::default() };
    for (i, top) in places.into_iter().enumerate() {
        let mut island = Island::of_body(curtain(top));
        (0..120).for_each(|_| step(&mut island, &environment).expect("a good step"));
        assert_eq!(hash(&world[curtains[i]]), hash(&island.bodies[0]));
    }
}

#[test]
fn two_far_hits_do_not_know_of_each_other() {
    let hit_at = |world: &mut World, top: Vec3| {
        let thrown = world.add_ball(ball(top + Vec3::new(0.0, -0.5, -1.0), Vec3::Z * 5.0));
        (world.add_body(curtain(top)), thrown)
    };
    let places = [Vec3::Y * 1.2, Vec3::new(5.0, 1.2, 0.0)];
    let mut world = on_ground();
    let pairs = places.map(|top| hit_at(&mut world, top));
    steps(&mut world, 120);
    for (top, (body, thrown)) in places.into_iter().zip(pairs) {
        let mut alone = on_ground();
        let (lone_body, lone_ball) = hit_at(&mut alone, top);
        steps(&mut alone, 120);
        assert_eq!(hash(&world[body]), hash(&alone[lone_body]));
        let hash_of_ball = |ball| StateHasher::new().ball(ball).finish();
        assert_eq!(hash_of_ball(&world[thrown]), hash_of_ball(&alone[lone_ball]));
        assert!(world[thrown].velocity().z < 4.0, "the ball has hit the curtain");
    }
}

/// Hashes by place of eight curtains, each hit by a ball. They were added in the order of `places`.
fn hashes(places: [usize; 8], threads: &dyn Threads) -> [u64; 8] {
    let mut world = on_ground();
    let mut ids = [None; 8];
    for place in places {
        let top = Vec3::new(3.0 * place as f32, 1.5, 0.0);
        world.add_ball(ball(top + Vec3::new(0.1, -0.5, -1.0), Vec3::Z * (3.0 + place as f32)));
        ids[place] = Some(world.add_body(curtain(top)));
    }
    (0..100).for_each(|_| world.step_on(threads).expect("a good step"));
    ids.map(|id| hash(&world[id.expect("each place once")]))
}

#[test]
fn neither_order_nor_threads_change_what_is_far_apart() {
    let in_order = [0, 1, 2, 3, 4, 5, 6, 7];
    let expected = hashes(in_order, &Fresh(1));
    assert_eq!(hashes([5, 3, 0, 7, 1, 2, 6, 4], &Fresh(1)), expected);
    for count in [2, 3, 8] {
        assert_eq!(hashes(in_order, &Fresh(count)), expected, "{count} threads");
    }
}

#[test]
fn what_can_touch_is_in_one_island() {
    let mut world = World::new();
    world.gravity = Vec3::ZERO;
    let layered = |top: Vec3| {
        let mut body = curtain(top);
        body.settings.self_contact = SelfContact::On;
        body
    };
    world.add_body(curtain(Vec3::ZERO));
    world.add_body(curtain(Vec3::Z * 0.01));
    steps(&mut world, 1);
    assert_eq!(world.island_count(), 2, "they pass through each other");
    let first = world.add_body(layered(Vec3::X * 5.0));
    world.add_body(layered(Vec3::new(5.0, 0.0, 0.01)));
    steps(&mut world, 1);
    assert_eq!(world.island_count(), 3, "these two touch");
    world.remove_body(first);
    steps(&mut world, 1);
    assert_eq!(world.island_count(), 3);
    world.add_ball(ball(Vec3::new(0.0, -0.5, 0.2), Vec3::ZERO));
    steps(&mut world, 1);
    assert_eq!(world.island_count(), 2, "the ball touches both of the first");
}

/// A dynamic rod between two balls joins their islands, as a push at one end moves the other end.
#[test]
fn a_dynamic_obstacle_joins_what_it_touches_and_keeps_momentum() {
    let mut world = World::new();
    world.gravity = Vec3::ZERO;
    let rod = Shape::Cuboid { half_extents: Vec3::new(2.0, 0.1, 0.1) };
    let rod = Obstacle::new(rod, Default::default(), 0.5).expect("valid");
    let rod = world.add_obstacle(rod.with_rigid_body(RigidBody::new(3.0, Vec3::ONE).expect("valid")));
    let balls = [-1.8_f32, 1.8].map(|x| world.add_ball(ball(Vec3::new(x, 0.0, -1.0), Vec3::Z * 6.0)));
    steps(&mut world, 1);
    assert_eq!(world.island_count(), 2, "not there yet");
    let mut joined = 0;
    for _ in 0..30 {
        steps(&mut world, 1);
        joined += u32::from(world.island_count() == 1);
        let rigid_body = world[rod].rigid_body().expect("its own");
        let momentum =
            balls.map(|id| world[id].velocity() * 2.0).iter().sum::<Vec3>() + rigid_body.velocity * 3.0;
        assert!((momentum - Vec3::Z * 24.0).length() < 1e-4, "{momentum}");
    }
    assert!(joined > 0, "both are near the rod at once");
    let velocity = world[rod].rigid_body().expect("its own").velocity;
    assert!(velocity.z > 2.0, "it flies on: {velocity}");
    let place = world[rod].placement().translation;
    assert!(place.z > 0.3, "it has flown: {place}");
}
