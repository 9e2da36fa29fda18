//! Soft balls, and air in closed bodies.

use bevy::prelude::*;
use bevy_drape::body::{Activity, Pressure, Sticks};
use bevy_drape::prelude::*;
use drape_solver::volume;
use drape_solver::{StickKind, StickMaterial, TopologyBuilder};

use crate::common::*;

/// Widest and highest of a body, in metres.
fn size(app: &App, body: Entity) -> Vec3 {
    let (low, high) = get::<Particles>(app, body).bounds();
    high - low
}

#[test]
fn a_soft_ball_falls_is_squeezed_and_is_round_again() {
    let mut app = app();
    app.world_mut().spawn(Obstacle::ground());
    let ball = SoftBall { stiffness: 0.995, damping: 5.0, ..SoftBall::new(0.3) };
    let ball = app.world_mut().spawn((ball, Transform::from_xyz(0.0, 1.5, 0.0))).id();
    let mut flattest = f32::INFINITY;
    for _ in 0..120 {
        step(&mut app, 1);
        flattest = flattest.min(size(&app, ball).y);
    }
    settle(&mut app, ball);
    let lies = size(&app, ball);
    assert!(flattest < 0.55, "it is soft: {flattest} m high");
    assert!((lies.x - 0.6).abs() < 0.02 && (lies.y - 0.6).abs() < 0.02, "round again: {lies}");
    assert!(lies.z < 1e-3, "in its plane");
}

#[test]
fn a_soft_ball_with_a_pinned_rim_hangs_where_its_entity_is() {
    for angle in [0.0, 1.0] {
        let mut app = app();
        let turned = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_y(angle));
        let ball = app.world_mut().spawn((SoftBall { pin_rim: true, ..SoftBall::new(0.3) }, turned)).id();
        run(&mut app, 1.0);
        let particles = get::<Particles>(&app, ball);
        for i in 0..particles.len() {
            let local = turned.compute_affine().inverse().transform_point3(particles.position(i));
            // In the plane of the world's X and Y exactly; in others it may buckle by what is rounded.
            assert!(angle != 0.0 || local.z.abs() < 1e-6, "out of its plane by {} m", local.z);
            if particles.is_pinned(i) {
                assert!((local.length() - 0.3).abs() < 1e-4 && local.z.abs() < 1e-4);
            }
        }
    }
}

#[test]
fn a_soft_ball_takes_its_body_along() {
    let mut app = app();
    let ball = app.world_mut().spawn(SoftBall::default()).id();
    step(&mut app, 1);
    assert!(app.world().get::<Particles>(ball).is_some());
    app.world_mut().entity_mut(ball).remove::<SoftBall>();
    step(&mut app, 1);
    assert!(app.world().get::<Particles>(ball).is_none(), "it takes its body along");
}

#[test]
fn a_soft_ball_that_cannot_be_is_refused_by_name() {
    for (ball, word) in [
        (SoftBall::new(0.0), "radius"),
        (SoftBall::new(f32::NAN), "radius"),
        (SoftBall { rings: 0, ..default() }, "rings"),
        (SoftBall { areal_density: -1.0, ..default() }, "areal_density"),
        (SoftBall { stiffness: 2.0, ..default() }, "stiffness"),
    ] {
        let _ = assert_refused(ball, &["SoftBall", word]);
    }
}

/// A cube of 8 particles with skin, which the user has put together.
fn cube() -> (Particles, Sticks) {
    let corners: Vec<Vec3> =
        (0..8_u8).map(|i| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2))).collect();
    let particles = drape_solver::Particles::new(Vec3::ZERO, &corners, &[1.0; 8]).expect("valid");
    let mut builder = TopologyBuilder::new(&corners);
    let soft = StickMaterial { stiffness: 0.1, damping: 5.0, ..StickMaterial::rigid(StickKind::Structural) };
    let edges = (0..8_u32).flat_map(|i| [1, 2, 4].map(|bit| [i, i | bit])).filter(|[a, b]| a != b);
    builder.family(soft, edges).expect("valid");
    let square = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    builder.faces(squares.into_iter().flat_map(square)).expect("valid");
    (Particles(particles), Sticks(std::sync::Arc::new(builder.build().expect("valid"))))
}

#[test]
fn pressure_blows_up_what_is_closed_and_wakes_it() {
    let mut app = app();
    weightless(&mut app);
    let body = app.world_mut().spawn(cube()).id();
    let own_volume = |app: &App| volume(get::<Particles>(app, body), get::<Sticks>(app, body));
    settle(&mut app, body);
    assert!((own_volume(&app) - 1.0).abs() < 0.01);
    app.world_mut().entity_mut(body).insert(Pressure(1.5));
    step(&mut app, 2);
    assert_eq!(activity(&app, body), Activity::Active);
    run(&mut app, 3.0);
    assert!((own_volume(&app) - 1.5).abs() < 0.02, "{} m^3", own_volume(&app));
    get_mut::<Pressure>(&mut app, body).0 = f32::NAN;
    step(&mut app, 2);
    let messages = refusals(&app, body);
    assert!(messages.len() == 1 && messages[0].contains("pressure"), "{messages:?}");
}
