//! Despawning is safe in every state and at every moment.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::prelude::*;
use bevy_drape::schedule::{DrapeSchedule, DrapeSubsteps};

use crate::common::*;

/// A curtain, and a ball that hits it after about 0.2 s.
fn shot_at_curtain(app: &mut App) -> (Entity, Entity) {
    let curtain = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
    let ball = Projectile { velocity: Vec3::Z * 10.0, ..default() };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 2.0, -2.0))).id();
    (curtain, ball)
}

/// Steps until the ball touches something.
fn until_hit(app: &mut App) {
    for _ in 0..120 {
        step(app, 1);
        if !app.world().resource::<Hits>().0.is_empty() {
            return;
        }
    }
    panic!("the ball never hit");
}

/// Runs on, and asserts that `survivor` is still simulated well.
fn assert_goes_on(app: &mut App, survivor: Entity) {
    let before = hash(app, &[survivor]);
    run(app, 0.5);
    assert_ne!(hash(app, &[survivor]), before, "the survivor stands still");
    if let Some(particles) = app.world().get::<Particles>(survivor) {
        assert!(particles.is_finite());
    }
}

#[test]
fn an_active_body() {
    let mut app = app();
    let (curtain, ball) = shot_at_curtain(&mut app);
    step(&mut app, 3);
    app.world_mut().entity_mut(curtain).despawn();
    assert_goes_on(&mut app, ball);
    assert_eq!(counts(&app), (1, 0, 0));
    assert!(ball_position(&app, ball).z > 1.0, "nothing is left that could stop the ball");
}

#[test]
fn a_resting_body() {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), quiet())).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(5.0, 900.0, 0.0))).id();
    settle(&mut app, curtain);
    app.world_mut().entity_mut(curtain).despawn();
    assert_goes_on(&mut app, ball);
}

#[test]
fn a_culled_body() {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 5000.0, 0.0))).id();
    let ball = app.world_mut().spawn(Projectile::default()).id();
    step(&mut app, 3);
    assert_eq!(activity(&app, curtain), Activity::Culled);
    app.world_mut().entity_mut(curtain).despawn();
    assert_goes_on(&mut app, ball);
    assert_eq!(counts(&app), (1, 0, 0));
}

#[test]
fn a_body_that_is_not_built_yet() {
    let mut app = app();
    let (curtain, ball) = shot_at_curtain(&mut app);
    app.world_mut().entity_mut(curtain).despawn();
    step(&mut app, 1);
    assert_goes_on(&mut app, ball);
}

#[test]
fn a_ball_in_flight() {
    let mut app = app();
    let (curtain, ball) = shot_at_curtain(&mut app);
    step(&mut app, 5);
    app.world_mut().entity_mut(ball).despawn();
    assert_goes_on(&mut app, curtain);
    assert!(app.world().resource::<Hits>().0.is_empty());
}

#[test]
fn a_ball_that_touches_the_cloth() {
    let mut app = app();
    let (curtain, ball) = shot_at_curtain(&mut app);
    until_hit(&mut app);
    app.world_mut().entity_mut(ball).despawn();
    assert_goes_on(&mut app, curtain);
}

#[test]
fn a_cloth_that_a_ball_touches() {
    let mut app = app();
    let (curtain, ball) = shot_at_curtain(&mut app);
    until_hit(&mut app);
    app.world_mut().entity_mut(curtain).despawn();
    assert_goes_on(&mut app, ball);
}

#[test]
fn an_obstacle_in_contact() {
    let mut app = app();
    let ground = app.world_mut().spawn(Obstacle::ground()).id();
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(0.0, 0.4, 0.0))).id();
    let cloth = app.world_mut().spawn((free_cloth(), Transform::from_xyz(3.0, 0.6, 0.0))).id();
    until_hit(&mut app);
    run(&mut app, 0.2);
    app.world_mut().entity_mut(ground).despawn();
    assert_goes_on(&mut app, ball);
    assert!(ball_position(&app, ball).y < -0.5 && centre(&app, cloth).y < -0.5, "both fall");
}

#[test]
fn a_cannon_before_its_message_is_read() {
    let mut app = app();
    let cannon = app.world_mut().spawn(Cannon::default()).id();
    let ball = app.world_mut().spawn(Projectile::default()).id();
    app.world_mut().write_message(FireCannon { cannon });
    app.world_mut().entity_mut(cannon).despawn();
    assert_goes_on(&mut app, ball);
    assert!(app.world().resource::<Shots>().0.is_empty());
    assert_eq!(counts(&app), (1, 0, 0));
}

