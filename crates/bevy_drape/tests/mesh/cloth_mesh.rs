//! Cloths made of meshes that were there before: what of them stays, and what moves.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, MeshVertexAttribute, PrimitiveTopology, VertexAttributeValues, VertexFormat};
use bevy::prelude::*;
use bevy_drape::body::Sticks;
use bevy_drape::clock::DrapeClock;
use bevy_drape::drape_solver::state::measure;
use bevy_drape::drape_solver::{StateHasher, StickKind};
use bevy_drape::render::{ClothWeave, PaintChannel, WeldedVertices};
use bevy_drape::tear::CutCloth;

use crate::*;

/// Number of places around the pipe.
pub const SIDES: u32 = 12;

/// A pipe of 0.5 m radius and 1 m height about Y, whose texture has a seam. The upper rim is red.
pub fn pipe() -> Mesh {
    let mut mesh: Mesh = Cylinder::new(0.5, 1.0).mesh().resolution(SIDES).segments(6).without_caps().build();
    let rim: Vec<_> =
        positions(&mesh).iter().map(|place| [f32::from(place[1] > 0.49), 0.0, 1.0, 1.0]).collect();
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, rim);
    mesh
}

fn positions(mesh: &Mesh) -> &[[f32; 3]] {
    mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(VertexAttributeValues::as_float3).expect("positions")
}

pub fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

/// An app with a cloth of `mesh` at `transform`, after a step.
pub fn hung(mesh: Mesh, cloth: impl Bundle, transform: Transform) -> (App, Entity) {
    let (app, entity, _) = hung_of_asset(mesh, cloth, transform);
    (app, entity)
}

