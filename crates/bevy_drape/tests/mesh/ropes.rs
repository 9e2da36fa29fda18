//! Tubes around ropes, and meshes of two dimensions.

use super::*;
use bevy_drape::tear::CutCloth;

/// A rope that swings, shown as a tube, on an entity of its own place.
fn rope(app: &mut App, particles: u32) -> Entity {
    let rope = Rope::new(Vec3::ZERO, Vec3::new(0.7, 0.0, 0.7), particles);
    app.world_mut()
        .spawn((rope, RopeMesh { radius: 0.02, sides: 6 }, Transform::from_xyz(1.0, 2.0, 0.0)))
        .id()
}

/// How far the rings of a tube are from being circles of 2 cm around their particles, in metres.
fn fault(app: &App, rope: Entity, centres: &[Vec3]) -> f32 {
    let vertices = world_vertices(app, rope);
    let rings = vertices.chunks_exact(7).take(centres.len());
    let off = |(ring, centre): (&[Vec3], &Vec3)| {
        ring.iter().map(|vertex| (vertex.distance(*centre) - 0.02).abs()).fold(0.0, f32::max)
    };
    rings.zip(centres).map(off).fold(0.0, f32::max)
}

#[test]
fn a_rope_is_shown_as_a_tube_that_goes_with_it() {
    let mut app = app();
    let rope = rope(&mut app, 12);
    start(&mut app);
    frame(&mut app, 1.0);
    let first = app.world().get::<Mesh3d>(rope).expect("a mesh").id();
    let mut side = None;
    for _ in 0..40 {
        let before = particles(&app, rope);
        frame(&mut app, 1.0);
        // The step before is shown.
        assert!(fault(&app, rope, &before) < 1e-5);
        let mesh = mesh_of(&app, rope);
        assert_eq!(mesh.count_vertices(), 14 * 7 + 2);
        // The first ring does not spin from frame to frame.
        let vertex = world_vertices(&app, rope)[0] - before[0];
        assert!(side.is_none_or(|side: Vec3| side.distance(vertex) < 0.01), "the tube spins about itself");
        side = Some(vertex);
    }
    assert_eq!(app.world().get::<Mesh3d>(rope).expect("a mesh").id(), first);
    let bounds = app.world().get::<bevy::camera::primitives::Aabb>(rope).expect("bounds");
    let place = Vec3::new(1.0, 2.0, 0.0);
    for vertex in world_vertices(&app, rope) {
        let local = (vertex - place - Vec3::from(bounds.center)).abs();
        assert!(local.cmple(Vec3::from(bounds.half_extents) + 1e-5).all());
    }
}

#[test]
fn both_ends_of_a_cut_rope_are_tubes() {
    let mut app = app();
    let whole = rope(&mut app, 12);
    start(&mut app);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    let (low, high) = (Vec3::new(1.4, 0.0, 0.0), Vec3::new(1.4, 3.0, 0.0));
    app.world_mut().write_message(CutCloth::sweep([low, high], [low + Vec3::Z, high + Vec3::Z]));
    (0..3).for_each(|_| frame(&mut app, 1.0));
    let mut bodies = app.world_mut().query_filtered::<Entity, With<Particles>>();
    let bodies: Vec<Entity> = bodies.iter(app.world()).collect();
    assert_eq!(bodies.len(), 2);
    let meshes = [0, 1].map(|i| app.world().get::<Mesh3d>(bodies[i]).expect("a mesh").id());
    assert_ne!(meshes[0], meshes[1]);
    for &entity in &bodies {
        let rings = particles(&app, entity).len();
        assert_eq!(mesh_of(&app, entity).count_vertices(), (rings + 2) * 7 + 2);
    }
    assert!(bodies.contains(&whole));
}

#[test]
fn a_cloth_with_a_mesh_of_two_dimensions_keeps_that_up() {
    let mut app = app();
    let cloth = app.world_mut().spawn((swinging(), Mesh2d::default())).id();
    start(&mut app);
    for _ in 0..10 {
        frame(&mut app, 1.0);
    }
    assert!(app.world().get::<Mesh3d>(cloth).is_none());
    let before = particles(&app, cloth);
    frame(&mut app, 1.0);
    let mesh = app.world().get::<Mesh2d>(cloth).expect("a mesh").0.clone();
    let mesh = app.world().resource::<Assets<Mesh>>().get(&mesh).expect("made");
    let Some(VertexAttributeValues::Float32x3(places)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("no positions")
    };
    for (place, particle) in places.iter().zip(before) {
        assert!(Vec3::from(*place).distance(particle) < 1e-5);
    }
}
