//! Parts of a world go back in time while the rest stays: rollback, as games over a network do it.

use std::collections::VecDeque;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::rig::{InRig, Particle, Stick};
use bevy_drape::schedule::DrapeStep;
use bevy_drape::snapshot::{Key, Snapshot, members};

use crate::common::*;
use crate::snapshots::{RolledBack, distinct_keys};

/// One frame of the game and one step.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Advance;

/// Frames of the game so far, which the game itself takes back.
#[derive(Resource)]
struct Frame(usize);

/// An obstacle that the game moves.
#[derive(Component)]
struct Carousel;

/// Frames that are taken back in each frame.
const BACK: usize = 8;

fn play(
    mut commands: Commands,
    mut frame: ResMut<Frame>,
    mut carousels: Query<&mut Transform, With<Carousel>>,
) {
    frame.0 += 1;
    if frame.0 == 40 || frame.0 == 55 {
        let ball = Projectile { radius: 0.1, mass: 0.5, velocity: Vec3::NEG_Z * 9.0, ..default() };
        commands.spawn((RolledBack, ball, Transform::from_xyz(0.1, 1.1, 1.0)));
    }
    for mut place in &mut carousels {
        let (sin, cos) = (0.05 * frame.0 as f32).sin_cos();
        place.translation = Vec3::new(0.5 * cos, 0.6, 0.5 * sin);
    }
}

/// A curtain, a cloth that touches itself, a tied rope, a hand-built pendulum, an obstacle that moves and one that flies are rolled
/// back; a flag and the ground are not.
fn world() -> App {
    let mut app = app_in(Advance);
    app.insert_resource(Frame(0)).add_systems(Advance, play.before(DrapeStep));
    let world = app.world_mut();
    world.spawn(Obstacle::ground().with_friction(0.8));
    world.spawn((Cloth::new(1.0, 1.0), Transform::from_xyz(20.0, 2.0, 0.0)));
    world.spawn((RolledBack, curtain(), Transform::from_xyz(0.0, 1.2, -0.6)));
    let touching = SolverSettings { self_contact: SelfContact::On, ..default() };
    let tilted = Quat::from_rotation_x(1.4);
    world.spawn((
        RolledBack,
        free_cloth(),
        touching,
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(tilted),
    ));
    let post = (RolledBack, Carousel, Obstacle::capsule(0.15, 0.4), Transform::from_xyz(0.5, 0.6, 0.0));
    let post = world.spawn(post).id();
    let ends = [Vec3::new(0.6, 1.4, 0.0), Vec3::new(1.4, 1.4, 0.0)];
    world.spawn((RolledBack, Rope::new(ends[0], ends[1], 17), Attachment::first(post)));
    let box_ = DynamicObstacle { velocity: Vec3::Z * 2.0, ..DynamicObstacle::cuboid(0.5, Vec3::splat(0.2)) };
    let place = Transform::from_xyz(0.3, 0.9, -1.6);
    world.spawn((RolledBack, Obstacle::cuboid(0.2, 0.2, 0.2), box_, place));
    for particle in pendulum(world) {
        world.entity_mut(particle).insert(RolledBack);
    }
    // The schedule is run by hand: from here on each run is one sixtieth of a second.
    app.update();
    advance(&mut app);
    app
}

/// A hand-built pendulum: its hook and its bob.
fn pendulum(world: &mut World) -> [Entity; 2] {
    let hook = world.spawn((Particle::pinned(), Transform::from_xyz(-2.0, 2.0, 0.0))).id();
    let bob = world.spawn((Particle::new(0.5), Transform::from_xyz(-1.0, 2.0, 0.0))).id();
    world.spawn(Stick::new(hook, bob));
    [hook, bob]
}

