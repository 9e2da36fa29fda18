//! The meshes of torn cloth.

use super::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy_drape::snapshot::{Snapshot, members};
use bevy_drape::tear::CutCloth;

fn texture_coordinates(app: &App, entity: Entity) -> Vec<[f32; 2]> {
    match mesh_of(app, entity).attribute(Mesh::ATTRIBUTE_UV_0) {
        Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
        other => panic!("no texture coordinates: {other:?}"),
    }
}

/// Both sides of a cut have the vertices, texture coordinates and normals of their own particles, and end on the stroke.
#[test]
fn both_pieces_of_a_cut_cloth_are_shown_as_they_were() {
    let mut app = app();
    let cloth = Cloth::new(1.0, 1.0).with_particles(9, 9);
    let curtain = app.world_mut().spawn(cloth).id();
    start(&mut app);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    // The row of the stroke in the texture, between the rows of particles above and below it.
    let column: Vec<f32> = particles(&app, curtain).iter().step_by(9).map(|place| place.y).collect();
    let below = column.iter().position(|&y| y < 0.05).expect("the stroke is above the hem");
    let part = (column[below - 1] - 0.05) / (column[below - 1] - column[below]);
    let level = (below as f32 - 1.0 + part) / 8.0;
    let edge = |x: f32| [Vec3::new(x, 0.05, -1.0), Vec3::new(x, 0.05, 1.0)];
    app.world_mut().write_message(CutCloth::sweep(edge(-1.0), edge(1.0)));
    frame(&mut app, 1.0);
    let mut bodies = app.world_mut().query_filtered::<Entity, With<Particles>>();
    let bodies: Vec<Entity> = bodies.iter(app.world()).collect();
    assert_eq!(bodies.len(), 2);
    let mut area = 0.0;
    for &entity in &bodies {
        let shown = world_vertices(&app, entity);
        // The step before is shown, when hardly anything had moved.
        let own = particles(&app, entity);
        assert!(shown.len() > own.len(), "some lie on the stroke");
        assert!(farthest(&shown[..own.len()], &own) < 5e-3);
        let rest = texture_coordinates(&app, entity);
        // Hardly moved yet: a vertex still lies where its texture coordinates say.
        for ([u, v], place) in rest.into_iter().zip(shown) {
            let expected = Vec3::new(u - 0.5, 0.5 - v, 0.0);
            assert!(place.distance(expected) < 0.05, "{place} has ({u}, {v})");
        }
        assert!(normals_of(&app, entity).iter().all(|normal| normal.distance(Vec3::Z) < 0.1));
        let indices: Vec<usize> = mesh_of(&app, entity).indices().expect("indexed").iter().collect();
        let rest: Vec<Vec2> = texture_coordinates(&app, entity).into_iter().map(Vec2::from).collect();
        for face in indices.as_chunks().0 {
            let corners: [Vec2; 3] = face.map(|i: usize| rest[i]);
            let [a, b, c] = corners;
            area += 0.5 * (b - a).perp_dot(c - a).abs();
            let beside = |sign: f32| corners.iter().map(|at| sign * (at.y - level)).fold(0.0, f32::max);
            assert!(beside(1.0).min(beside(-1.0)) < 1e-3, "{corners:?} goes across the stroke at {level}");
        }
    }
    assert!((area - 1.0).abs() < 1e-4, "{area} of the texture is left");
    let [first, second] = [0, 1].map(|i| app.world().get::<Mesh3d>(bodies[i]).expect("a mesh").id());
    assert_ne!(first, second, "each has a mesh of its own");
    // They are kept up from now on.
    (0..10).for_each(|_| frame(&mut app, 1.0));
    let before: Vec<Vec<Vec3>> = bodies.iter().map(|&entity| particles(&app, entity)).collect();
    frame(&mut app, 1.0);
    for (&entity, before) in bodies.iter().zip(&before) {
        assert!(farthest(&world_vertices(&app, entity)[..before.len()], before) < 1e-5);
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
        let own = particles(&app, entity);
        assert!(farthest(&world_vertices(&app, entity)[..own.len()], &own) < 5e-3);
    }
}

