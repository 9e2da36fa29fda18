//! Transforms between fixed steps.

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::origin::ShiftOrigin;
use bevy_drape::prelude::*;

use crate::*;

fn ball() -> (Projectile, Transform) {
    let ball = Projectile { radius: 0.1, velocity: Vec3::new(3.0, 4.0, -1.0), ..default() };
    (ball, Transform::from_xyz(0.0, 2.0, 0.0))
}

fn place(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Transform>(entity).expect("spawned").translation
}

fn state(app: &App, ball: Entity) -> Vec3 {
    app.world().get::<ProjectileState>(ball).expect("built").position()
}

#[test]
fn an_interpolated_ball_is_shown_between_the_last_two_steps() {
    let mut app = app();
    let ball = app.world_mut().spawn((ball(), Interpolated)).id();
    start(&mut app);
    for _ in 0..5 {
        frame(&mut app, 1.0);
    }
    let before = state(&app, ball);
    frame(&mut app, 1.0);
    assert_eq!(place(&app, ball), before);
    frame(&mut app, 0.25);
    let quarter = before.lerp(state(&app, ball), 0.25);
    assert!((place(&app, ball) - quarter).length() < 1e-6);
    let seen = app.world().get::<GlobalTransform>(ball).expect("placed").translation();
    assert_eq!(seen, place(&app, ball), "children and the renderer see the same");
}

#[test]
fn a_ball_without_the_marker_is_shown_where_the_last_step_left_it() {
    let mut app = app();
    let ball = app.world_mut().spawn(ball()).id();
    start(&mut app);
    for _ in 0..5 {
        frame(&mut app, 0.9);
        frame(&mut app, 0.4);
        assert_eq!(place(&app, ball), state(&app, ball));
    }
}

#[test]
fn interpolation_does_not_touch_the_simulation() {
    let fly = |is_interpolated: bool| {
        let mut app = app();
        let (parent, (projectile, transform)) = (Transform::from_xyz(1.0, 0.0, 0.0), ball());
        let parent = app.world_mut().spawn(parent.with_rotation(Quat::from_rotation_z(0.3))).id();
        app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -1.0, 0.0)));
        let balls = [
            app.world_mut().spawn((projectile, transform)).id(),
            app.world_mut().spawn((projectile, transform, ChildOf(parent))).id(),
        ];
        if is_interpolated {
            for ball in balls {
                app.world_mut().entity_mut(ball).insert(Interpolated);
            }
        }
        start(&mut app);
        // Frames of all lengths, from none to several steps, beyond the first bounce.
        for i in 0..200 {
            frame(&mut app, [0.3, 1.0, 2.6, 0.1, 0.0][i % 5]);
        }
        balls.map(|ball| {
            let state = app.world().get::<ProjectileState>(ball).expect("built");
            (state.position(), state.velocity(), state.rotation())
        })
    };
    assert_eq!(fly(true), fly(false));
}

#[test]
fn moving_an_interpolated_ball_by_hand_still_teleports_it() {
    let mut app = app();
    let ball = app.world_mut().spawn((ball(), Interpolated)).id();
    start(&mut app);
    for _ in 0..3 {
        frame(&mut app, 1.5);
    }
    let target = Vec3::new(50.0, 60.0, 70.0);
    app.world_mut().get_mut::<Transform>(ball).expect("spawned").translation = target;
    frame(&mut app, 0.1);
    assert_eq!(place(&app, ball), target, "shown at once");
    frame(&mut app, 1.0);
    assert!((state(&app, ball) - target).length() < 0.5);
}

#[test]
fn what_the_fixed_loop_moves_is_smooth_and_true_within_it() {
    #[derive(Resource, Default)]
    struct Seen(Vec<f32>);
    let mut app = app();
    app.init_resource::<Seen>();
    let lift = |mut lifts: Query<&mut Transform, With<Interpolated>>, mut seen: ResMut<Seen>| {
        for mut lift in &mut lifts {
            seen.0.push(lift.translation.y);
            lift.translation.y += 1.0;
        }
    };
    app.add_systems(FixedUpdate, lift);
    let lift = app.world_mut().spawn((Transform::default(), Interpolated)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let mut shown = Vec::new();
    for _ in 0..8 {
        frame(&mut app, 0.5);
        shown.push(place(&app, lift).y);
    }
    assert_eq!(shown, [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]);
    assert_eq!(app.world().resource::<Seen>().0, [0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn a_still_entity_is_not_marked_as_changed() {
    #[derive(Resource, Default)]
    struct Changes(usize);
    let mut app = app();
    app.init_resource::<Changes>();
    let count = |changed: Query<(), (Changed<Transform>, With<Interpolated>)>,
                 mut changes: ResMut<Changes>| {
        changes.0 += changed.iter().count();
    };
    app.add_systems(Last, count);
    app.world_mut().spawn((Transform::from_xyz(1.0, 2.0, 3.0), Interpolated));
    start(&mut app);
    for _ in 0..5 {
        frame(&mut app, 0.7);
    }
    assert_eq!(app.world().resource::<Changes>().0, 1, "only when it was spawned");
}

/// Meshes show what they would have shown, also in the frame of the shift and between the steps before and after it.
#[test]
fn meshes_do_not_jump_when_the_origin_is_shifted() {
    let world = || {
        let mut app = app();
        let tube = (Rope::new(Vec3::Y, Vec3::new(1.0, 1.0, 0.0), 17), RopeMesh::default(), Mesh3d::default());
        let hung =
            [app.world_mut().spawn((swinging(), Mesh3d::default())).id(), app.world_mut().spawn(tube).id()];
        start(&mut app);
        (0..40).for_each(|_| frame(&mut app, 0.4));
        (app, hung)
    };
    let ((mut straight, hung), (mut shifted, _)) = (world(), world());
    for i in 0..20 {
        if i % 7 == 0 {
            ShiftOrigin(Vec3::new(64.0, -32.0, 128.0)).apply(shifted.world_mut());
        }
        frame(&mut straight, 0.4);
        frame(&mut shifted, 0.4);
        for entity in hung {
            let off = farthest(&vertices(&straight, entity), &vertices(&shifted, entity));
            assert!(off < 2e-4, "{off} m in frame {i}");
        }
    }
}