/// The same, and the asset that it was made of.
fn hung_of_asset(mesh: Mesh, cloth: impl Bundle, transform: Transform) -> (App, Entity, Handle<Mesh>) {
    let mut app = app();
    let handle = add(&mut app, mesh);
    let entity = app.world_mut().spawn((Mesh3d(handle.clone()), cloth, transform)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    (app, entity, handle)
}

pub fn refusals(app: &App, entity: Entity) -> Vec<String> {
    app.world().resource::<Refusals>().of(entity).map(ToString::to_string).collect()
}

fn welded(app: &App, entity: Entity) -> &WeldedVertices {
    app.world().get(entity).expect("built")
}

/// Red pins used to make the collar red.
#[test]
fn colours_that_are_read_as_paint_do_not_tint_the_cloth_unless_asked_to() {
    let colours = |paint: ClothPaint| {
        let (app, cloth) = hung(pipe(), ClothMesh { paint, ..default() }, Transform::default());
        mesh_of(&app, cloth).attribute(Mesh::ATTRIBUTE_COLOR).cloned()
    };
    let painted = pipe().attribute(Mesh::ATTRIBUTE_COLOR).cloned();
    assert!(painted.is_some());
    assert_eq!(colours(ClothPaint::default()), None);
    let limits = ClothPaint { pins: None, max_distance: Some(PaintChannel::Blue), ..default() };
    assert_eq!(colours(limits), None);
    assert_eq!(colours(ClothPaint { is_seen: true, ..default() }), painted);
    assert_eq!(colours(ClothPaint { pins: None, ..default() }), painted, "colours of another purpose");
}

#[test]
fn a_mesh_becomes_a_cloth_that_stays_closed_and_keeps_its_texture() {
    let mesh = pipe();
    let (mut app, cloth) = hung(mesh.clone(), ClothMesh::default(), Transform::from_xyz(3.0, 2.0, 1.0));
    app.insert_resource(Wind { velocity: Vec3::new(6.0, 0.0, 2.0), ..default() });
    (0..60).for_each(|_| frame(&mut app, 1.0));
    let shown = mesh_of(&app, cloth);
    assert_eq!(shown.indices(), mesh.indices());
    assert_eq!(shown.attribute(Mesh::ATTRIBUTE_UV_0), mesh.attribute(Mesh::ATTRIBUTE_UV_0));
    let count = particles(&app, cloth).len();
    assert_eq!(count, (SIDES * 7) as usize);
    assert!(count < positions(&mesh).len(), "the seam has its vertices twice");
    let (shown, normals, places) = (vertices(&app, cloth), normals_of(&app, cloth), positions(&mesh));
    let mut together = 0;
    for i in 0..places.len() {
        for j in 0..i {
            if Vec3::from(places[i]).distance(places[j].into()) < 1e-5 {
                assert_eq!((shown[i], normals[i]), (shown[j], normals[j]), "vertices {i} and {j}");
                together += 1;
            }
        }
    }
    assert_eq!(together, 7);
    let moved = places.iter().zip(&shown).map(|(&place, now)| now.distance(place.into())).fold(0.0, f32::max);
    assert!(moved > 0.01, "it hangs as it was made: {moved} m");
}

#[test]
fn painted_vertices_are_pinned_and_follow_their_entity() {
    let (mut app, cloth) = hung(pipe(), ClothMesh::default(), Transform::default());
    let rim: Vec<Vec3> = vertices(&app, cloth).into_iter().filter(|vertex| vertex.y > 0.49).collect();
    assert_eq!(rim.len(), SIDES as usize + 1);
    app.world_mut().get_mut::<Transform>(cloth).expect("placed").translation.x = 0.2;
    // The second one only shows what the first has done.
    (0..2).for_each(|_| frame(&mut app, 1.0));
    let now: Vec<Vec3> = vertices(&app, cloth).into_iter().filter(|vertex| vertex.y > 0.49).collect();
    assert!(farthest(&now, &rim) < 1e-5, "they are where they were in the entity");
    let pinned = |cloth: ClothMesh| {
        let (app, entity) = hung(pipe(), cloth, Transform::default());
        let particles = app.world().get::<Particles>(entity).expect("built");
        (0..particles.len()).filter(|&i| particles.is_pinned(i)).count()
    };
    let paint =
        |pins, threshold| ClothMesh { paint: ClothPaint { pins, threshold, ..default() }, ..default() };
    let (all, rim) = ((SIDES * 7) as usize, SIDES as usize);
    assert_eq!(pinned(paint(Some(PaintChannel::Red), 0.5)), rim);
    assert_eq!(pinned(paint(Some(PaintChannel::Red), 1.0)), 0);
    assert_eq!(pinned(paint(Some(PaintChannel::Green), 0.5)), 0);
    assert_eq!(pinned(paint(Some(PaintChannel::Blue), 0.5)), all);
    assert_eq!(pinned(paint(None, 0.5)), 0);
    assert_eq!(pinned(paint(None, 0.5).with_pins([0, 1])), 2);
}

/// Stiffness of the sticks of `kind`, each once, in ascending order.
fn stiffness(app: &App, cloth: Entity, kind: StickKind) -> Vec<f32> {
    let sticks = app.world().get::<Sticks>(cloth).expect("built");
    let of_kind = sticks.batches().iter().filter(|batch| batch.material.kind == kind);
    let mut found: Vec<f32> = of_kind.map(|batch| batch.material.stiffness).collect();
    found.sort_unstable_by(f32::total_cmp);
    found.dedup();
    found
}

#[test]
fn a_painted_mesh_is_soft_where_it_is_dark() {
    let painted = |channel| {
        let paint = ClothPaint { stiffness: Some(channel), ..default() };
        let cloth = (ClothMesh { paint, ..default() }, Fabric { bend_stiffness: 0.5, ..default() });
        let (app, entity) = hung(pipe(), cloth, Transform::default());
        [StickKind::Structural, StickKind::Bend].map(|kind| stiffness(&app, entity, kind))
    };
    assert_eq!(painted(PaintChannel::Blue), [[1.0], [0.5]], "white");
    assert_eq!(painted(PaintChannel::Green), [[0.5], [1.0 / 3.0]], "black");
    // Red at the rim alone: edges there, those that lead there, and all others.
    let [edges, bends] = painted(PaintChannel::Red);
    assert_eq!((edges.len(), edges[0], edges[2]), (3, 0.5, 1.0), "{edges:?}");
    assert!(bends.len() >= 2, "{bends:?}");
}

/// U runs around the pipe and V along it.
#[test]
fn a_woven_mesh_is_stiff_by_the_direction_of_its_texture() {
    let weave = Some(ClothWeave { weft_stiffness: 0.99, bias_stiffness: 0.9 });
    let cloth = (ClothMesh { weave, ..default() }, Fabric { stretch_stiffness: 0.999, ..default() });
    let (app, entity) = hung(pipe(), cloth.clone(), Transform::default());
    let edges = stiffness(&app, entity, StickKind::Structural);
    let has = |wanted: f32| edges.iter().any(|found| (found - wanted).abs() < 1e-5);
    assert!(has(0.999) && has(0.99) && edges[0] < 0.95, "{edges:?}");
    let mut bare = pipe();
    bare.remove_attribute(Mesh::ATTRIBUTE_UV_0);
    let (app, entity) = hung(bare, cloth, Transform::default());
    assert!(refusals(&app, entity)[0].contains("Vertex_Uv"), "{:?}", refusals(&app, entity));
}

const HELD: MeshVertexAttribute = MeshVertexAttribute::new("Held", 77_001, VertexFormat::Float32);

#[test]
fn an_attribute_of_ones_own_pins_too() {
    let cloth = |name: &str| ClothMesh {
        paint: ClothPaint { pins: Some(PaintChannel::Attribute(name.into())), ..default() },
        ..default()
    };
    let mut mesh = pipe();
    let low: Vec<f32> = positions(&mesh).iter().map(|place| f32::from(place[1] < -0.49)).collect();
    mesh.insert_attribute(HELD, low);
    let (app, entity) = hung(mesh.clone(), cloth("Held"), Transform::default());
    let welded = welded(&app, entity);
    let body = app.world().get::<Particles>(entity).expect("built");
    for (vertex, place) in positions(&mesh).iter().enumerate() {
        let particle = welded.particle(vertex).expect("part of it");
        assert_eq!(body.is_pinned(particle), place[1] < -0.49);
    }
    let (app, entity) = hung(mesh, cloth("Hold"), Transform::default());
    assert!(refusals(&app, entity)[0].contains("no attribute “Hold”"), "{:?}", refusals(&app, entity));
}

/// Every face of a box has corners of its own, so that its edges are sharp.
#[test]
fn sharp_edges_stay_sharp_and_smooth_ones_smooth() {
    for (mesh, particles) in
        [(Cuboid::default().mesh().build(), 8), (Sphere::new(0.5).mesh().uv(16, 9), 8 * 16 + 2)]
    {
        let expected = mesh.attribute(Mesh::ATTRIBUTE_NORMAL).and_then(VertexAttributeValues::as_float3);
        let expected: Vec<Vec3> = expected.expect("normals").iter().map(|&n| n.into()).collect();
        let mut app = app();
        app.insert_resource(DrapeGravity(Vec3::ZERO));
        let handle = add(&mut app, mesh);
        let mirrored = Transform::from_xyz(0.0, 5.0, 0.0).with_scale(Vec3::new(-2.0, 2.0, 2.0));
        let cloth = app.world_mut().spawn((Mesh3d(handle), ClothMesh::default(), mirrored)).id();
        start(&mut app);
        frame(&mut app, 1.0);
        assert_eq!(crate::particles(&app, cloth).len(), particles);
        let used = welded(&app, cloth);
        for (vertex, (now, expected)) in normals_of(&app, cloth).into_iter().zip(expected).enumerate() {
            if used.particle(vertex).is_some() {
                // The triangles of a coarse ball lean away from it a little.
                assert!(now.dot(expected) > 0.97, "vertex {vertex}: {now}, not {expected}");
            }
        }
    }
}

#[test]
fn it_is_where_the_entity_is_as_large_as_that_makes_it() {
    let mesh = pipe();
    let parent = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_z(0.4));
    let scale = Vec3::new(2.0, 0.5, 1.5);
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let handle = add(&mut app, mesh.clone());
    let cloth = (
        Mesh3d(handle),
        ClothMesh { paint: ClothPaint { pins: None, ..default() }, ..default() },
        Fabric { areal_density: 0.5, ..default() },
    );
    let parent = app.world_mut().spawn(parent).id();
    let cloth = app.world_mut().spawn((cloth, Transform::from_scale(scale), ChildOf(parent))).id();
    start(&mut app);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    let rest: Vec<Vec3> = positions(&mesh).iter().map(|&place| place.into()).collect();
    assert!(farthest(&vertices(&app, cloth), &rest) < 1e-5, "nothing pulls at it");
    let place = app.world().get::<GlobalTransform>(cloth).expect("placed");
    let used = welded(&app, cloth);
    for (vertex, &rest) in rest.iter().enumerate() {
        let particle = particles(&app, cloth)[used.particle(vertex).expect("part of it")];
        assert!(particle.distance(place.transform_point(rest)) < 1e-5);
    }
    let triangles = mesh.triangles().expect("triangles");
    let area = |triangle: Triangle3d| Triangle3d { vertices: triangle.vertices.map(|v| v * scale) }.area();
    let area: f32 = triangles.map(area).sum();
    let mass = measure::mass(app.world().get::<Particles>(cloth).expect("built"));
    assert!((mass - f64::from(0.5 * area)).abs() < 1e-5, "{mass} kg of {area} m^2");
}

