//! Debug gizmos, without a renderer.

use bevy::gizmos::{GizmoAsset, GizmoPlugin};
use bevy::prelude::*;
use bevy_drape::prelude::*;

use crate::*;

fn app_with_gizmos(is_enabled: bool, drawn: DrapeGizmos) -> App {
    let mut app = app();
    app.add_plugins(GizmoPlugin);
    app.finish();
    app.cleanup();
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    let (config, group) = store.config_mut::<DrapeGizmos>();
    assert!(!config.enabled, "off until switched on");
    (config.enabled, *group) = (is_enabled, drawn);
    app
}

/// Ends of all lines that would be drawn now.
fn lines(app: &App) -> Vec<[Vec3; 2]> {
    let assets = app.world().resource::<Assets<GizmoAsset>>();
    let ends = assets.iter().flat_map(|(_, asset)| asset.buffer().list_positions.chunks(2));
    ends.map(|ends| [ends[0], ends[1]]).collect()
}

const NOTHING: DrapeGizmos = DrapeGizmos {
    structural_sticks: false,
    shear_sticks: false,
    bend_sticks: false,
    particles: false,
    pins: false,
    contacts: false,
    touches: false,
    obstacles: false,
    full_strain: 0.05,
    particle_size: 0.01,
};

/// Lines drawn by a cloth of 4 x 3 particles after a step, its top row pinned.
fn lines_of_a_small_cloth(is_enabled: bool, drawn: DrapeGizmos) -> usize {
    let mut app = app_with_gizmos(is_enabled, drawn);
    app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(4, 3));
    app.update();
    frame(&mut app, 1.0);
    lines(&app).len()
}

#[test]
fn each_kind_is_drawn_by_its_own_switch() {
    let count = |drawn| lines_of_a_small_cloth(true, drawn);
    assert_eq!(count(NOTHING), 0);
    assert_eq!(count(DrapeGizmos { structural_sticks: true, ..NOTHING }), 3 * 3 + 4 * 2);
    assert_eq!(count(DrapeGizmos { shear_sticks: true, ..NOTHING }), 2 * 3 * 2);
    assert_eq!(count(DrapeGizmos { bend_sticks: true, ..NOTHING }), 2 * 3 + 4);
    // Three lines a cross.
    assert_eq!(count(DrapeGizmos { pins: true, ..NOTHING }), 3 * 4);
    assert_eq!(count(DrapeGizmos { particles: true, ..NOTHING }), 3 * 8);
}

#[test]
fn nothing_is_drawn_while_the_group_is_off() {
    assert_eq!(lines_of_a_small_cloth(false, DrapeGizmos { structural_sticks: true, ..NOTHING }), 0);
}

/// Each line lies on the surface of its obstacle, moved, turned and scaled.
#[test]
fn outlines_lie_on_the_surfaces_of_obstacles() {
    for obstacle in [
        Obstacle::sphere(0.3),
        Obstacle::capsule(0.2, 0.5),
        Obstacle::tapered_capsule(0.3, 0.1, 0.5),
        Obstacle::tapered_capsule(0.1, 0.3, 0.5),
        Obstacle::tapered_capsule(0.5, 0.1, 0.2),
        Obstacle::cylinder(0.3, 0.5),
        Obstacle::cone(0.3, 0.5),
        Obstacle::cuboid(0.3, 0.4, 0.5),
    ] {
        let mut app = app_with_gizmos(true, DrapeGizmos { obstacles: true, ..NOTHING });
        let place = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_x(0.7));
        app.world_mut().spawn((obstacle.clone(), place.with_scale(Vec3::splat(2.0))));
        app.update();
        let shape = obstacle.shape.solid(None).expect("valid").expect("no mesh");
        let lines = lines(&app);
        assert!(lines.len() > 11, "{obstacle:?}: {} lines", lines.len());
        for end in lines.into_iter().flatten().filter(|end| end.is_finite()) {
            let local = place.rotation.inverse() * (end - place.translation) * 0.5;
            let off = shape.distance(local);
            let is_held =
                off < 0.0 && matches!(obstacle.shape, ObstacleShape::TaperedCapsule { length: 0.2, .. });
            assert!(off.abs() < 1e-4 || is_held, "{obstacle:?}: {off} m off");
        }
    }
}

#[test]
fn contacts_point_out_of_the_obstacle() {
    let mut app = app_with_gizmos(true, DrapeGizmos { contacts: true, ..NOTHING });
    app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -0.02, 0.0)));
    let lying = Transform::from_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    app.world_mut().spawn((Cloth::new(1.0, 1.0).with_particles(4, 4).with_pins(ClothPins::None), lying));
    app.update();
    assert!(lines(&app).is_empty());
    for _ in 0..30 {
        frame(&mut app, 1.0);
    }
    let lines = lines(&app);
    assert_eq!(lines.len(), 16, "the whole cloth lies on the ground");
    for [from, to] in lines {
        assert!((to - from).normalize().dot(Vec3::Y) > 0.999 && from.y < 0.0);
    }
}

#[test]
fn a_ball_on_the_ground_shows_where_it_touches() {
    let mut app = app_with_gizmos(true, DrapeGizmos { touches: true, ..NOTHING });
    app.world_mut().spawn(Obstacle::ground());
    let ball = Projectile { radius: 0.2, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(0.0, 0.2, 0.0)));
    app.update();
    frame(&mut app, 1.0);
    frame(&mut app, 1.0);
    let lines = lines(&app);
    assert_eq!(lines.len(), 4, "a cross and a normal");
    assert!(lines[3][0].length() < 0.01 && (lines[3][1] - lines[3][0]).y > 0.0);
}

#[test]
fn without_gizmos_in_the_app_nothing_is_asked_of_it() {
    let mut app = app();
    app.world_mut().spawn(swinging());
    start(&mut app);
    frame(&mut app, 1.0);
    assert!(!app.world().contains_resource::<GizmoConfigStore>());
}
