//! Contacts are told to those that ask: when they begin, when they end, when they are hard.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::contact::{
    ContactFeature, DrapeContactCounts, DrapeContactEnded, DrapeContactHit, DrapeContactSettings,
    DrapeContactStarted,
};
use bevy_drape::prelude::*;

use crate::common::*;

/// All that was told so far.
#[derive(Resource, Default)]
struct Told {
    started: Vec<DrapeContactStarted>,
    hits: Vec<DrapeContactHit>,
    ended: Vec<DrapeContactEnded>,
    greatest_sum: usize,
    held_back: usize,
}

fn listening_app() -> App {
    let mut app = app();
    app.init_resource::<Told>().add_systems(Last, listen);
    app
}

fn listen(
    mut started: MessageReader<DrapeContactStarted>,
    mut hits: MessageReader<DrapeContactHit>,
    mut ended: MessageReader<DrapeContactEnded>,
    counts: Res<DrapeContactCounts>,
    mut told: ResMut<Told>,
) {
    let sum = started.len() + hits.len() + ended.len();
    assert_eq!(sum, counts.sent);
    told.greatest_sum = told.greatest_sum.max(sum);
    told.held_back += counts.held_back;
    told.started.extend(started.read());
    told.hits.extend(hits.read());
    told.ended.extend(ended.read());
}

fn told(app: &App) -> &Told {
    app.world().resource::<Told>()
}

fn pairs(app: &App) -> Vec<(Entity, Entity)> {
    told(app).started.iter().map(|contact| (contact.body, contact.other)).collect()
}

fn ended_pairs(app: &App) -> Vec<(Entity, Entity)> {
    told(app).ended.iter().map(|contact| (contact.body, contact.other)).collect()
}

/// A free cloth at this place, lying flat.
fn level(at: Vec3) -> (Cloth, BodySurface, Transform) {
    let flat = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
    (free_cloth(), quiet(), Transform::from_translation(at).with_rotation(flat))
}

fn ball(at: Vec3, velocity: Vec3) -> (Projectile, Transform) {
    (Projectile { velocity, ..default() }, Transform::from_translation(at))
}

#[test]
fn a_cloth_touches_the_ground_once_and_leaves_it_once() {
    let mut app = listening_app();
    let ground = app.world_mut().spawn(Obstacle::ground()).id();
    let cloth = app.world_mut().spawn((level(Vec3::Y * 0.5), ContactEvents)).id();
    run(&mut app, 0.25);
    assert_eq!(pairs(&app), [], "it is in the air");
    // It falls, comes to rest and falls asleep.
    settle(&mut app, cloth);
    run(&mut app, 1.0);
    assert_eq!(pairs(&app), [(cloth, ground)]);
    let first = &told(&app).started[0];
    let falling_time = (2.0 * 0.5 / GRAVITY).sqrt();
    assert!((first.time as f32 - falling_time).abs() < 0.1, "at {} s", first.time);
    assert!(first.normal.distance(Vec3::Y) < 1e-4 && first.point.y.abs() < 0.02);
    let Some(ContactFeature::Particle(index)) = first.feature else { panic!("{:?}", first.feature) };
    assert!(index < 81);
    assert_eq!(ended_pairs(&app), []);
    // The ground goes away under it.
    app.world_mut().despawn(ground);
    run(&mut app, 0.5);
    assert_eq!(ended_pairs(&app), [(cloth, ground)]);
    assert_eq!(pairs(&app).len(), 1);
    assert_eq!(told(&app).held_back, 0);
}

#[test]
fn nobody_is_told_what_nobody_asks_for() {
    let mut app = listening_app();
    app.world_mut().spawn(Obstacle::ground());
    app.world_mut().spawn(level(Vec3::Y * 0.1));
    app.world_mut().spawn(ball(Vec3::new(0.0, 1.0, 0.0), Vec3::ZERO));
    run(&mut app, 2.0);
    assert_eq!((pairs(&app).len(), told(&app).hits.len()), (0, 0));
    assert_eq!(app.world().resource::<Hits>().0.len(), 2, "balls tell what they hit as ever");
}

#[test]
fn either_of_two_may_ask_at_any_time() {
    let mut app = listening_app();
    let ground = app.world_mut().spawn((Obstacle::ground(), ContactEvents)).id();
    let ball = app.world_mut().spawn(ball(Vec3::Y * 0.2, Vec3::ZERO)).id();
    run(&mut app, 0.5);
    assert_eq!(pairs(&app), [(ball, ground)]);
    app.world_mut().entity_mut(ground).remove::<ContactEvents>();
    run(&mut app, 0.2);
    assert_eq!(ended_pairs(&app), [(ball, ground)]);
    run(&mut app, 0.5);
    app.world_mut().entity_mut(ball).insert(ContactEvents);
    get_mut::<ProjectileState>(&mut app, ball).rouse();
    run(&mut app, 0.2);
    assert_eq!(pairs(&app), [(ball, ground); 2]);
}

