//! Detailed meshes that follow coarse bodies: exactly, at their distance, whatever becomes of the body.

use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::render::DrivenMesh;
use bevy_drape::sleep::SceneManager;
use bevy_drape::tear::CutCloth;

use crate::*;

fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

fn places(mesh: &Mesh) -> Vec<Vec3> {
    let values = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(VertexAttributeValues::as_float3);
    values.expect("positions").iter().map(|&place| place.into()).collect()
}

fn refusals(app: &App, entity: Entity) -> Vec<String> {
    app.world().resource::<Refusals>().of(entity).map(ToString::to_string).collect()
}

/// A sheet of 1 m x 1 m in 33 x 33 vertices, `off` metres in front of the plane of X and Y.
fn sheet(off: f32) -> Mesh {
    let plane = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(31).build();
    plane.translated_by(Vec3::Z * off)
}

/// The bodies that drive, of which each fits into a cube of a metre, and a detailed mesh for each.
fn drivers(app: &mut App) -> Vec<(&'static str, Entity, Mesh)> {
    let place = Transform::from_xyz(1.0, 2.0, -3.0).with_rotation(Quat::from_rotation_y(0.6));
    let cloth = Cloth::new(1.0, 1.0).with_particles(9, 9).with_pins(ClothPins::None);
    let cloth = app.world_mut().spawn((cloth, place)).id();
    let pipe = Cylinder::new(0.5, 1.0).mesh().resolution(12).segments(5).without_caps();
    let pipe = add(app, pipe.build());
    let pipe = app.world_mut().spawn((Mesh3d(pipe), ClothMesh::default(), place)).id();
    let cube = add(app, Cuboid::from_length(1.0).mesh().build());
    let cube = app.world_mut().spawn((Mesh3d(cube), SoftBodyMesh::new(0.3), place)).id();
    vec![
        ("Cloth", cloth, sheet(0.02)),
        ("ClothMesh", pipe, Cylinder::new(0.52, 1.1).mesh().resolution(40).segments(11).build()),
        ("SoftBodyMesh", cube, Sphere::new(0.55).mesh().uv(24, 16)),
    ]
}

/// Gives a body's entity a companion with a detailed mesh, at the same place.
fn drive(app: &mut App, driver: Entity, mesh: Mesh) -> Entity {
    let place = *app.world().get::<Transform>(driver).expect("placed");
    let handle = add(app, mesh);
    app.world_mut().spawn((Mesh3d(handle), DrivenMesh { driver }, place)).id()
}

/// Moves all particles of a body.
fn move_body(app: &mut App, body: Entity, motion: impl Fn(Vec3) -> Vec3) {
    let mut particles = app.world_mut().get_mut::<Particles>(body).expect("built");
    for i in 0..particles.len() {
        let place = motion(particles.position(i));
        particles.set_position(i, place);
    }
}

#[test]
fn a_rigid_motion_of_the_body_is_one_of_the_mesh() {
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let bodies = drivers(&mut app);
    let driven: Vec<_> =
        bodies.iter().map(|(_, driver, mesh)| drive(&mut app, *driver, mesh.clone())).collect();
    start(&mut app);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    let at_first: Vec<_> = driven.iter().map(|&entity| world_vertices(&app, entity)).collect();
    for ((name, driver, mesh), shown) in bodies.iter().zip(&at_first) {
        let place = app.world().get::<GlobalTransform>(*driver).expect("placed");
        let expected: Vec<Vec3> = places(mesh).iter().map(|&vertex| place.transform_point(vertex)).collect();
        assert!(farthest(shown, &expected) < 1e-5, "{name}: {} m off at rest", farthest(shown, &expected));
    }
    let turn = Quat::from_euler(EulerRot::XYZ, 1.0, -0.5, 2.0);
    let motion = |place: Vec3| turn * (place - Vec3::Y) + Vec3::new(-2.0, 3.0, 1.0);
    for (_, driver, _) in &bodies {
        move_body(&mut app, *driver, motion);
    }
    (0..2).for_each(|_| frame(&mut app, 1.0));
    for (((name, _, _), &entity), before) in bodies.iter().zip(&driven).zip(&at_first) {
        let expected: Vec<Vec3> = before.iter().map(|&place| motion(place)).collect();
        let off = farthest(&world_vertices(&app, entity), &expected);
        println!("{name}: off by {off:e} m after a rigid motion");
        assert!(off < 1e-4, "{name}: {off} m off");
    }
}

