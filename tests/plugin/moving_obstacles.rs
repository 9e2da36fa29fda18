//! Obstacles that move with their transforms, near cloth and far from it.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::snapshot::Snapshot;

use crate::common::*;

/// A curtain, and a sphere that flies through it along z, from far away and to far away. With a witness, ropes that nothing
/// touches hang along all its way.
fn fly_through(has_witness: bool, is_restored: bool) -> Vec<u64> {
    let mut app = app();
    let curtain = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
    let sphere = app.world_mut().spawn((Obstacle::sphere(0.3), at(-1.0))).id();
    if has_witness {
        for z in -33..3 {
            app.world_mut().spawn(witness(z as f32));
        }
    }
    let (mut hashes, mut pushed) = (Vec::new(), 0.0_f32);
    for count in 0..240 {
        // Through the curtain and away, to a halt for a moment, and back.
        let way = (count as f32 - 120.0).abs() - 120.0;
        get_mut::<Transform>(&mut app, sphere).translation.z = 2.0 + (0.25 * way).max(-27.0);
        app.update();
        if is_restored && count % 37 == 0 {
            let snapshot = Snapshot::take(app.world_mut());
            snapshot.restore(app.world_mut()).expect("it is of this world");
        }
        hashes.push(hash(&app, &[curtain]));
        pushed = pushed.max(centre(&app, curtain).z.abs());
    }
    assert!(pushed > 0.1, "the sphere has pushed the curtain by {pushed} m");
    hashes
}

/// A rope beside the way of a sphere, which it does not touch.
fn witness(z: f32) -> impl Bundle {
    (Rope::default(), DrapeLayers::new(2, 2), Transform::from_xyz(0.5, 2.0, z))
}

fn at(z: f32) -> Transform {
    Transform::from_xyz(0.0, 1.5, z)
}

#[test]
fn an_obstacle_that_nothing_was_near_moves_as_one_among_others() {
    let alone = fly_through(false, false);
    assert_eq!(alone, fly_through(true, false));
    assert_eq!(alone, fly_through(false, true));
}

/// An obstacle that was listed twice stopped for a step.
#[test]
fn what_an_obstacle_reports_can_change_while_it_moves() {
    let pushed = |is_changed: bool| {
        let mut app = app();
        let curtain = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
        let sphere = app.world_mut().spawn((Obstacle::sphere(0.3), ContactEvents, at(-1.0))).id();
        for _ in 0..30 {
            get_mut::<Transform>(&mut app, sphere).translation.z += 0.05;
            if is_changed {
                app.world_mut().entity_mut(sphere).remove::<ContactEvents>().insert(ContactEvents);
            }
            app.update();
        }
        hash(&app, &[curtain])
    };
    assert_eq!(pushed(true), pushed(false));
}

/// It would stay out of reach for good.
#[test]
fn an_obstacle_that_leaps_from_afar_to_afar_is_there() {
    let mut app = app();
    let table =
        app.world_mut().spawn((Obstacle::cuboid(1.0, 0.1, 1.0), Transform::from_xyz(9.0, 0.0, 0.0))).id();
    app.world_mut().spawn((curtain(), Transform::default()));
    app.update();
    // The last one is a leap at once: farther than anything moves in a step.
    for x in [10.0, 11.0, 99.0] {
        get_mut::<Transform>(&mut app, table).translation.x = x;
        app.update();
    }
    app.update();
    let lying = Transform::from_xyz(99.0, 0.3, 0.0).with_rotation(Quat::from_rotation_x(1.5));
    let cloth = app.world_mut().spawn((free_cloth(), lying)).id();
    run(&mut app, 1.0);
    let height = centre(&app, cloth).y;
    assert!((0.05..0.06).contains(&height), "it lies at {height} m, and the table is 0.05 m high");
}

#[test]
fn an_obstacle_that_moves_far_upwind_shelters() {
    let blown = |creep: Option<f32>| {
        let mut app = app();
        app.insert_resource(Wind { shelter: 1.0, ..Wind::new(Vec3::Z * 6.0) });
        let curtain = app.world_mut().spawn((curtain(), Transform::from_xyz(0.0, 2.0, 0.0))).id();
        let wall = creep.map(|_| app.world_mut().spawn((Obstacle::cuboid(3.0, 3.0, 0.1), at(-8.0))).id());
        for _ in 0..120 {
            if let (Some(wall), Some(creep)) = (wall, creep) {
                get_mut::<Transform>(&mut app, wall).translation.z += creep;
            }
            app.update();
        }
        centre(&app, curtain).z
    };
    let [open, sheltered, by_moving] = [blown(None), blown(Some(0.0)), blown(Some(1e-3))];
    assert!(open > 0.2 && sheltered < 0.02, "{open} m in the open, {sheltered} m behind a wall");
    assert!(
        (by_moving - sheltered).abs() < 1e-3,
        "{by_moving} m behind a wall that moves, else {sheltered} m"
    );
}
