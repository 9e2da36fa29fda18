//! Observers of an entity hear what messages tell of it.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::build::BodyBuilt;
use bevy_drape::contact::{BallHit, DrapeContactEnded, DrapeContactHit, DrapeContactStarted};
use bevy_drape::prelude::*;
use bevy_drape::sleep::{BodySlept, BodyWoken};
use bevy_drape::tear::{CutCloth, StickTorn};

use crate::common::*;

/// What was heard: the name of the event and the entity that it was about.
#[derive(Resource, Default)]
struct Heard {
    by_observers: Vec<(&'static str, Entity)>,
    by_readers: Vec<(&'static str, Entity)>,
}

/// Reads all messages of a kind.
fn read<M: Message + EntityEvent>(mut messages: MessageReader<M>, mut heard: ResMut<Heard>) {
    let name = core::any::type_name::<M>();
    heard.by_readers.extend(messages.read().map(|message| (name, message.event_target())));
}

/// Has an entity listen.
fn listen<E: EntityEvent>(app: &mut App, entity: Entity) {
    app.world_mut().entity_mut(entity).observe(move |event: On<E>, mut heard: ResMut<Heard>| {
        assert_eq!(event.event_target(), entity, "each hears of itself only");
        heard.by_observers.push((core::any::type_name::<E>(), entity));
    });
}

fn listening_app() -> App {
    let mut app = app();
    app.init_resource::<Heard>().add_systems(
        Last,
        (
            read::<BallHit>,
            read::<BodyBuilt>,
            read::<BodySlept>,
            read::<BodyWoken>,
            read::<StickTorn>,
            read::<DrapeContactStarted>,
            read::<DrapeContactHit>,
            read::<DrapeContactEnded>,
        ),
    );
    app
}

fn count<E>(of: &[(&'static str, Entity)], entity: Entity) -> usize {
    of.iter().filter(|heard| **heard == (core::any::type_name::<E>(), entity)).count()
}

#[test]
fn a_body_hears_that_it_is_built_sleeps_and_wakes() {
    let mut app = listening_app();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    listen::<BodyBuilt>(&mut app, curtain);
    listen::<BodySlept>(&mut app, curtain);
    listen::<BodyWoken>(&mut app, curtain);
    settle(&mut app, curtain);
    let told = |app: &App| {
        let heard = app.world().resource::<Heard>();
        [&heard.by_observers, &heard.by_readers].map(|of| {
            [
                count::<BodyBuilt>(of, curtain),
                count::<BodySlept>(of, curtain),
                count::<BodyWoken>(of, curtain),
            ]
        })
    };
    assert_eq!(activity(&app, curtain), Activity::Resting);
    assert_eq!(told(&app), [[1, 1, 0]; 2]);
    get_mut::<Particles>(&mut app, curtain).set_velocity(40, Vec3::Z);
    step(&mut app, 1);
    assert_eq!(told(&app), [[1, 1, 1]; 2]);
    get_mut::<Fabric>(&mut app, curtain).areal_density *= 2.0;
    step(&mut app, 1);
    assert_eq!(told(&app)[0][0], 2, "it was built anew");
}

#[test]
fn both_hear_of_a_contact_and_a_ball_of_its_hit() {
    let mut app = listening_app();
    let place = Transform::from_xyz(0.0, 0.4, 0.0);
    let ball = app.world_mut().spawn((Projectile { mass: 2.0, ..default() }, ContactEvents, place)).id();
    let ground = app.world_mut().spawn((Obstacle::ground(), Transform::default())).id();
    listen::<BallHit>(&mut app, ball);
    for entity in [ball, ground] {
        listen::<DrapeContactStarted>(&mut app, entity);
        listen::<DrapeContactHit>(&mut app, entity);
        listen::<DrapeContactEnded>(&mut app, entity);
    }
    app.world_mut().entity_mut(ground).observe(move |started: On<DrapeContactStarted>| {
        assert_eq!((started.body, started.other), (ground, ball), "as the ground sees it");
        assert!(started.normal.y < -0.9, "the ball's normal points up, the ground's down");
    });
    run(&mut app, 1.0);
    let launched = Vec3::Y * 5.0;
    get_mut::<bevy_drape::ball::ProjectileState>(&mut app, ball).set_velocity(launched);
    run(&mut app, 0.5);
    let heard = app.world().resource::<Heard>();
    for entity in [ball, ground] {
        assert_eq!(count::<DrapeContactStarted>(&heard.by_observers, entity), 1);
        assert_eq!(count::<DrapeContactHit>(&heard.by_observers, entity), 1);
        assert_eq!(count::<DrapeContactEnded>(&heard.by_observers, entity), 1);
    }
    assert_eq!(count::<BallHit>(&heard.by_observers, ball), 1);
    assert_eq!(count::<DrapeContactStarted>(&heard.by_readers, ball), 1, "a message is written once");
    assert_eq!(count::<DrapeContactStarted>(&heard.by_readers, ground), 0);
}

#[test]
fn a_body_hears_of_each_stick_that_is_cut() {
    let mut app = listening_app();
    let cloth = app.world_mut().spawn(curtain()).id();
    listen::<StickTorn>(&mut app, cloth);
    step(&mut app, 1);
    let (low, high) = get::<Particles>(&app, cloth).bounds();
    let middle = 0.48 * low + 0.52 * high;
    let [left, right] =
        [Vec3::NEG_X, Vec3::X].map(|aside| [middle + 2.0 * aside - Vec3::Z, middle + 2.0 * aside + Vec3::Z]);
    app.world_mut().write_message(CutCloth::sweep(left, right));
    step(&mut app, 2);
    let heard = app.world().resource::<Heard>();
    let torn = count::<StickTorn>(&heard.by_readers, cloth);
    assert!(torn > 3, "{torn} were cut");
    assert_eq!(count::<StickTorn>(&heard.by_observers, cloth), torn);
}

/// An observer may despawn what it hears of.
#[test]
fn a_ball_that_despawns_itself_when_it_hits_is_gone_after_the_step() {
    let mut app = listening_app();
    app.world_mut().spawn((Obstacle::ground(), Transform::default()));
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.4, 0.0))).id();
    app.world_mut().entity_mut(ball).observe(|hit: On<BallHit>, mut commands: Commands| {
        commands.entity(hit.projectile).despawn();
    });
    run(&mut app, 1.0);
    assert!(app.world().get_entity(ball).is_err());
}