/// The distance of a point from a triangle in metres.
fn distance(point: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    Triangle3d::new(a, b, c).closest_point(point).distance(point)
}

trait ClosestPoint {
    fn closest_point(&self, point: Vec3) -> Vec3;
}

impl ClosestPoint for Triangle3d {
    /// In its plane if that is inside, else on the nearest edge.
    fn closest_point(&self, point: Vec3) -> Vec3 {
        let [a, b, c] = self.vertices;
        let normal = (b - a).cross(c - a).normalize();
        let foot = point - normal * normal.dot(point - a);
        let edges = [(a, b), (b, c), (c, a)];
        if edges.iter().all(|&(p, q)| (q - p).cross(foot - p).dot(normal) >= 0.0) {
            return foot;
        }
        let on_edge = |(p, q): (Vec3, Vec3)| {
            let along = (q - p) * ((point - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
            p + along
        };
        let near = edges.map(on_edge);
        near.into_iter().min_by(|p, q| p.distance(point).total_cmp(&q.distance(point))).expect("three")
    }
}

/// On a cloth that swings and folds, a mesh is as far off as it was, but for the rounding of triangles: less than a quarter of their
/// sides of 12.5 cm.
#[test]
fn it_stays_as_far_off_the_cloth_as_it_was() {
    for off in [0.0, 0.02] {
        let mut app = app();
        app.insert_resource(Wind { velocity: Vec3::new(1.0, 0.5, 6.0), ..default() });
        let driver = app.world_mut().spawn(swinging()).id();
        let driven = drive(&mut app, driver, sheet(off));
        start(&mut app);
        frame(&mut app, 1.0);
        let triangles = |app: &App, faces: &[[u32; 3]]| {
            let corners = vertices(app, driver);
            faces.iter().map(|face| face.map(|corner| corners[corner as usize])).collect::<Vec<_>>()
        };
        let faces = app.world().get::<Sticks>(driver).expect("built").faces().to_vec();
        let (mut farthest_off, mut deep) = (0.0_f32, 0.0_f32);
        for _ in 0..10 {
            (0..9).for_each(|_| frame(&mut app, 1.0));
            frame(&mut app, 1.5);
            let triangles = triangles(&app, &faces);
            deep = vertices(&app, driver).iter().map(|vertex| vertex.z).fold(deep, f32::max);
            for vertex in vertices(&app, driven) {
                let nearest = triangles.iter().map(|&corners| distance(vertex, corners)).fold(1.0, f32::min);
                farthest_off = farthest_off.max(nearest);
            }
        }
        assert!(deep > 0.1, "the wind blows it out of its plane");
        println!("a mesh that was {off} m off is up to {farthest_off} m off");
        assert!(farthest_off < off + 0.25 * 0.125, "{farthest_off} m off, and was {off} m");
        assert!(off == 0.0 || farthest_off > 0.9 * off, "it keeps off");
    }
}

#[test]
fn indices_textures_and_seams_stay_the_meshes_own() {
    let mut app = app();
    let bodies = drivers(&mut app);
    let driven: Vec<_> =
        bodies.iter().map(|(_, driver, mesh)| drive(&mut app, *driver, mesh.clone())).collect();
    app.world_mut().spawn(Obstacle::ground());
    start(&mut app);
    (0..64).for_each(|_| frame(&mut app, 1.0));
    for ((name, _, mesh), &entity) in bodies.iter().zip(&driven) {
        let shown = mesh_of(&app, entity);
        assert_eq!(shown.indices(), mesh.indices());
        assert_eq!(shown.attribute(Mesh::ATTRIBUTE_UV_0), mesh.attribute(Mesh::ATTRIBUTE_UV_0));
        let (rest, now) = (places(mesh), world_vertices(&app, entity));
        let mut together = 0;
        for i in 0..rest.len() {
            for j in 0..i {
                if rest[i].distance(rest[j]) < 1e-5 {
                    together += 1;
                    assert!(now[i].distance(now[j]) < 1e-5, "{name}: vertices {i} and {j} came apart");
                }
            }
        }
        assert!(together > 10 || *name == "Cloth", "{name} has {together} seams");
        for normal in normals_of(&app, entity) {
            assert!((normal.length() - 1.0).abs() < 1e-4);
        }
    }
}

#[test]
fn what_comes_late_is_bound_as_the_body_was_made() {
    let mut app = app();
    let bodies = drivers(&mut app);
    start(&mut app);
    (0..20).for_each(|_| frame(&mut app, 1.0));
    let early: Vec<_> = bodies.iter().map(|(_, driver, mesh)| (*driver, mesh.clone())).collect();
    let meshes: Vec<_> =
        early.iter().map(|_| app.world().resource::<Assets<Mesh>>().reserve_handle()).collect();
    let late: Vec<_> = early
        .iter()
        .zip(&meshes)
        .map(|(&(driver, _), mesh)| {
            let place = *app.world().get::<Transform>(driver).expect("placed");
            app.world_mut().spawn((Mesh3d(mesh.clone()), DrivenMesh { driver }, place)).id()
        })
        .collect();
    (0..3).for_each(|_| frame(&mut app, 1.0));
    for ((_, mesh), handle) in early.iter().zip(&meshes) {
        app.world_mut().resource_mut::<Assets<Mesh>>().insert(handle, mesh.clone()).expect("reserved");
    }
    (0..2).for_each(|_| frame(&mut app, 1.0));
    for ((name, driver, mesh), &entity) in bodies.iter().zip(&late) {
        assert!(refusals(&app, entity).is_empty(), "to wait is no fault: {:?}", refusals(&app, entity));
        // All of them fall freely, and have kept their shape.
        let lower = app.world().get::<Particles>(*driver).expect("built").bounds().0.y;
        let place = app.world().get::<GlobalTransform>(*driver).expect("placed");
        let shown = world_vertices(&app, entity);
        let rest: Vec<Vec3> = places(mesh).iter().map(|&vertex| place.transform_point(vertex)).collect();
        let fallen = rest[0].y - shown[0].y;
        assert!(fallen > 0.3 && lower < 1.4, "{name} has fallen by {fallen} m");
        let expected: Vec<Vec3> = rest.iter().map(|vertex| vertex - Vec3::Y * fallen).collect();
        assert!(farthest(&shown, &expected) < 2e-3, "{name}: {} m off", farthest(&shown, &expected));
    }
}

#[test]
fn another_driver_a_new_body_and_none_are_taken_as_they_come() {
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let quiet = || Cloth::new(1.0, 1.0).with_particles(9, 9);
    let [a, b] = [0.0, 3.0].map(|x| app.world_mut().spawn((quiet(), Transform::from_xyz(x, 0.0, 0.0))).id());
    let driven = drive(&mut app, a, sheet(0.02));
    start(&mut app);
    (0..2).for_each(|_| frame(&mut app, 1.0));
    let middle = |app: &App| {
        let shown = world_vertices(app, driven);
        shown.iter().sum::<Vec3>() / shown.len() as f32
    };
    assert!(middle(&app).distance(Vec3::Z * 0.02) < 1e-4);
    // Another topology: of the same size, finer.
    app.world_mut().entity_mut(a).insert(quiet().with_particles(17, 17));
    (0..2).for_each(|_| frame(&mut app, 1.0));
    move_body(&mut app, a, |place| place + Vec3::Y);
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert!(middle(&app).y > 0.3, "it goes with the new body: {}", middle(&app));
    // Placed where it lies on the other one.
    app.world_mut().entity_mut(driven).insert((DrivenMesh { driver: b }, Transform::from_xyz(3.0, 0.0, 0.0)));
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert!(middle(&app).distance(Vec3::new(3.0, 0.0, 0.02)) < 1e-4, "{}", middle(&app));
    let shown = world_vertices(&app, driven);
    app.world_mut().entity_mut(b).despawn();
    (0..10).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(world_vertices(&app, driven), shown, "it stays as it is");
    assert!(refusals(&app, driven).is_empty());
    app.world_mut().entity_mut(driven).insert(DrivenMesh { driver: a });
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert!(refusals(&app, driven).is_empty());
    // A mesh of its own, changed.
    let handle = add(&mut app, sheet(0.04));
    app.world_mut().entity_mut(driven).insert((Mesh3d(handle), Transform::default()));
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert!((middle(&app).z - 0.04).abs() < 1e-3, "{}", middle(&app));
}

#[test]
fn a_mesh_goes_on_with_what_is_left_of_a_torn_cloth() {
    let mut app = app();
    let driver =
        app.world_mut().spawn((Cloth::new(1.0, 1.0).with_particles(9, 9), Transform::default())).id();
    let driven = drive(&mut app, driver, sheet(0.0));
    start(&mut app);
    frame(&mut app, 1.0);
    let blade = [Vec3::new(-1.0, -0.2, -1.0), Vec3::new(-1.0, -0.2, 1.0)];
    let far = blade.map(|place| place + Vec3::X * 2.0);
    app.world_mut().write_message(CutCloth::sweep(blade, far));
    (0..64).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(app.world_mut().query::<&Particles>().iter(app.world()).count(), 2, "it is cut");
    assert!(world_vertices(&app, driven).iter().all(|place| place.is_finite() && place.y > -2.0));
    assert_eq!(app.world_mut().query::<&DrivenMesh>().iter(app.world()).count(), 1);
}

#[test]
fn what_cannot_be_bound_is_refused_by_name() {
    let nowhere = {
        let mut mesh = sheet(0.0);
        let mut places: Vec<[f32; 3]> = places(&mesh).iter().map(Vec3::to_array).collect();
        places[7][1] = f32::NAN;
        mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, places);
        mesh
    };
    let broken = sheet(0.0).with_inserted_indices(Indices::U32(vec![0, 1, 99_999]));
    for (mesh, is_rope, words) in [
        (nowhere, false, "vertex 7 is at"),
        (broken, false, "99999"),
        (sheet(0.0), true, "no triangles to hang it on"),
    ] {
        let mut app = app();
        let driver = if is_rope {
            app.world_mut().spawn(Rope::default()).id()
        } else {
            app.world_mut().spawn(swinging()).id()
        };
        let driven = drive(&mut app, driver, mesh);
        start(&mut app);
        (0..5).for_each(|_| frame(&mut app, 1.0));
        let messages = refusals(&app, driven);
        assert_eq!(messages.len(), 1, "{messages:?}");
        for word in ["DrivenMesh", driven.to_string().as_str(), words] {
            assert!(messages[0].contains(word), "“{}” does not name {word}", messages[0]);
        }
    }
}

#[test]
fn it_is_hidden_with_its_driver_and_leaves_nothing_behind() {
    let mut app = app();
    let driver = app.world_mut().spawn((swinging(), Visibility::Visible)).id();
    let handle = add(&mut app, sheet(0.0));
    let driven = app.world_mut().spawn((Mesh3d(handle.clone()), Visibility::Inherited)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    let names = |app: &App| {
        let components = app.world().inspect_entity(driven).expect("there");
        let mut names: Vec<String> = components.map(|(_, info)| info.name().to_string()).collect();
        names.sort_unstable();
        names
    };
    let (plain, count) = (names(&app), app.world().resource::<Assets<Mesh>>().len());
    app.world_mut().entity_mut(driven).insert(DrivenMesh { driver });
    (0..2).for_each(|_| frame(&mut app, 1.0));
    // The play area ends above it.
    app.insert_resource(SceneManager { play_area_max: Vec3::splat(-50.0), ..default() });
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(*app.world().get::<Activity>(driver).expect("built"), Activity::Culled);
    assert_eq!(*app.world().get::<Visibility>(driven).expect("there"), Visibility::Hidden);
    app.insert_resource(SceneManager::default());
    (0..3).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(*app.world().get::<Visibility>(driven).expect("there"), Visibility::Inherited);
    app.world_mut().entity_mut(driven).remove::<DrivenMesh>();
    app.world_mut().entity_mut(driven).insert(Mesh3d(handle));
    (0..3).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(names(&app), plain);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), count, "the copy is gone");
}
