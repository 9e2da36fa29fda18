//! Shifting the origin of the world changes coordinates and nothing else.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_drape::attach::{Grab, Hand, PlaneLock};
use bevy_drape::ball::ProjectileState;
use bevy_drape::build::RigidTetrahedron;
use bevy_drape::environment::WindFlow;
use bevy_drape::origin::ShiftOrigin;
use bevy_drape::prelude::*;
use bevy_drape::rig::{Particle, Stick};
use bevy_drape::sleep::SceneManager;
use bevy_drape::snapshot::members;
use bevy_drape::transform::MovedByFrame;

use crate::common::*;

/// An obstacle that a system moves.
#[derive(Component)]
struct Piston;

/// Anything that moves, and its entity.
#[derive(Component)]
struct Watched;

/// The origin, and how often the pistons have moved.
#[derive(Resource, Default)]
struct Game {
    origin: Vec3,
    ticks: u32,
}

fn push(mut game: ResMut<Game>, mut pistons: Query<&mut Transform, With<Piston>>) {
    game.ticks += 1;
    if game.ticks > 60 {
        return;
    }
    for mut place in &mut pistons {
        place.translation = Vec3::new(0.0, 1.0, -0.5 + 0.005 * game.ticks as f32) - game.origin;
    }
}

fn shift(app: &mut App, origin: Vec3) {
    app.world_mut().resource_mut::<Game>().origin += origin;
    ShiftOrigin(origin).apply(app.world_mut());
}

/// Everything that has a place, and a breeze at this height above a curtain.
fn world(height: f32) -> App {
    let mut app = app();
    app.init_resource::<Game>().add_systems(FixedUpdate, push);
    let world = app.world_mut();
    world.resource_mut::<SceneManager>().play_area_min = Vec3::splat(-1e6);
    world.resource_mut::<SceneManager>().play_area_max = Vec3::splat(1e6);
    // The ground, and a table on it, are children of something that is turned: their places are rounded.
    let turned = Transform::from_xyz(0.3, 0.0, 0.1).with_rotation(Quat::from_rotation_y(0.7));
    let level = world.spawn(turned).id();
    world.spawn((ChildOf(level), Obstacle::ground().with_friction(0.8)));
    let table = Transform::from_xyz(4.1, 0.4, 0.2);
    world.spawn((ChildOf(level), Obstacle::cuboid(0.8, 0.1, 0.8), table));
    let rail = world.spawn((ChildOf(level), Transform::from_xyz(0.1, 1.5, 0.3))).id();
    world.spawn((Watched, ChildOf(rail), curtain(), WorldMotion::default().with_scale(0.5, 0.5)));
    world.spawn((Piston, Obstacle::sphere(0.2)));
    let over_table = level_place(turned, table.translation + Vec3::Y * 0.4);
    world.spawn((Watched, free_cloth(), over_table.with_rotation(Quat::from_rotation_x(1.5))));
    let post = world.spawn((ChildOf(level), Transform::from_xyz(-3.0, 2.0, 0.0))).id();
    let start = level_place(turned, Vec3::new(-3.0, 2.0, 0.0)).translation;
    world.spawn((Watched, Rope::new(start, start + Vec3::X, 17), Attachment::first(post)));
    let ball = Projectile { radius: 0.2, mass: 2.0, velocity: Vec3::new(1.5, 0.0, 0.0), ..default() };
    world.spawn((Watched, Interpolated, ball, Transform::from_xyz(-6.0, 0.8, 3.0)));
    let box_ = DynamicObstacle::cuboid(5.0, Vec3::splat(0.3));
    let box_ = DynamicObstacle { velocity: Vec3::X, gravity_scale: 0.0, ..box_ };
    world.spawn((Watched, Obstacle::cuboid(0.3, 0.3, 0.3), box_, Transform::from_xyz(-6.0, 3.0, -4.0)));
    world.spawn((
        Watched,
        RigidTetrahedron::cuboid(8.0, Vec3::splat(0.25)),
        Transform::from_xyz(-6.0, 0.9, -2.0),
    ));
    let flat = Transform::from_xyz(6.0, 1.0, 5.0);
    let lock = PlaneLock { normal: Vec3::new(0.0, 0.0, 2.0), distance: 5.0 };
    let held = world.spawn((Watched, curtain(), lock, flat)).id();
    let hook = world.spawn((ChildOf(rail), Particle::pinned(), Transform::from_xyz(9.0, 0.5, 0.0))).id();
    let bob = world.spawn((Watched, Particle::new(0.5), Transform::from_xyz(9.7, 2.0, 0.0))).id();
    world.spawn(Stick::new(hook, bob));
    let breeze = WindZone { flow: WindFlow::Along(Vec3::Z), ..default() };
    world.spawn((ChildOf(rail), breeze, Transform::from_xyz(0.0, height - 0.3, 0.0)));
    world.spawn((MovedByFrame, Obstacle::sphere(0.1), Transform::from_xyz(0.0, 20.0, 0.0)));
    step(&mut app, 1);
    let mut hand = Hand::new(get::<Particles>(&app, held), 20, 0.1);
    hand.target += Vec3::new(0.1, 0.1, 0.0);
    app.world_mut().entity_mut(held).insert(Grab::from(hand));
    app
}

