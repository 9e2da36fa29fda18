//! Obstacles from meshes: alone, and from whole scenes.

use bevy::asset::{AssetPlugin, RenderAssetUsages};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::drape_solver::{BuildError, MeshError};
use bevy_drape::environment::ShapeFromMesh;
use bevy_drape::render::MeshFault;
use bevy_drape::snapshot::Snapshot;

use crate::*;

/// Radius of the balls in metres.
const RADIUS: f32 = 0.1;

fn add(app: &mut App, mesh: impl Into<Mesh>) -> Mesh3d {
    Mesh3d(app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh.into()))
}

/// Lets go of a ball.
fn drop_ball(app: &mut App, from: Vec3) -> Entity {
    let ball = Projectile { radius: RADIUS, restitution: 0.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_translation(from))).id()
}

/// The height of a ball in metres.
fn height(app: &App, ball: Entity) -> f32 {
    app.world().get::<ProjectileState>(ball).expect("a ball").position().y
}

/// Takes the steps of so many seconds.
fn run(app: &mut App, seconds: f32) {
    (0..(64.0 * seconds) as usize).for_each(|_| frame(app, 1.0));
}

/// Height in metres that a ball has, two seconds after it was let go a metre above the entity.
fn height_over(app: &mut App, entity: Entity) -> f32 {
    let place = app.world().get::<Transform>(entity).expect("placed").translation;
    let ball = drop_ball(app, place + Vec3::Y);
    run(app, 2.0);
    let height = height(app, ball);
    app.world_mut().despawn(ball);
    height
}

fn refusals(app: &App, entity: Entity) -> Vec<String> {
    app.world().resource::<Refusals>().of(entity).map(ToString::to_string).collect()
}

fn is_obstacle(app: &App, entity: Entity) -> bool {
    app.world().get::<Obstacle>(entity).is_some()
}

#[test]
fn balls_lie_on_the_mesh_of_an_obstacle_and_on_its_hull() {
    // A ball falls through a ring, and lies on its hull.
    let ring = || Torus { minor_radius: 0.1, major_radius: 0.4 }.mesh().minor_resolution(48).build();
    for (obstacle, rests_at) in [(Obstacle::trimesh(), -10.0), (Obstacle::convex_hull(), 0.2)] {
        let mut app = app();
        let mesh = add(&mut app, ring());
        let ring = app.world_mut().spawn((mesh, obstacle)).id();
        start(&mut app);
        let height = height_over(&mut app, ring);
        if rests_at < 0.0 {
            assert!(height < rests_at, "{height}");
        } else {
            assert!((height - rests_at).abs() < 0.005, "{height}");
        }
    }
}

#[test]
fn an_obstacle_waits_for_its_mesh_and_then_holds() {
    let mut app = app();
    start(&mut app);
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let table = app.world_mut().spawn((Mesh3d(handle.clone()), Obstacle::trimesh())).id();
    assert!(height_over(&mut app, table) < -10.0, "there is nothing yet");
    assert!(refusals(&app, table).is_empty(), "{:?}", refusals(&app, table));
    let mesh = Cuboid::new(1.0, 0.4, 1.0).into();
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, mesh).expect("the handle is alive");
    let on_top = height_over(&mut app, table);
    assert!((on_top - 0.3).abs() < 0.005, "{on_top}");
}

#[test]
fn an_obstacle_follows_its_mesh_and_its_scale() {
    let mut app = app();
    let mesh = add(&mut app, Cuboid::new(1.0, 0.4, 1.0));
    let other = add(&mut app, Cuboid::new(1.0, 1.2, 1.0));
    let table = app.world_mut().spawn((mesh.clone(), Obstacle::trimesh())).id();
    start(&mut app);
    assert!((height_over(&mut app, table) - 0.3).abs() < 0.005);
    // The asset changes.
    let lower = Cuboid::new(1.0, 0.2, 1.0).into();
    *app.world_mut().resource_mut::<Assets<Mesh>>().get_mut(&mesh).expect("loaded") = lower;
    assert!((height_over(&mut app, table) - 0.2).abs() < 0.005);
    // Another mesh.
    app.world_mut().entity_mut(table).insert(other);
    assert!((height_over(&mut app, table) - 0.7).abs() < 0.005);
    app.world_mut().entity_mut(table).insert(Transform::from_scale(Vec3::new(1.0, 0.5, 1.0)));
    assert!((height_over(&mut app, table) - 0.4).abs() < 0.005);
    app.world_mut().entity_mut(table).remove::<Obstacle>();
    assert!(app.world().get::<ShapeFromMesh>(table).is_none());
    assert!(height_over(&mut app, table) < -10.0);
}