/// A piece that has lost a row and got it back as virtual particles has as many particles and faces as the whole, in another order.
#[test]
fn a_piece_of_the_size_of_the_whole_has_its_own_normals() {
    for is_level in [true, false] {
        let mut app = app();
        app.world_mut().spawn(Cloth::new(1.0, 1.0).with_particles(9, 9));
        start(&mut app);
        frame(&mut app, 1.0);
        let edge = |along: f32| {
            let place = if is_level { Vec3::new(along, 0.44, 0.0) } else { Vec3::new(-0.44, along, 0.0) };
            [place - Vec3::Z, place + Vec3::Z]
        };
        app.world_mut().write_message(CutCloth::sweep(edge(-1.0), edge(1.0)));
        frame(&mut app, 1.0);
        let mut bodies = app.world_mut().query_filtered::<Entity, With<Particles>>();
        let bodies: Vec<Entity> = bodies.iter(app.world()).collect();
        assert_eq!(bodies.len(), 2);
        for entity in bodies {
            assert!(normals_of(&app, entity).iter().all(|normal| normal.distance(Vec3::Z) < 0.1));
        }
    }
}

/// The mesh of a body as it is shown: positions, texture coordinates and triangles.
fn shown(app: &App, entity: Entity) -> (Vec<Vec3>, Vec<[f32; 2]>, Vec<usize>) {
    let indices = mesh_of(app, entity).indices().expect("indexed").iter().collect();
    (world_vertices(app, entity), texture_coordinates(app, entity), indices)
}

/// A curtain of 1 m x 1 m that hangs in a frame, as a grid or as a mesh, and a ball that tears it; all of its pieces stay.
fn curtain_and_ball(is_mesh: bool) -> App {
    let mut app = app();
    let tearable = Tearable { strain: 0.1, least_particles: 0, ..default() };
    let frame: Vec<u32> =
        (0..441).filter(|i| [i % 21, i / 21].iter().any(|&at| at == 0 || at == 20)).collect();
    if is_mesh {
        let plane = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(19).build();
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(plane);
        let cloth = ClothMesh { pins: frame, ..default() };
        app.world_mut().spawn((cloth, Mesh3d(mesh), tearable));
    } else {
        let cloth = Cloth::new(1.0, 1.0).with_particles(21, 21).with_pins(ClothPins::Indices(frame));
        app.world_mut().spawn((cloth, tearable));
    }
    let ball = Projectile { radius: 0.15, mass: 8.0, velocity: Vec3::NEG_Z * 15.0, ..default() };
    app.world_mut().spawn((ball, Transform::from_xyz(0.1, 0.07, 0.4)));
    start(&mut app);
    app
}

/// Torn cloth is drawn with frayed edges: with more vertices than particles, all of its texture, and inside its bounds.
#[test]
fn torn_cloth_is_drawn_with_frayed_edges_and_all_of_its_texture() {
    for is_mesh in [false, true] {
        let mut app = curtain_and_ball(is_mesh);
        frame(&mut app, 1.0);
        let mut frayed = 0;
        for step in 0..30 {
            frame(&mut app, 0.7);
            let (mut bodies, mut area) = (app.world_mut().query_filtered::<Entity, With<Particles>>(), 0.0);
            let bodies: Vec<Entity> = bodies.iter(app.world()).collect();
            frayed = 0;
            for entity in bodies {
                let (places, texture, indices) = shown(&app, entity);
                frayed += places.len() - particles(&app, entity).len();
                let bounds = app.world().get::<bevy::camera::primitives::Aabb>(entity).expect("bounds");
                for &place in &places {
                    let off = (Vec3::from(bounds.center) - place).abs() - Vec3::from(bounds.half_extents);
                    assert!(off.max_element() < 1e-6, "{place} is outside by {off} in step {step}");
                }
                for corners in indices.as_chunks().0 {
                    let [a, b, c] = corners.map(|i: usize| Vec2::from(texture[i]));
                    // The texture runs downwards.
                    let own = -0.5 * (b - a).perp_dot(c - a);
                    assert!(own > 0.0, "a triangle of {own} of the texture in step {step}");
                    area += own;
                }
            }
            assert!((area - 1.0).abs() < 1e-4, "{area} of the texture is drawn in step {step}");
        }
        assert!(frayed > 60, "{frayed}");
    }
}