fn level_place(level: Transform, place: Vec3) -> Transform {
    Transform::from_translation(level.transform_point(place))
}

/// Places of all that is watched, in the coordinates of the start.
fn places(app: &mut App) -> Vec<Vec3> {
    let origin = app.world().resource::<Game>().origin;
    let mut watched = app
        .world_mut()
        .query_filtered::<(&Transform, Has<ChildOf>, Option<&Particles>, Option<&ProjectileState>), With<Watched>>();
    let mut places = Vec::new();
    for (transform, is_child, particles, ball) in watched.iter(app.world()) {
        places.extend((!is_child).then_some(transform.translation));
        places.extend(particles.into_iter().flat_map(|particles| particles.positions()));
        places.extend(ball.map(|ball| ball.position()));
    }
    places.into_iter().map(|place| place + origin).collect()
}

/// The greatest distance of what is at one place in both worlds.
fn apart(one: &mut App, other: &mut App) -> f32 {
    let (one, other) = (places(one), places(other));
    assert_eq!(one.len(), other.len());
    one.iter().zip(&other).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Motion goes on as it would have, but for the rounding of places.
#[test]
fn all_that_moves_goes_on() {
    let (mut straight, mut shifted) = (world(0.0), world(0.0));
    step(&mut straight, 20);
    step(&mut shifted, 20);
    for origin in [Vec3::new(64.0, -32.0, 128.0), Vec3::new(-96.0, 32.0, 0.0)] {
        shift(&mut shifted, origin);
        for _ in 0..20 {
            let off = apart(&mut straight, &mut shifted);
            assert!(off < 2e-3, "{off} m apart");
            step(&mut straight, 1);
            step(&mut shifted, 1);
        }
    }
}

/// Between two steps balls are shown on their way, also in the frame of the shift and in the next one. So steps see what is moved once a
/// frame.
#[test]
fn interpolation_goes_on() {
    #[derive(Resource, Default)]
    struct Seen(Vec<Vec3>);
    let (mut straight, mut shifted) = (world(0.0), world(0.0));
    for app in [&mut straight, &mut shifted] {
        app.init_resource::<Seen>()
            .add_systems(Update, |mut moved: Query<&mut Transform, With<MovedByFrame>>| {
                moved.iter_mut().for_each(|mut place| place.translation.x += 0.01);
            })
            .add_systems(
                FixedLast,
                |moved: Query<&Transform, With<MovedByFrame>>, game: Res<Game>, mut seen: ResMut<Seen>| {
                    seen.0.extend(moved.iter().map(|place| place.translation + game.origin));
                },
            );
        frame_time(app, 1.0 / 144.0);
        (0..20).for_each(|_| app.update());
    }
    for _ in 0..10 {
        shift(&mut shifted, Vec3::new(64.0, -32.0, 128.0));
        let off = apart(&mut straight, &mut shifted);
        assert!(off < 2e-3, "{off} m apart");
        straight.update();
        shifted.update();
    }
    let [straight, shifted] = [&straight, &shifted].map(|app| &app.world().resource::<Seen>().0);
    assert!(shifted.len() > 10 && shifted.len() == straight.len());
    for (a, b) in straight.iter().zip(shifted) {
        assert!(a.distance(*b) < 1e-3, "steps see {a} and {b}");
    }
}

/// Nothing wakes, whatever digits are lost.
#[test]
fn rest_goes_on() {
    let mut app = world(50.0);
    let mut flying = app.world_mut().query::<&mut DynamicObstacle>();
    flying.iter_mut(app.world_mut()).for_each(|mut flying| flying.velocity = Vec3::ZERO);
    let mut held = app.world_mut().query_filtered::<Entity, With<Grab>>();
    let held = held.single(app.world()).expect("one is held");
    app.world_mut().entity_mut(held).remove::<Grab>();
    for _ in 0..60 {
        run(&mut app, 1.0);
        if counts(&app).0 == 0 {
            break;
        }
    }
    assert_eq!(counts(&app).0, 0, "all rests");
    let before = places(&mut app);
    for origin in
        [Vec3::new(64.3, -31.7, 128.9), Vec3::new(1e5, 0.0, -1e5), Vec3::new(-1e5 - 64.0, 31.0, 1e5)]
    {
        shift(&mut app, origin);
        for _ in 0..5 {
            step(&mut app, 1);
            assert_eq!(counts(&app).0, 0, "all rests at {origin}");
        }
    }
    let off = places(&mut app).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(off < 0.05, "{off} m away");
}

/// A scene that is 100 km away and has the origin shifted to it is as one at 0, to the last bit.
#[test]
fn a_scene_100_km_away_is_as_one_at_0() {
    let scene = |app: &mut App, at: Vec3| {
        app.world_mut().spawn((Obstacle::ground(), Transform::from_translation(at)));
        app.world_mut().spawn((Obstacle::sphere(0.5), Transform::from_translation(at)));
        let flat = Quat::from_rotation_x(1.5);
        let place = Transform::from_translation(at + Vec3::Y).with_rotation(flat);
        let cloth = app.world_mut().spawn((free_cloth(), place)).id();
        let ball = Projectile { radius: 0.1, mass: 1.0, ..default() };
        let place = Transform::from_translation(at + Vec3::new(0.125, 2.0, 0.0));
        [cloth, app.world_mut().spawn((ball, place)).id()]
    };
    let (mut near, mut far) = (app(), app());
    let far_away = Vec3::new(1e5, 0.0, -1e5);
    let expected = scene(&mut near, Vec3::ZERO);
    let found = scene(&mut far, far_away);
    ShiftOrigin(far_away).apply(far.world_mut());
    for _ in 0..10 {
        step(&mut near, 30);
        step(&mut far, 30);
        assert_eq!(hash(&far, &found), hash(&near, &expected));
    }
}

/// Disabled obstacles are where they belong once they are enabled, though Bevy does not propagate their transforms.
#[test]
fn disabled_obstacles_are_shifted_too() {
    let mut app = app();
    let ball = Projectile { radius: 0.1, mass: 1.0, restitution: 0.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(500.0, 1.0, 0.0))).id();
    let plate = (Obstacle::cuboid(1.0, 0.1, 1.0), Transform::from_xyz(500.0, 0.0, 0.0));
    let plate = app.world_mut().spawn(plate).id();
    step(&mut app, 1);
    app.world_mut().entity_mut(plate).insert(Disabled);
    step(&mut app, 1);
    ShiftOrigin(Vec3::X * 500.0).apply(app.world_mut());
    step(&mut app, 1);
    app.world_mut().entity_mut(plate).remove::<Disabled>();
    run(&mut app, 2.0);
    let Vec3 { x, y, .. } = ball_position(&app, ball);
    assert!(x.abs() < 0.1 && y > 0.0, "({x}, {y})");
}

#[test]
fn an_origin_that_cannot_be_is_refused() {
    let mut app = world(0.0);
    step(&mut app, 10);
    let all: Vec<Entity> = members(app.world_mut()).into_iter().map(|(_, entity)| entity).collect();
    let before = hash(&app, &all);
    ShiftOrigin(Vec3::NAN).apply(app.world_mut());
    assert_eq!(hash(&app, &all), before);
    assert!(places(&mut app).iter().all(|place| place.is_finite()));
}
