//! Bodies that the tests share.

use drape_solver::glam::Vec3;
use drape_solver::{
    Activity, Ball, BallMaterial, Body, BodyId, BodySettings, ClothBuilder, Edge, MemberId, Obstacle,
    StateHasher, World,
};

/// Index of the middle of a [curtain](curtain)'s lower edge.
pub const LOWER_EDGE: usize = 8 * 9 + 4;

/// A curtain of a square metre that hangs from `top` and swings little.
pub fn curtain(top: Vec3) -> Body {
    ClothBuilder::new(1.0, 1.0, 9, 9)
        .placed(top - Vec3::X * 0.5, Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(quiet())
        .expect("a valid curtain")
}

/// A free cloth of a square metre that lies level at `centre`.
pub fn sheet(centre: Vec3) -> Body {
    ClothBuilder::new(1.0, 1.0, 9, 9)
        .placed(centre - Vec3::new(0.5, 0.0, 0.5), Vec3::X, Vec3::Z)
        .build(quiet())
        .expect("a valid sheet")
}

fn quiet() -> BodySettings {
    BodySettings { drag: 4.0, thickness: 0.01, ..BodySettings::default() }
}

/// A ball of 2 kg and 15 cm.
pub fn ball(position: Vec3, velocity: Vec3) -> Ball {
    Ball::new(BallMaterial::default(), position, velocity).expect("a valid ball")
}

/// A world with the ground.
pub fn on_ground() -> World {
    let mut world = World::new();
    world.add_obstacle(Obstacle::ground());
    world
}

/// Takes `count` steps.
pub fn steps(world: &mut World, count: u32) {
    (0..count).for_each(|_| world.step().expect("a good step"));
}

/// Steps until `member` sleeps.
pub fn settle(world: &mut World, member: impl Into<MemberId>) {
    let member = member.into();
    for _ in 0..3600 {
        world.step().expect("a good step");
        if world.activity(member) == Some(Activity::Resting) {
            return;
        }
    }
    panic!("{member:?} never fell asleep");
}

/// Asserts that `member` wakes in the next step, and stays awake long enough to gain speed.
#[track_caller]
pub fn assert_wakes(world: &mut World, member: impl Into<MemberId>) {
    let member = member.into();
    world.step().expect("a good step");
    assert_eq!(world.activity(member), Some(Activity::Active), "it sleeps on");
    assert!(world.events().woken.contains(&member));
    for _ in 0..30 {
        world.step().expect("a good step");
        assert_eq!(world.activity(member), Some(Activity::Active), "it fell asleep again at once");
    }
}

/// A curtain asleep that hangs from a height of 2 m.
pub fn sleeping_curtain() -> (World, BodyId) {
    let mut world = World::new();
    let curtain = world.add_body(curtain(Vec3::Y * 2.0));
    settle(&mut world, curtain);
    (world, curtain)
}

/// The hash of a body's state.
pub fn hash(body: &Body) -> u64 {
    StateHasher::new().particles(&body.particles).finish()
}

/// Mean position of all particles in metres.
pub fn centre(body: &Body) -> Vec3 {
    body.particles.positions().sum::<Vec3>() / body.particles.len() as f32
}
