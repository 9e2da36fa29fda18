//! Bodies on the GPU fall asleep and wake as on the processor.

use bevy_drape::body::Activity;
use bevy_drape::sleep::{ActivityCounts, BodySlept, BodyWoken, SceneManager};

use crate::*;

fn activity(app: &App, body: Entity) -> Activity {
    *app.world().get::<Activity>(body).expect("a body")
}

/// A sheet that lies on the ground with its middle at `x`.
fn lying(x: f32) -> impl Bundle {
    lying_at(x, 0.0)
}

/// A sheet that lies at this height.
fn lying_at(x: f32, height: f32) -> impl Bundle {
    let place = Transform::from_xyz(x, height + 0.02, 0.0).with_rotation(Quat::from_rotation_x(-1.570_796_4));
    (Cloth::new(0.6, 0.6).with_particles(9, 9).with_pins(ClothPins::None), place)
}

/// Bodies that fell asleep, and that woke.
#[derive(Resource, Default)]
struct Heard([Vec<Entity>; 2]);

/// An app with two sheets that sleep on the ground, a metre apart.
fn with_sleepers() -> (App, [Entity; 2]) {
    let mut app = app();
    app.init_resource::<Heard>()
        .add_observer(|slept: On<BodySlept>, mut heard: ResMut<Heard>| heard.0[0].push(slept.body))
        .add_observer(|woken: On<BodyWoken>, mut heard: ResMut<Heard>| heard.0[1].push(woken.body));
    app.world_mut().spawn(Obstacle::ground());
    let sheets = [spawn(&mut app, lying(0.0)), spawn(&mut app, lying(1.6))];
    for _ in 0..30 {
        run(&mut app, 10);
        if sheets.iter().all(|&sheet| activity(&app, sheet) == Activity::Resting) {
            run(&mut app, 2);
            return (app, sheets);
        }
    }
    panic!("they do not fall asleep");
}

#[test]
fn bodies_at_rest_fall_asleep_and_are_counted() {
    let (mut app, [one, two]) = with_sleepers();
    assert!(is_on_gpu(&app, one) && is_on_gpu(&app, two));
    assert_eq!(app.world().resource::<ActivityCounts>().resting, 2);
    let [slept, woken] = &app.world().resource::<Heard>().0;
    assert!(slept.len() == 2 && slept.contains(&one) && slept.contains(&two), "{slept:?}");
    assert!(woken.is_empty(), "{woken:?}");
    let world = app.world().resource::<GpuBodies>().world().expect("a world");
    assert!(world.is_resting());
    let there = positions(&app, one);
    run(&mut app, 10);
    assert_eq!(positions(&app, one), there);
}

/// A swing is slow at its turning points.
#[test]
fn what_moves_stays_awake() {
    let mut app = app();
    let cloth = spawn(&mut app, swinging());
    for _ in 0..40 {
        run(&mut app, 4);
        assert_eq!(activity(&app, cloth), Activity::Active);
    }
}

#[test]
fn an_obstacle_wakes_what_it_reaches_and_nothing_else() {
    let (mut app, [one, two]) = with_sleepers();
    let ball = app.world_mut().spawn((Obstacle::sphere(0.2), Transform::from_xyz(-2.0, 0.1, 0.0))).id();
    run(&mut app, 1);
    assert_eq!([activity(&app, one), activity(&app, two)], [Activity::Resting; 2]);
    let there = positions(&app, one);
    for i in 1..=20 {
        app.world_mut().entity_mut(ball).insert(Transform::from_xyz(-2.0 + 0.1 * i as f32, 0.1, 0.0));
        run(&mut app, 1);
    }
    assert_eq!([activity(&app, one), activity(&app, two)], [Activity::Active, Activity::Resting]);
    let moved = positions(&app, one).iter().zip(&there).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(moved > 0.05, "the ball shoves it, by {moved} m");
    assert_eq!(app.world().resource::<Heard>().0[1], [one]);
    app.world_mut().entity_mut(ball).despawn();
    run(&mut app, 300);
    assert_eq!(activity(&app, one), Activity::Resting, "it sleeps again");
}