#[test]
fn a_mesh_that_loads_late_is_waited_for() {
    let mut app = app();
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let cloth = app.world_mut().spawn((Mesh3d(handle.clone()), ClothMesh::default())).id();
    start(&mut app);
    (0..5).for_each(|_| frame(&mut app, 1.0));
    assert!(app.world().get::<Particles>(cloth).is_none());
    assert!(refusals(&app, cloth).is_empty(), "to wait is no fault");
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, pipe()).expect("reserved");
    frame(&mut app, 1.0);
    assert_eq!(particles(&app, cloth).len(), (SIDES * 7) as usize);
}

#[test]
fn cloths_that_share_a_mesh_leave_it_alone() {
    let mut app = app();
    let mesh = pipe();
    let handle = add(&mut app, mesh.clone());
    let cloths = [0.0, 3.0].map(|x| {
        app.world_mut()
            .spawn((Mesh3d(handle.clone()), ClothMesh::default(), Transform::from_xyz(x, 0.0, 0.0)))
            .id()
    });
    start(&mut app);
    (0..30).for_each(|_| frame(&mut app, 1.0));
    let ids = cloths.map(|cloth| app.world().get::<Mesh3d>(cloth).expect("shown").id());
    assert!(ids[0] != ids[1] && !ids.contains(&handle.id()));
    let source = app.world().resource::<Assets<Mesh>>().get(&handle).expect("kept");
    assert_eq!(positions(source), positions(&mesh));
}