fn triangles(corners: Vec<[f32; 3]>, indices: Vec<u32>) -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
        .with_inserted_indices(Indices::U32(indices))
}

/// Parry would panic on some of these; the others have no surface.
#[test]
fn meshes_that_no_obstacle_can_be_made_of_are_refused_by_name() {
    let corners = || vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let with = |corner| triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], corner], vec![0, 1, 2]);
    let is_not_finite = |fault: &MeshFault| matches!(fault, MeshFault::Mesh(MeshError::NotFinite { .. }));
    let is_bad =
        |fault: &MeshFault| matches!(fault, MeshFault::Mesh(MeshError::Build(BuildError::BadShape { .. })));
    let cases: [(Mesh, Obstacle, &dyn Fn(&MeshFault) -> bool); 6] = [
        (with([f32::NAN; 3]), Obstacle::trimesh(), &is_not_finite),
        (with([f32::INFINITY; 3]), Obstacle::convex_hull(), &is_not_finite),
        (triangles(corners(), vec![0, 1, 7]), Obstacle::trimesh(), &|fault| {
            matches!(fault, MeshFault::Mesh(MeshError::NoSuchVertex { vertex: 7, .. }))
        }),
        (triangles(corners(), Vec::new()), Obstacle::trimesh(), &|fault| {
            matches!(fault, MeshFault::Mesh(MeshError::NoFaces { vertices: 3 }))
        }),
        (with([2.0, 0.0, 0.0]), Obstacle::trimesh(), &is_bad),
        (triangles(vec![[1.0; 3]; 4], vec![0, 1, 2, 0, 2, 3]), Obstacle::convex_hull(), &is_bad),
    ];
    for (index, (mesh, obstacle, is_expected)) in cases.into_iter().enumerate() {
        let mut app = app();
        let mesh = add(&mut app, mesh);
        let entity = app.world_mut().spawn((mesh, obstacle)).id();
        start(&mut app);
        frame(&mut app, 2.0);
        let refusals = app.world().resource::<Refusals>();
        let refusal = refusals.of(entity).next().unwrap_or_else(|| panic!("case {index} is not refused"));
        let fault = refusal.error().source().and_then(|source| source.downcast_ref());
        assert!(fault.is_some_and(is_expected), "case {index}: {refusal}");
        let good = add(&mut app, Cuboid::new(1.0, 0.4, 1.0));
        app.world_mut().entity_mut(entity).insert(good);
        assert!((height_over(&mut app, entity) - 0.3).abs() < 0.005, "case {index}: mended");
        assert!(self::refusals(&app, entity).is_empty(), "case {index}");
    }
}

/// The asset of a refused mesh was not watched where Bevy's `MeshPlugin`, which marks `Mesh3d` as changed, is missing.
#[test]
fn a_refused_mesh_that_is_mended_in_place_makes_its_obstacle() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin, DrapePlugins::default()))
        .init_asset::<Mesh>();
    let mesh = add(&mut app, triangles(vec![[0.0; 3]; 3], Vec::new()));
    let entity = app.world_mut().spawn((mesh.clone(), Obstacle::trimesh())).id();
    start(&mut app);
    frame(&mut app, 2.0);
    assert!(refusals(&app, entity)[0].contains("triangles"), "{:?}", refusals(&app, entity));
    let good = Cuboid::new(1.0, 0.4, 1.0).into();
    *app.world_mut().resource_mut::<Assets<Mesh>>().get_mut(&mesh).expect("loaded") = good;
    assert!((height_over(&mut app, entity) - 0.3).abs() < 0.005);
    assert!(refusals(&app, entity).is_empty());
}

#[test]
fn an_obstacle_without_the_mesh_that_it_needs_is_refused() {
    let mut app = app();
    let entity = app.world_mut().spawn(Obstacle::convex_hull()).id();
    start(&mut app);
    frame(&mut app, 1.0);
    assert!(refusals(&app, entity)[0].contains("Mesh3d"), "{:?}", refusals(&app, entity));
}

