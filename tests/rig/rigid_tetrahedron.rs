//! Rigid bodies of four particles, as entities.

use bevy::prelude::*;
use bevy_drape::body::Activity;
use bevy_drape::build::RigidTetrahedron;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::Snapshot;

use crate::support::*;

const HALF: Vec3 = Vec3::new(0.3, 0.15, 0.2);

fn ground(rigs: &mut Rigs) {
    rigs.spawn((Obstacle { friction: 0.5, ..Obstacle::ground() }, Transform::default()));
}

fn crate_at(rigs: &mut Rigs, transform: Transform) -> Entity {
    rigs.spawn((RigidTetrahedron::cuboid(6.0, HALF), transform))
}

fn transform(rigs: &Rigs, entity: Entity) -> Transform {
    *rigs.app.world().get::<Transform>(entity).expect("it has a transform")
}

fn rigs() -> Rigs {
    Rigs::with_settings(BodySurface::default().drag, SolverSettings { iterations: 4, ..default() })
}

/// A crate that falls on an edge comes to lie flat; its `Transform` says so, and it sleeps.
#[test]
fn a_crate_falls_tumbles_and_sleeps_where_its_transform_says() {
    let mut rigs = rigs();
    ground(&mut rigs);
    let tilt = Quat::from_rotation_z(0.7) * Quat::from_rotation_x(0.3);
    let it = crate_at(
        &mut rigs,
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(tilt).with_scale(Vec3::splat(2.0)),
    );
    rigs.steps(2);
    assert!(transform(&rigs, it).rotation.angle_between(tilt) < 0.01, "it is as it was put there");
    rigs.seconds(7.0);
    let Transform { translation, rotation, scale } = transform(&rigs, it);
    let up = rotation.inverse() * Vec3::Y;
    assert!(up.abs().max_element() > 0.999, "it stands on an edge: {up}");
    let height = HALF.dot(up.abs()) + 0.005;
    assert!((translation.y - height).abs() < 5e-3, "it is {} m high, not {height}", translation.y);
    assert_eq!(scale, Vec3::splat(2.0));
    assert_eq!(*rigs.app.world().get::<Activity>(it).expect("a body"), Activity::Resting);
    rigs.assert_no_errors();
}

/// Moving the `Transform` moves the body, which keeps its velocity; an obstacle that comes up to it wakes it.
#[test]
fn a_crate_is_teleported_by_its_transform_and_woken_by_what_comes_near() {
    let mut rigs = rigs();
    ground(&mut rigs);
    let it = crate_at(&mut rigs, Transform::from_xyz(0.0, HALF.y + 0.005, 0.0));
    rigs.seconds(3.0);
    rigs.edit::<Transform>(it, |transform| transform.translation = Vec3::new(4.0, 2.0, 0.0));
    rigs.steps(1);
    let at = transform(&rigs, it).translation;
    assert!(at.distance(Vec3::new(4.0, 2.0, 0.0)) < 0.01, "it is at {at}");
    rigs.seconds(4.0);
    assert_eq!(*rigs.app.world().get::<Activity>(it).expect("a body"), Activity::Resting);
    // A block slides up to a corner, which is outside the box around the four particles.
    let block = rigs.spawn((Obstacle::cuboid(0.2, 0.2, 0.2), Transform::from_xyz(4.5, 0.1, 0.0)));
    for _ in 0..30 {
        rigs.edit::<Transform>(block, |transform| transform.translation.x -= 0.01);
        rigs.steps(1);
    }
    let pushed = 4.0 - transform(&rigs, it).translation.x;
    assert!(pushed > 0.05, "it is pushed by {pushed} m");
    rigs.assert_no_errors();
}

/// S32: from two frames of an animation, it goes on with their velocity and spin.
#[test]
fn a_crate_goes_on_with_the_motion_of_two_frames() {
    let mut rigs = Rigs::weightless();
    let (velocity, spin) = (Vec3::new(1.0, 0.0, -2.0), 2.0);
    let frame = |time: f32| {
        Transform::from_translation(velocity * time).with_rotation(Quat::from_rotation_y(spin * time))
    };
    let body = RigidTetrahedron::cuboid(6.0, HALF).with_motion(&frame(-STEP), &frame(0.0), STEP);
    let it = rigs.spawn((body, frame(0.0)));
    rigs.seconds(0.5);
    let now = transform(&rigs, it);
    assert_near(now.translation, velocity * 0.5, 0.01);
    // Projection takes w^2 h of a spin each second.
    let turned = now.rotation.angle_between(Quat::IDENTITY);
    assert!((turned / (spin * 0.5) - 1.0).abs() < 0.01, "it has turned by {turned}");
}

/// A restored body continues as before: nothing is taken for a teleport.
#[test]
fn a_crate_goes_on_from_a_snapshot_to_the_same_bits() {
    let mut rigs = rigs();
    ground(&mut rigs);
    let it =
        crate_at(&mut rigs, Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_z(0.7)));
    rigs.seconds(0.5);
    let snapshot = Snapshot::take(rigs.app.world_mut());
    let end = |rigs: &mut Rigs| {
        rigs.seconds(0.5);
        rigs.app.world().get::<Particles>(it).expect("a body").0.snapshot()
    };
    let first = end(&mut rigs);
    snapshot.restore(rigs.app.world_mut()).expect("the same world");
    assert_eq!(first, end(&mut rigs));
}

#[test]
fn what_cannot_be_a_rigid_body_is_refused_by_name() {
    let mut rigs = rigs();
    rigs.spawn((RigidTetrahedron { mass: -1.0, ..default() }, Transform::default()));
    rigs.spawn((RigidTetrahedron { inertia: Vec3::new(9.0, 1.0, 1.0), ..default() }, Transform::default()));
    rigs.steps(3);
    assert_eq!(rigs.logged(&["ERROR", "RigidTetrahedron", "mass"]).len(), 1);
    assert_eq!(rigs.logged(&["ERROR", "RigidTetrahedron", "moments of inertia"]).len(), 1);
}