#[test]
fn a_parent_that_carries_bodies() {
    let mut app = app();
    let ship = app.world_mut().spawn(Transform::default()).id();
    app.world_mut().spawn((curtain(), Transform::default(), ChildOf(ship)));
    app.world_mut().spawn((Projectile::default(), Transform::from_xyz(3.0, 0.0, 0.0), ChildOf(ship)));
    let ball = app.world_mut().spawn((Projectile::default(), Transform::from_xyz(6.0, 0.0, 0.0))).id();
    step(&mut app, 3);
    app.world_mut().entity_mut(ship).despawn();
    assert_goes_on(&mut app, ball);
    assert_eq!(counts(&app), (1, 0, 0));
}

/// The entity that a system despawns in the middle of a step, and the substep.
#[derive(Resource)]
struct Doomed {
    entity: Entity,
    in_substep: u32,
}

fn doom(mut commands: Commands, mut doomed: ResMut<Doomed>) {
    if doomed.in_substep == 0 {
        commands.entity(doomed.entity).try_despawn();
    } else {
        doomed.in_substep -= 1;
    }
}

/// Despawns one of curtain and ball while they touch, in substep `in_substep` of a step, from within `set`.
fn despawn_within(set: DrapeSystems, in_substep: u32, is_ball: bool) {
    let mut app = app();
    let (curtain, ball) = shot_at_curtain(&mut app);
    let other = app.world_mut().spawn((curtain_far(), Transform::from_xyz(9.0, 0.0, 0.0))).id();
    until_hit(&mut app);
    app.insert_resource(Doomed { entity: if is_ball { ball } else { curtain }, in_substep });
    app.add_systems(DrapeSubsteps, doom.in_set(set));
    step(&mut app, 1);
    let (gone, left) = if is_ball { (ball, curtain) } else { (curtain, ball) };
    assert!(app.world().get_entity(gone).is_err());
    assert_goes_on(&mut app, left);
    assert!(speed(&app, other).is_finite());
    assert_eq!(counts(&app), (2, 0, 0));
}

fn curtain_far() -> Cloth {
    curtain()
}

#[test]
fn a_touching_body_in_the_middle_of_a_step() {
    for set in [DrapeSystems::Integrate, DrapeSystems::Relax, DrapeSystems::ProjectCollisions] {
        for in_substep in [0, 3, 7] {
            despawn_within(set, in_substep, false);
        }
    }
}

#[test]
fn a_touching_ball_in_the_middle_of_a_step() {
    for set in [DrapeSystems::Integrate, DrapeSystems::Relax, DrapeSystems::ProjectCollisions] {
        for in_substep in [0, 3, 7] {
            despawn_within(set, in_substep, true);
        }
    }
}

#[test]
fn an_obstacle_in_the_middle_of_a_step() {
    let mut app = app();
    let ground = app.world_mut().spawn(Obstacle::ground()).id();
    let cloth = app.world_mut().spawn((free_cloth(), Transform::from_xyz(0.0, 0.5, 0.0))).id();
    run(&mut app, 0.3);
    app.insert_resource(Doomed { entity: ground, in_substep: 2 });
    app.add_systems(DrapeSubsteps, doom.in_set(DrapeSystems::Relax));
    assert_goes_on(&mut app, cloth);
    assert!(centre(&app, cloth).y < 0.0, "it falls");
}

#[test]
fn all_in_each_set_of_a_step() {
    use DrapeSystems::*;
    for set in [ManageScene, AccumulateForces, FormIslands, DetectCollisions, Substeps, Finish] {
        let mut app = app();
        shot_at_curtain(&mut app);
        app.world_mut().spawn((Obstacle::sphere(0.3), Transform::from_xyz(0.0, 1.4, 0.0)));
        until_hit(&mut app);
        let despawn_all = |mut commands: Commands, all: Query<Entity, With<Transform>>| {
            all.iter().for_each(|entity| commands.entity(entity).despawn());
        };
        app.add_systems(DrapeSchedule, despawn_all.in_set(set));
        step(&mut app, 3);
        assert_eq!(counts(&app), (0, 0, 0), "{set:?}");
        let ball = app.world_mut().spawn(Projectile::default()).id();
        step(&mut app, 1);
        assert!(app.world().get_entity(ball).is_err());
    }
}