/// The support of a body may go in the very step after it fell asleep, and rounding may part their boxes. Once it hung in the air then, for good.
#[test]
fn what_loses_its_support_falls() {
    for (late, height) in [(0, 0.0), (1, 0.0), (5, 0.7), (0, 1.3), (2, 8.1)] {
        let mut app = app();
        let table = Transform::from_xyz(0.0, height - 0.1, 0.0);
        let table = app.world_mut().spawn((Obstacle::cuboid(2.0, 0.2, 2.0), table)).id();
        let sheet = spawn(&mut app, lying_at(0.0, height));
        run(&mut app, 1);
        let mut frames = 0;
        while activity(&app, sheet) != Activity::Resting {
            run(&mut app, 1);
            frames += 1;
            assert!(frames < 400, "it does not fall asleep");
        }
        run(&mut app, late);
        let there = positions(&app, sheet)[40].y;
        app.world_mut().entity_mut(table).despawn();
        run(&mut app, 20);
        assert!(positions(&app, sheet)[40].y < there - 0.2, "{late}, {height}: it falls");
    }
}

/// A report from before a change knows nothing of it.
#[test]
fn what_is_disturbed_while_a_report_is_on_its_way_stays_awake() {
    // It falls asleep after 64 steps and a few.
    for frames in 63..75 {
        let mut app = app();
        let curtain = spawn(&mut app, Cloth::new(0.4, 0.4).with_particles(5, 5));
        run(&mut app, frames);
        app.insert_resource(DrapeGravity(Vec3::new(0.0, 0.0, 9.81)));
        run(&mut app, 30);
        let corner = positions(&app, curtain)[24];
        assert!(corner.z > 0.05, "{frames}: it swings forward: {corner}");
    }
}

#[test]
fn a_body_that_is_put_to_sleep_at_once_is_woken_by_an_obstacle() {
    let mut app = app();
    let sheet = spawn(&mut app, lying(0.0));
    while !is_on_gpu(&app, sheet) {
        run(&mut app, 1);
    }
    app.world_mut().entity_mut(sheet).insert(Activity::Resting);
    run(&mut app, 10);
    assert_eq!(activity(&app, sheet), Activity::Resting);
    app.world_mut().spawn((Obstacle::sphere(0.2), Transform::from_xyz(0.1, 0.0, 0.1)));
    run(&mut app, 2);
    assert_eq!(activity(&app, sheet), Activity::Active);
}

#[test]
fn gravity_wakes_all_and_an_activity_that_is_set_wakes_one() {
    let (mut app, [one, two]) = with_sleepers();
    app.world_mut().entity_mut(two).insert(Activity::Active);
    run(&mut app, 1);
    assert_eq!([activity(&app, one), activity(&app, two)], [Activity::Resting, Activity::Active]);
    app.insert_resource(DrapeGravity(Vec3::new(0.0, 3.0, 0.0)));
    let there = positions(&app, one)[40];
    run(&mut app, 20);
    assert_eq!([activity(&app, one), activity(&app, two)], [Activity::Active; 2]);
    assert!(positions(&app, one)[40].y > there.y + 0.1, "it rises");
}

#[test]
fn a_pin_that_moves_wakes_its_body() {
    let mut app = app();
    let curtain = spawn(&mut app, Cloth::new(1.0, 1.0).with_particles(9, 9));
    run(&mut app, 200);
    assert_eq!(activity(&app, curtain), Activity::Resting);
    for i in 1..=20 {
        app.world_mut().entity_mut(curtain).insert(Transform::from_xyz(0.05 * i as f32, 0.0, 0.0));
        run(&mut app, 1);
    }
    assert_eq!(activity(&app, curtain), Activity::Active);
    assert!(positions(&app, curtain)[80].x > 0.6, "it is drawn along");
}

#[test]
fn what_leaves_the_play_area_is_culled() {
    let mut app = app();
    app.world_mut().resource_mut::<SceneManager>().play_area_min.y = -3.0;
    let sheet = spawn(&mut app, (swinging().with_pins(ClothPins::None), Visibility::Visible));
    run(&mut app, 100);
    assert_eq!(activity(&app, sheet), Activity::Culled);
    assert_eq!(app.world().get::<Visibility>(sheet), Some(&Visibility::Hidden));
    let there = positions(&app, sheet);
    run(&mut app, 10);
    assert_eq!(positions(&app, sheet), there);
    app.world_mut().resource_mut::<SceneManager>().play_area_min.y = -100.0;
    app.world_mut().entity_mut(sheet).insert(Activity::Active);
    run(&mut app, 10);
    assert!(positions(&app, sheet)[40].y < there[40].y - 0.02, "it falls on");
    assert_eq!(app.world().get::<Visibility>(sheet), Some(&Visibility::Visible));
}