#[test]
fn a_snapshot_brings_an_obstacle_of_a_mesh_back() {
    let mut app = app();
    let mesh = add(&mut app, Cuboid::new(1.0, 0.4, 1.0));
    app.world_mut().spawn((mesh, Obstacle::trimesh()));
    start(&mut app);
    let ball = drop_ball(&mut app, Vec3::Y);
    run(&mut app, 0.2);
    let snapshot = Snapshot::take(app.world_mut());
    run(&mut app, 1.0);
    let lies_at = height(&app, ball);
    assert!((lies_at - 0.3).abs() < 0.005, "{lies_at}");
    snapshot.restore(app.world_mut()).expect("the mesh is still there");
    assert!(height(&app, ball) > 0.6);
    run(&mut app, 1.0);
    assert_eq!(height(&app, ball).to_bits(), lies_at.to_bits());
}

/// A scene of a table, a lamp on it, a rug, a cloth, and somebody with a skin.
struct Scene {
    root: Entity,
    table: Entity,
    lamp: Entity,
    rug: Entity,
    cloth: Entity,
    skin: Entity,
}

fn scene(app: &mut App, hierarchy: ObstacleHierarchy) -> Scene {
    let cube = add(app, Cuboid::from_length(0.2));
    let sheet = add(app, Plane3d::default().mesh().subdivisions(4).build());
    let world = app.world_mut();
    let root = world.spawn((hierarchy, Transform::default())).id();
    let mut below = |parent, name: &'static str, more: Option<Mesh3d>| {
        let entity = world.spawn((Name::new(name), Transform::default(), ChildOf(parent))).id();
        if let Some(mesh) = more {
            world.entity_mut(entity).insert(mesh);
        }
        entity
    };
    let table_node = below(root, "Table", None);
    let table = below(table_node, "part", Some(cube.clone()));
    let lamp_node = below(table_node, "Lamp", None);
    let lamp = below(lamp_node, "part", Some(cube.clone()));
    let rug = below(root, "Rug", Some(cube.clone()));
    let cloth = below(root, "cloth", Some(sheet));
    let skin = below(root, "skin", Some(cube));
    world.entity_mut(cloth).insert(ClothMesh::default());
    world.entity_mut(skin).insert(SkinnedMesh::default());
    Scene { root, table, lamp, rug, cloth, skin }
}

#[test]
fn a_scene_becomes_obstacles_but_for_what_is_named_and_what_is_soft() {
    let mut app = app();
    let rough = Obstacle::convex_hull().with_friction(0.9);
    let hierarchy = ObstacleHierarchy::default().and_named("Lamp", rough).except_named("Rug");
    let Scene { root, table, lamp, rug, cloth, skin } = scene(&mut app, hierarchy);
    start(&mut app);
    frame(&mut app, 1.0);
    let friction = |app: &App, entity| app.world().get::<Obstacle>(entity).map(|obstacle| obstacle.friction);
    assert_eq!(friction(&app, table), Some(0.5));
    assert_eq!(friction(&app, lamp), Some(0.9), "the nearest name counts");
    for (name, entity) in [("rug", rug), ("cloth", cloth), ("skin", skin)] {
        assert!(!is_obstacle(&app, entity), "{name}");
    }
    // What comes later, and a hierarchy that changes.
    let mesh = app.world().get::<Mesh3d>(table).cloned().expect("a mesh");
    let late = app.world_mut().spawn((mesh.clone(), Transform::default(), ChildOf(root))).id();
    let own = app.world_mut().spawn((mesh, Obstacle::sphere(0.3), ChildOf(root))).id();
    frame(&mut app, 1.0);
    assert!(is_obstacle(&app, late));
    *app.world_mut().get_mut(root).expect("the root") =
        ObstacleHierarchy::only_named().and_named("Rug", Obstacle::trimesh());
    frame(&mut app, 1.0);
    assert!(!is_obstacle(&app, table) && !is_obstacle(&app, late) && is_obstacle(&app, rug));
    app.world_mut().entity_mut(root).remove::<ObstacleHierarchy>();
    assert!(!is_obstacle(&app, rug));
    assert!(is_obstacle(&app, own), "it was not made by the hierarchy");
    assert!(app.world().resource::<Refusals>().is_empty());
}