/// Snapshots bring frayed edges back bit for bit, in this world and in another.
#[test]
fn frayed_edges_go_back() {
    for is_mesh in [false, true] {
        let mut app = curtain_and_ball(is_mesh);
        (0..25).for_each(|_| frame(&mut app, 1.0));
        let all = |app: &mut App| {
            let bodies: Vec<Entity> =
                members(app.world_mut()).into_iter().map(|(_, entity)| entity).collect();
            let bodies = bodies.into_iter().filter(|&entity| app.world().get::<Particles>(entity).is_some());
            bodies.map(|entity| shown(app, entity)).collect::<Vec<_>>()
        };
        let torn = Snapshot::take(app.world_mut());
        frame(&mut app, 1.0);
        let then = all(&mut app);
        assert!(then.len() > 1, "a piece came off");
        let mut other = curtain_and_ball(is_mesh);
        for app in [&mut app, &mut other] {
            (0..3).for_each(|_| frame(app, 1.0));
            torn.restore(app.world_mut()).expect("the same scene");
            frame(app, 1.0);
            assert!(all(app) == then, "drawn otherwise");
        }
    }
}

/// A snapshot from before a cut brings the whole mesh back, one from after it those of both pieces, in this world and in another one
/// in which nothing was cut. Grids and meshes, which have their own vertices, do so alike.
#[test]
fn meshes_go_back_across_cuts() {
    for is_mesh in [false, true] {
        let world = || {
            let mut app = app();
            let place = Transform::from_xyz(0.0, 0.1, 0.0);
            if is_mesh {
                let plane = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(7).build();
                let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(plane);
                app.world_mut().spawn((ClothMesh::default(), Mesh3d(mesh), place));
            } else {
                app.world_mut().spawn((Cloth::new(1.0, 1.0).with_particles(9, 9), place));
            }
            start(&mut app);
            frame(&mut app, 1.0);
            app
        };
        let all = |app: &mut App| {
            let bodies: Vec<Entity> =
                members(app.world_mut()).into_iter().map(|(_, entity)| entity).collect();
            bodies.into_iter().map(|entity| shown(app, entity)).collect::<Vec<_>>()
        };
        let mut app = world();
        let whole = Snapshot::take(app.world_mut());
        frame(&mut app, 1.0);
        let whole_then = all(&mut app);
        for level in [0.15, -0.2] {
            let edge = |x: f32| [Vec3::new(x, level, -1.0), Vec3::new(x, level, 1.0)];
            app.world_mut().write_message(CutCloth::sweep(edge(-1.0), edge(1.0)));
            frame(&mut app, 1.0);
        }
        frame(&mut app, 1.0);
        let torn = Snapshot::take(app.world_mut());
        frame(&mut app, 1.0);
        let torn_then = all(&mut app);
        assert_eq!([whole_then.len(), torn_then.len()], [1, 3]);
        let mut other = world();
        for app in [&mut app, &mut other] {
            for _ in 0..2 {
                for (snapshot, then) in [(&torn, &torn_then), (&whole, &whole_then)] {
                    snapshot.restore(app.world_mut()).expect("the same scene");
                    frame(app, 1.0);
                    for (now, then) in all(app).iter().zip(then) {
                        assert_eq!((&now.1, &now.2), (&then.1, &then.2));
                        assert_eq!(farthest(&now.0, &then.0), 0.0);
                    }
                    frame(app, 1.0);
                }
            }
        }
        // A piece has its mesh also if its cloth is away.
        for app in [&mut app, &mut other] {
            whole.restore(app.world_mut()).expect("the same scene");
            frame(app, 1.0);
            let cloth = members(app.world_mut())[0].1;
            app.world_mut().entity_mut(cloth).insert(Disabled);
            torn.restore(app.world_mut()).expect("the same scene");
            frame(app, 1.0);
            for (now, then) in all(app).iter().zip(&torn_then) {
                assert_eq!((&now.1, &now.2), (&then.1, &then.2));
            }
            whole.restore(app.world_mut()).expect("the same scene");
            frame(app, 1.0);
        }
        // From here on it is cut like any other.
        let edge = |x: f32| [Vec3::new(x, 0.0, -1.0), Vec3::new(x, 0.0, 1.0)];
        app.world_mut().write_message(CutCloth::sweep(edge(-1.0), edge(1.0)));
        frame(&mut app, 1.0);
        assert_eq!(all(&mut app).len(), 2);
    }
}
