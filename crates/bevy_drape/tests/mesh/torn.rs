//! The meshes of torn cloth.

use super::*;
use bevy_drape::body::Sticks;
use bevy_drape::tear::CutCloth;

fn texture_coordinates(app: &App, entity: Entity) -> Vec<[f32; 2]> {
    match mesh_of(app, entity).attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
        other => panic!("no texture coordinates: {other:?}"),
    }
}

/// Both sides of a cut have the vertices, texture coordinates, faces and normals of their own particles.
#[test]
fn both_pieces_of_a_cut_cloth_are_shown_as_they_were() {
    let mut app = app();
    let cloth = Cloth::new(1.0, 1.0).with_particles(9, 9);
    let curtain = app.world_mut().spawn(cloth).id();
    start(&mut app);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    let whole = mesh_of(&app, curtain).clone();
    let edge = |x: f32| [Vec3::new(x, 0.05, -1.0), Vec3::new(x, 0.05, 1.0)];
    app.world_mut().write_message(CutCloth::sweep(edge(-1.0), edge(1.0)));
    frame(&mut app, 1.0);
    let mut bodies = app.world_mut().query_filtered::<Entity, With<Particles>>();
    let bodies: Vec<Entity> = bodies.iter(app.world()).collect();
    assert_eq!(bodies.len(), 2);
    let mut faces = 0;
    for &entity in &bodies {
        let shown = world_vertices(&app, entity);
        // The step before is shown, when hardly anything had moved.
        assert!(farthest(&shown, &particles(&app, entity)) < 5e-3);
        let rest = texture_coordinates(&app, entity);
        // Hardly moved yet: a vertex still lies where its texture coordinates say.
        for ([u, v], place) in rest.into_iter().zip(shown) {
            let expected = Vec3::new(u - 0.5, 0.5 - v, 0.0);
            assert!(place.distance(expected) < 0.05, "{place} has ({u}, {v})");
        }
        assert!(normals_of(&app, entity).iter().all(|normal| normal.distance(Vec3::Z) < 0.1));
        let indices: Vec<usize> = mesh_of(&app, entity).indices().expect("indexed").iter().collect();
        let own = app.world().get::<Sticks>(entity).expect("joined").faces().as_flattened();
        assert!(indices.iter().zip(own).all(|(&index, &corner)| index == corner as usize));
        faces += indices.len() / 3;
    }
    assert_eq!(faces, whole.indices().expect("indexed").len() / 3, "no face is lost");
    let [first, second] = [0, 1].map(|i| app.world().get::<Mesh3d>(bodies[i]).expect("a mesh").id());
    assert_ne!(first, second, "each has a mesh of its own");
    // They are kept up from now on.
    (0..10).for_each(|_| frame(&mut app, 1.0));
    let before: Vec<Vec<Vec3>> = bodies.iter().map(|&entity| particles(&app, entity)).collect();
    frame(&mut app, 1.0);
    for (&entity, before) in bodies.iter().zip(&before) {
        assert!(farthest(&world_vertices(&app, entity), before) < 1e-5);
    }
}

/// The piece wears the material of the cloth that it came off.
#[test]
fn a_piece_has_what_its_cloth_had() {
    #[derive(Component, Clone, PartialEq, Debug)]
    struct Material(&'static str);
    let mut app = app();
    let parent = app.world_mut().spawn(Transform::from_xyz(0.0, 1.0, 0.0)).id();
    let cloth = Cloth::new(1.0, 1.0).with_particles(9, 9);
    app.world_mut().spawn((cloth, Material("silk"), ChildOf(parent)));
    start(&mut app);
    frame(&mut app, 1.0);
    let edge = |x: f32| [Vec3::new(x, 1.05, -1.0), Vec3::new(x, 1.05, 1.0)];
    app.world_mut().write_message(CutCloth::sweep(edge(-1.0), edge(1.0)));
    frame(&mut app, 1.0);
    let mut bodies = app.world_mut().query_filtered::<(Entity, &Material, &ChildOf), With<Particles>>();
    let bodies: Vec<(Entity, Material, Entity)> = bodies
        .iter(app.world())
        .map(|(entity, material, of)| (entity, material.clone(), of.parent()))
        .collect();
    assert_eq!(bodies.len(), 2);
    for (entity, material, of) in bodies {
        assert_eq!((material, of), (Material("silk"), parent));
        assert!(farthest(&world_vertices(&app, entity), &particles(&app, entity)) < 5e-3);
    }
}
