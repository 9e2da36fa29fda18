//! Which mesh a cloth has, and what of it is kept.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::prelude::*;

use crate::*;

fn coordinates(app: &App, entity: Entity) -> Vec<[f32; 2]> {
    match mesh_of(app, entity).attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
        other => panic!("not two numbers a vertex: {other:?}"),
    }
}

/// A mesh of one's own, of `count` vertices and one triangle, without normals.
fn own_mesh(count: usize) -> Mesh {
    let coordinates: Vec<_> = (0..count).map(|i| [i as f32, -1.0]).collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::MAIN_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[9.0_f32; 3]; count])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, coordinates)
        .with_inserted_indices(Indices::U16(vec![0, 1, 2]))
}

#[test]
fn a_cloth_gets_a_mesh_of_its_faces_with_texture_coordinates_from_the_top_left() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(2.0, 1.0).with_particles(5, 3)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let mesh = mesh_of(&app, cloth);
    assert_eq!(mesh.primitive_topology(), PrimitiveTopology::TriangleList);
    assert_eq!(mesh.asset_usage, RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD);
    let indices: Vec<usize> = mesh.indices().expect("indices").iter().collect();
    let sticks = app.world().get::<Sticks>(cloth).expect("built");
    assert_eq!(indices, sticks.faces().iter().flatten().map(|&i| i as usize).collect::<Vec<_>>());
    let (vertices, coordinates) = (vertices(&app, cloth), coordinates(&app, cloth));
    // Seen from the front, +X is right and +Y up: (0, 0) at the least x and the greatest y.
    for (vertex, [u, v]) in vertices.iter().zip(coordinates) {
        assert!((vertex.x - (2.0 * u - 1.0)).abs() < 1e-3 && (vertex.y - (0.5 - v)).abs() < 1e-2);
    }
}

#[test]
fn a_mesh_with_one_vertex_for_each_particle_is_kept_with_its_texture_coordinates_and_indices() {
    let mut app = app();
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(own_mesh(81));
    let cloth = app.world_mut().spawn((swinging(), Mesh3d(handle.clone()))).id();
    start(&mut app);
    for _ in 0..5 {
        frame(&mut app, 0.8);
    }
    assert_eq!(app.world().get::<Mesh3d>(cloth), Some(&Mesh3d(handle)));
    assert!(coordinates(&app, cloth).iter().enumerate().all(|(i, uv)| *uv == [i as f32, -1.0]));
    let mesh = mesh_of(&app, cloth);
    assert_eq!(mesh.indices().map(Indices::len), Some(3));
    assert_eq!(mesh.asset_usage, RenderAssetUsages::MAIN_WORLD | RenderAssetUsages::RENDER_WORLD);
    assert!(farthest(&vertices(&app, cloth), &particles(&app, cloth)) < 0.1, "its vertices follow the cloth");
    assert_eq!(normals_of(&app, cloth).len(), 81, "and it gets the normals that it lacked");
}

#[test]
fn a_mesh_of_another_number_of_vertices_is_replaced_and_left_alone() {
    let mut app = app();
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(own_mesh(12));
    let cloth = app.world_mut().spawn((swinging(), Mesh3d(handle.clone()))).id();
    start(&mut app);
    frame(&mut app, 1.0);
    assert_eq!(vertices(&app, cloth).len(), 81);
    let meshes = app.world().resource::<Assets<Mesh>>();
    assert_eq!(meshes.get(&handle).map(Mesh::count_vertices), Some(12));
}

#[test]
fn cloths_that_share_a_mesh_get_one_each() {
    let mut app = app();
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(own_mesh(81));
    let place = |x: f32| (swinging(), Transform::from_xyz(x, 0.0, 0.0), Mesh3d(handle.clone()));
    let statue = app.world_mut().spawn(Mesh3d(handle.clone())).id();
    let cloths = [-2.0, 2.0].map(|x| app.world_mut().spawn(place(x)).id());
    start(&mut app);
    frame(&mut app, 1.0);
    for cloth in cloths {
        assert!(farthest(&world_vertices(&app, cloth), &particles(&app, cloth)) < 0.1);
        assert_eq!(coordinates(&app, cloth)[80], [80.0, -1.0]);
    }
    assert!(vertices(&app, statue).iter().all(|vertex| *vertex == Vec3::splat(9.0)));
}

#[test]
fn a_cloth_that_is_changed_keeps_its_mesh_while_its_grid_stays() {
    let mut app = app();
    let cloth = app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(6, 4)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let first = app.world().get::<Mesh3d>(cloth).cloned();
    app.world_mut().get_mut::<Cloth>(cloth).expect("spawned").size = Vec2::splat(3.0);
    frame(&mut app, 1.0);
    assert_eq!(app.world().get::<Mesh3d>(cloth).cloned(), first);
    assert!((vertices(&app, cloth)[0] - Vec3::new(-1.5, 1.5, 0.0)).length() < 1e-5);
    app.world_mut().get_mut::<Cloth>(cloth).expect("spawned").particles = UVec2::new(4, 6);
    frame(&mut app, 1.0);
    assert_eq!(coordinates(&app, cloth)[3], [1.0, 0.0], "the last of the first row of four");
}

#[test]
fn a_mesh_that_was_swapped_is_written_and_one_that_was_removed_stays_away() {
    let mut app = app();
    let cloth = app.world_mut().spawn(swinging()).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let complete = own_mesh(81).with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0_f32; 3]; 81]);
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(complete);
    app.world_mut().entity_mut(cloth).insert(Mesh3d(handle.clone()));
    frame(&mut app, 1.0);
    assert_eq!(app.world().get::<Mesh3d>(cloth), Some(&Mesh3d(handle)));
    assert!(farthest(&vertices(&app, cloth), &particles(&app, cloth)) < 0.1);
    app.world_mut().entity_mut(cloth).remove::<Mesh3d>();
    frame(&mut app, 1.0);
    frame(&mut app, 1.0);
    assert_eq!(app.world().get::<Mesh3d>(cloth), None);
}

#[test]
fn without_meshes_in_the_app_cloth_is_simulated_all_the_same() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()));
    let cloth = app.world_mut().spawn(swinging()).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let first = particles(&app, cloth);
    for _ in 0..10 {
        frame(&mut app, 1.0);
    }
    assert!(farthest(&first, &particles(&app, cloth)) > 0.01);
    assert!(!app.world().entity(cloth).contains::<Mesh3d>());
}