#[test]
fn a_hit_on_a_curtain_names_a_face_and_has_the_impulse_of_the_stop() {
    let mut app = listening_app();
    weightless(&mut app);
    let curtain = app.world_mut().spawn((curtain(), ContactEvents)).id();
    let (low, high) = {
        step(&mut app, 1);
        get::<Particles>(&app, curtain).bounds()
    };
    let middle = (low + high) * 0.5 + Vec3::new(0.05, 0.03, 0.0);
    let ball = app.world_mut().spawn(ball(middle + Vec3::Z * 0.5, Vec3::NEG_Z * 5.0)).id();
    run(&mut app, 0.5);
    assert_eq!(pairs(&app), [(ball, curtain)]);
    assert!(matches!(told(&app).started[0].feature, Some(ContactFeature::Face(0..128))));
    let hit = told(&app).hits[0];
    assert_eq!((hit.body, hit.other), (ball, curtain));
    assert!(hit.impulse > 0.1, "{} N s", hit.impulse);
}

#[test]
fn soft_touches_are_no_hits() {
    let mut app = listening_app();
    weightless(&mut app);
    app.world_mut().spawn((Obstacle::cuboid(1.0, 1.0, 1.0), ContactEvents));
    let soft = ball(Vec3::X * 0.7, Vec3::NEG_X * 0.04);
    let hard = ball(Vec3::Y * 0.7, Vec3::NEG_Y * 4.0);
    let [_, hard] = [soft, hard].map(|ball| app.world_mut().spawn(ball).id());
    run(&mut app, 3.0);
    assert_eq!(pairs(&app).len(), 2);
    let hits: Vec<Entity> = told(&app).hits.iter().map(|hit| hit.body).collect();
    assert_eq!(hits, [hard]);
    // Two kilograms at four metres per second; what is left of it may come in the next step.
    let impulse = told(&app).hits[0].impulse;
    assert!((0.1..8.01).contains(&impulse), "{impulse} N s");
}

#[test]
fn a_sensor_moves_nothing_and_tells_who_comes_and_goes() {
    let mut app = listening_app();
    let gate = Obstacle::cuboid(3.0, 0.2, 3.0).as_sensor();
    let gate = app.world_mut().spawn((gate, ContactEvents)).id();
    let ball = app.world_mut().spawn(ball(Vec3::new(0.3, 1.0, 0.0), Vec3::ZERO)).id();
    let cloth = app.world_mut().spawn(level(Vec3::Y * 1.5)).id();
    let lone_ball = app.world_mut().spawn(self::ball(Vec3::new(100.3, 1.0, 0.0), Vec3::ZERO)).id();
    run(&mut app, 2.0);
    let mut seen = pairs(&app);
    seen.sort_unstable();
    let mut expected = vec![(ball, gate), (cloth, gate)];
    expected.sort_unstable();
    assert_eq!(seen, expected);
    let mut gone = ended_pairs(&app);
    gone.sort_unstable();
    assert_eq!(gone, expected);
    assert_eq!(ball_position(&app, ball).y.to_bits(), ball_position(&app, lone_ball).y.to_bits());
    assert_eq!(told(&app).hits.len(), 0);
}

#[test]
fn the_number_of_messages_is_bounded_and_none_but_hits_are_lost() {
    let mut app = listening_app();
    app.insert_resource(DrapeContactSettings { max_messages: 3, hit_impulse: 1e9 });
    app.world_mut().spawn((Obstacle::ground(), ContactEvents));
    let at = |i: usize| Vec3::new(i as f32, 0.3, 0.0);
    let balls: Vec<Entity> = (0..20).map(|i| app.world_mut().spawn(ball(at(i), Vec3::ZERO)).id()).collect();
    run(&mut app, 1.0);
    assert_eq!(told(&app).greatest_sum, 3);
    assert!(told(&app).held_back > 0);
    assert_eq!(pairs(&app).len(), 20);
    assert_eq!(app.world().resource::<DrapeContactCounts>().touching, 20);
    for ball in balls {
        app.world_mut().despawn(ball);
    }
    run(&mut app, 1.0);
    assert_eq!(ended_pairs(&app).len(), 20);
    assert_eq!(told(&app).greatest_sum, 3);
    assert_eq!(app.world().resource::<DrapeContactCounts>().touching, 0);
}
