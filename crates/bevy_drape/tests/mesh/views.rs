//! Meshes in view are written, and no others.

use bevy::camera::CameraProjection;
use bevy::camera::primitives::{Aabb, Frustum};
use bevy::camera::visibility::{NoFrustumCulling, SetViewVisibility, ViewVisibility, VisibilitySystems};
use bevy::math::Vec3A;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::render::DrivenMesh;

use crate::*;

/// A camera at the origin that looks along -Z.
fn camera(app: &mut App) -> Entity {
    app.world_mut().spawn((Camera::default(), looking(Quat::IDENTITY))).id()
}

/// The view of a camera at the origin, turned by `rotation`.
fn looking(rotation: Quat) -> Frustum {
    PerspectiveProjection::default().compute_frustum(&Transform::from_rotation(rotation).into())
}

fn turn(app: &mut App, camera: Entity) {
    *app.world_mut().get_mut::<Frustum>(camera).expect("a camera") = looking(Quat::from_rotation_y(3.0));
}

fn at(z: f32) -> Transform {
    Transform::from_xyz(0.0, 0.0, z)
}

#[test]
fn what_is_behind_the_camera_is_written_in_the_frame_in_which_it_turns_there() {
    let mut app = app();
    let camera = camera(&mut app);
    let [before, behind] = [-5.0, 5.0].map(|z| app.world_mut().spawn((swinging(), at(z))).id());
    start(&mut app);
    frame(&mut app, 1.0);
    let unseen = vertices(&app, behind);
    for _ in 0..30 {
        frame(&mut app, 1.0);
    }
    let far = |app: &App, cloth| farthest(&world_vertices(app, cloth), &particles(app, cloth));
    // A frame shows a time within the last step.
    assert!(far(&app, before) < 0.1, "{}", far(&app, before));
    assert_eq!(vertices(&app, behind), unseen);
    assert!(far(&app, behind) > 0.2, "it has swung meanwhile");
    turn(&mut app, camera);
    frame(&mut app, 1.0);
    assert!(far(&app, behind) < 0.1, "{}", far(&app, behind));
}

/// Bounds follow what is not written: it could not come into view else.
#[test]
fn the_bounds_of_what_is_unseen_hold_all_that_is_drawn_once_it_is_seen() {
    let mut app = app();
    let camera = camera(&mut app);
    let world = app.world_mut();
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let [cube, ball] = [meshes.add(Cuboid::from_length(0.5)), meshes.add(Sphere::new(0.4).mesh().uv(16, 12))];
    let cloth = world.spawn((swinging(), at(5.0))).id();
    let rope = world.spawn((Rope::default(), RopeMesh::new(0.05), at(6.0))).id();
    let jelly = world.spawn((Mesh3d(cube), SoftBodyMesh::default(), at(7.0))).id();
    let detail = world.spawn((Mesh3d(ball), DrivenMesh { driver: jelly }, at(7.0))).id();
    start(&mut app);
    for _ in 0..20 {
        frame(&mut app, 1.0);
    }
    let all = [cloth, rope, jelly, detail];
    let bounds = all.map(|entity| *app.world().get::<Aabb>(entity).expect("bounds"));
    let before = all.map(|entity| vertices(&app, entity));
    turn(&mut app, camera);
    frame(&mut app, 0.0);
    for ((entity, bounds), before) in all.into_iter().zip(bounds).zip(before) {
        let now = vertices(&app, entity);
        assert!(farthest(&now, &before) > 0.02, "it was not written before");
        for vertex in now {
            let vertex = Vec3A::from(vertex);
            let is_inside =
                vertex.cmpge(bounds.min() - 1e-5).all() && vertex.cmple(bounds.max() + 1e-5).all();
            assert!(is_inside, "{vertex} of {entity} in {bounds:?}");
        }
    }
}

#[test]
fn what_a_light_sees_is_written_and_what_is_never_culled() {
    #[derive(Component)]
    struct Lit;
    let mut app = app();
    camera(&mut app);
    app.add_systems(
        PostUpdate,
        (|mut lit: Query<&mut ViewVisibility, With<Lit>>| {
            lit.iter_mut().for_each(|mut seen| seen.set_visible());
        })
        .in_set(VisibilitySystems::CheckVisibility),
    );
    let lit = app.world_mut().spawn((swinging(), at(5.0), Lit)).id();
    let never_culled = app.world_mut().spawn((swinging(), at(5.0), NoFrustumCulling)).id();
    start(&mut app);
    for _ in 0..30 {
        frame(&mut app, 1.0);
    }
    for cloth in [lit, never_culled] {
        assert!(farthest(&world_vertices(&app, cloth), &particles(&app, cloth)) < 0.1);
    }
}

/// Nothing is drawn in an app without cameras; whoever asks for a mesh there means it as it is now.
#[test]
fn without_an_active_camera_all_is_written() {
    let mut app = app();
    let camera = camera(&mut app);
    let behind = app.world_mut().spawn((swinging(), at(5.0))).id();
    start(&mut app);
    app.world_mut().get_mut::<Camera>(camera).expect("a camera").is_active = false;
    for _ in 0..30 {
        frame(&mut app, 1.0);
    }
    assert!(farthest(&world_vertices(&app, behind), &particles(&app, behind)) < 0.1);
}

/// From eight on threads share them.
#[test]
fn many_are_written_as_one_is() {
    let mut app = app();
    camera(&mut app);
    let alone = |app: &mut App, x: f32, z: f32| {
        app.world_mut().spawn((swinging(), Transform::from_xyz(x, 0.0, z))).id()
    };
    let seen: Vec<Entity> = (0..12).map(|i| alone(&mut app, 0.0, -5.0 - i as f32)).collect();
    let behind = alone(&mut app, 0.0, 5.0);
    start(&mut app);
    frame(&mut app, 1.0);
    let before = vertices(&app, behind);
    for _ in 0..30 {
        frame(&mut app, 1.4);
    }
    for &cloth in &seen {
        let (own, first) = (vertices(&app, cloth), vertices(&app, seen[0]));
        assert!(farthest(&own, &first) < 1e-5, "the same cloth elsewhere");
        assert!(farthest(&world_vertices(&app, cloth), &particles(&app, cloth)) < 0.1);
        assert!(normals_of(&app, cloth).iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
    }
    assert_eq!(vertices(&app, behind), before);
}