/// The bits of all that is rolled back.
fn bits(app: &mut App) -> (u64, Vec<[u32; 3]>) {
    let all = members(app.world_mut());
    let is_rolled_back = |app: &App, entity| {
        let is_rig = app.world().get::<bevy_drape::rig::Rig>(entity).is_some();
        is_rig || app.world().get::<RolledBack>(entity).is_some()
    };
    let chosen: Vec<Entity> =
        all.into_iter().map(|(_, entity)| entity).filter(|&entity| is_rolled_back(app, entity)).collect();
    let place = |&entity: &Entity| get::<Transform>(app, entity).translation.to_array().map(f32::to_bits);
    let obstacles = chosen.iter().filter(|&&entity| app.world().get::<Obstacle>(entity).is_some());
    (hash(app, &chosen), obstacles.map(place).collect())
}

/// A frame of the game.
fn advance(app: &mut App) {
    app.world_mut().run_schedule(Advance);
}

#[test]
fn eight_frames_back_in_every_frame_change_no_bit() {
    let (mut straight, mut rolled) = (world(), world());
    let mut saved: VecDeque<(usize, Snapshot)> = VecDeque::new();
    for frame in 0..150 {
        if frame >= BACK {
            let (then, snapshot) = saved.pop_front().expect("eight are kept");
            snapshot.restore_of::<With<RolledBack>>(rolled.world_mut()).expect("the same world");
            rolled.insert_resource(Frame(then));
            saved.clear();
            for _ in 0..BACK {
                save(&mut rolled, &mut saved);
                advance(&mut rolled);
            }
            assert_eq!(bits(&mut rolled), bits(&mut straight), "after {frame} frames");
        }
        save(&mut rolled, &mut saved);
        if saved.len() > BACK {
            saved.pop_front();
        }
        advance(&mut rolled);
        advance(&mut straight);
    }
    let balls = |app: &mut App| app.world_mut().query::<&Projectile>().iter(app.world()).count();
    assert_eq!([balls(&mut rolled), balls(&mut straight)], [2; 2]);
}

fn save(app: &mut App, saved: &mut VecDeque<(usize, Snapshot)>) {
    let frame = app.world().resource::<Frame>().0;
    saved.push_back((frame, Snapshot::take_of::<With<RolledBack>>(app.world_mut())));
}

#[test]
fn what_is_not_chosen_stays_as_it_is() {
    let mut app = app();
    let chosen = app.world_mut().spawn((RolledBack, curtain())).id();
    let other = app.world_mut().spawn((curtain(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    let [hook, bob] = pendulum(app.world_mut());
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(-5.0, 0.0, 0.0))).id();
    step(&mut app, 20);
    let swings = get::<InRig>(&app, bob).body;
    assert_eq!(get::<InRig>(&app, hook).body, swings);
    let then = hash(&app, &[chosen]);
    let saved = Snapshot::take_of::<With<RolledBack>>(app.world_mut());
    app.world_mut().resource_mut::<Wind>().velocity = Vec3::Z;
    step(&mut app, 20);
    let [now, others] = [chosen, other].map(|body| hash(&app, &[body]));
    assert_ne!(now, then);
    let late = app.world_mut().spawn((curtain(), Transform::from_xyz(10.0, 0.0, 0.0))).id();
    step(&mut app, 1);
    let all_others = |app: &App| {
        let places = [bob, ball].map(|entity| *get::<Transform>(app, entity));
        ([other, swings, ball].map(|body| hash(app, &[body])), places)
    };
    app.world_mut().entity_mut(late).insert(Disabled);
    let others_later = all_others(&app);
    assert_ne!(others_later.0[0], others);
    saved.restore_of::<With<RolledBack>>(app.world_mut()).expect("the same world");
    assert_eq!(hash(&app, &[chosen]), then);
    assert_eq!(all_others(&app), others_later);
    assert_eq!(app.world().resource::<DrapeClock>().steps(), 20);
    assert_eq!(app.world().resource::<Wind>().velocity, Vec3::ZERO);
    // Numbers of creation are not handed out twice, not even that of a body which is disabled meanwhile.
    app.world_mut().spawn((curtain(), Transform::from_xyz(15.0, 0.0, 0.0)));
    app.world_mut().entity_mut(late).remove::<Disabled>();
    step(&mut app, 1);
    let keys = distinct_keys(&mut app);
    assert_eq!(keys.iter().filter(|key| matches!(key, Key::Body(_))).count(), 5);
}