fn mass(app: &App, cloth: Entity) -> f64 {
    measure::mass(app.world().get::<Particles>(cloth).expect("built"))
}

#[test]
fn what_is_changed_is_built_anew_from_the_mesh_as_it_was_made() {
    let (mut app, cloth, handle) = hung_of_asset(pipe(), ClothMesh::default(), Transform::default());
    (0..30).for_each(|_| frame(&mut app, 1.0));
    let before = mass(&app, cloth);
    app.world_mut().get_mut::<Fabric>(cloth).expect("described").areal_density *= 2.0;
    frame(&mut app, 1.0);
    assert!(
        (mass(&app, cloth) - 2.0 * before).abs() < 1e-9 * before.max(1.0),
        "of the mesh and not of its drape"
    );
    // The asset is saved anew.
    let scaled = pipe().scaled_by(Vec3::splat(2.0));
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, scaled).expect("there");
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert!((mass(&app, cloth) / before - 8.0).abs() < 1e-3);
    // Another mesh altogether.
    let ball = add(&mut app, Sphere::new(0.5).mesh().ico(2).expect("few"));
    app.world_mut().entity_mut(cloth).insert(Mesh3d(ball.clone()));
    frame(&mut app, 1.0);
    assert_eq!(particles(&app, cloth).len(), 92);
    assert_ne!(app.world().get::<Mesh3d>(cloth).expect("shown").id(), ball.id());
    // And no cloth any more.
    app.world_mut().entity_mut(cloth).remove::<ClothMesh>();
    let shown = vertices(&app, cloth);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    assert!(app.world().get::<Particles>(cloth).is_none());
    assert_eq!(vertices(&app, cloth), shown, "it stays as it was last");
}

/// Bevy had forgotten the message by the time of the next step, and the cloth stayed as it was.
#[test]
fn a_mesh_that_is_saved_anew_in_a_pause_is_taken_up_after_it() {
    let (mut app, cloth, handle) = hung_of_asset(pipe(), ClothMesh::default(), Transform::default());
    let before = mass(&app, cloth);
    app.world_mut().resource_mut::<DrapeClock>().paused = true;
    let scaled = pipe().scaled_by(Vec3::splat(2.0));
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, scaled).expect("there");
    (0..5).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(mass(&app, cloth), before);
    app.world_mut().resource_mut::<DrapeClock>().paused = false;
    frame(&mut app, 1.0);
    assert!((mass(&app, cloth) / before - 4.0).abs() < 1e-3, "of four times the area");
}

#[test]
fn the_drape_is_the_same_whichever_way_vertices_are_split() {
    let end = |mesh: Mesh| {
        let (mut app, cloth) = hung(mesh, ClothMesh::default(), Transform::default());
        (0..60).for_each(|_| frame(&mut app, 1.0));
        StateHasher::new().particles(app.world().get::<Particles>(cloth).expect("built")).finish()
    };
    assert_eq!(end(pipe().with_duplicated_vertices()), end(pipe()));
}

pub fn of(topology: PrimitiveTopology, places: Vec<[f32; 3]>) -> Mesh {
    Mesh::new(topology, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
}

pub const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

pub fn of_triangles(places: &[[f32; 3]], indices: &[u16]) -> Mesh {
    of(PrimitiveTopology::TriangleList, places.to_vec()).with_inserted_indices(Indices::U16(indices.to_vec()))
}

#[test]
fn a_strip_of_triangles_is_a_cloth_that_faces_one_way() {
    let (app, cloth) =
        hung(of(PrimitiveTopology::TriangleStrip, SQUARE.to_vec()), ClothMesh::default(), default());
    let sticks = app.world().get::<Sticks>(cloth).expect("built");
    assert_eq!(sticks.faces().len(), 2);
    assert!(welded(&app, cloth).repairs().is_empty());
    assert!(normals_of(&app, cloth).iter().all(|normal| normal.z > 0.99));
}

/// The area of a mesh in its texture, and the area that is turned over there.
fn textured(mesh: &Mesh) -> Vec2 {
    let Some(VertexAttributeValues::Float32x2(places)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else {
        panic!("no texture coordinates");
    };
    let indices: Vec<usize> = mesh.indices().expect("indexed").iter().collect();
    let faces = indices.as_chunks().0.iter();
    let areas = faces.map(|face: &[usize; 3]| {
        let [a, b, c] = face.map(|i| Vec2::from(places[i]));
        0.5 * (b - a).perp_dot(c - a)
    });
    areas.map(|area| Vec2::new(area.max(0.0), -area.min(0.0))).sum()
}

/// Cut across, and the lower part, which has come off, slit and cut again: as it is, smaller and turned, and mirrored.
#[test]
fn what_is_cut_keeps_its_area_and_its_texture() {
    cut_and_slit(Transform::default());
    let small = Transform::from_xyz(0.3, 1.0, -0.2).with_scale(Vec3::splat(0.5));
    cut_and_slit(small.with_rotation(Quat::from_rotation_y(1.0)));
    cut_and_slit(Transform::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
}

fn cut_and_slit(transform: Transform) {
    let (mut app, _) = hung(pipe(), ClothMesh::default(), transform);
    let expected = textured(&pipe());
    let across = |y: f32| [-1.0, 1.0].map(|x| [-1.0, 1.0].map(|z| Vec3::new(x, y, z)));
    let slit = [
        [Vec3::new(0.3, -0.6, 0.1), Vec3::new(0.3, -0.2, 0.1)],
        [Vec3::new(0.7, -0.6, 0.1), Vec3::new(0.7, -0.2, 0.1)],
    ];
    for (blade, bodies) in [(across(0.05), 2), (slit, 2), (across(-0.25), 3)] {
        let [from, to] = blade.map(|edge| edge.map(|place| transform.transform_point(place)));
        app.world_mut().write_message(CutCloth::sweep(from, to));
        (0..3).for_each(|_| frame(&mut app, 1.0));
        let mut query = app.world_mut().query_filtered::<Entity, With<Particles>>();
        let parts: Vec<Entity> = query.iter(app.world()).collect();
        assert_eq!(parts.len(), bodies);
        let mut all = Vec2::ZERO;
        for &part in &parts {
            all += textured(mesh_of(&app, part));
            let (shown, places) = (world_vertices(&app, part), particles(&app, part));
            let welded = welded(&app, part);
            assert_eq!(shown.len(), welded.vertex_count());
            for (vertex, shown) in shown.into_iter().enumerate() {
                let distance = |place: &Vec3| place.distance(shown);
                match welded.particle(vertex) {
                    Some(particle) => assert!(distance(&places[particle]) < 0.1, "shown between two steps"),
                    None => assert!(places.iter().any(|place| distance(place) < 0.2), "on the edge of a cut"),
                }
            }
            let normals = normals_of(&app, part);
            assert!(normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
        }
        assert!((all - expected).abs().max_element() < 1e-5, "{all} of the texture, of {expected}");
    }
}
