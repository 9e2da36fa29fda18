//! Soft solids made of meshes: what is shown of them, what they keep, what is refused.

use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, Pressure, Sticks};
use bevy_drape::drape_solver::state::measure;
use bevy_drape::drape_solver::volume;
use bevy_drape::render::PaintChannel;
use bevy_drape::tear::CutCloth;

use crate::*;

fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

fn places(mesh: &Mesh) -> Vec<Vec3> {
    let values = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(VertexAttributeValues::as_float3);
    values.expect("positions").iter().map(|&place| place.into()).collect()
}

/// An app with a solid of `mesh` at `transform`, after a step.
fn built(mesh: Mesh, solid: SoftBodyMesh, transform: Transform) -> (App, Entity) {
    let mut app = app();
    let handle = add(&mut app, mesh);
    let entity = app.world_mut().spawn((Mesh3d(handle), solid, transform)).id();
    start(&mut app);
    frame(&mut app, 1.0);
    (app, entity)
}

fn refusals(app: &App, entity: Entity) -> Vec<String> {
    app.world().resource::<Refusals>().of(entity).map(ToString::to_string).collect()
}

fn own_volume(app: &App, entity: Entity) -> f64 {
    let entity = app.world().entity(entity);
    volume(entity.get::<Particles>().expect("built"), entity.get::<Sticks>().expect("built"))
}

fn mass(app: &App, entity: Entity) -> f64 {
    measure::mass(app.world().get::<Particles>(entity).expect("built"))
}

/// Pairs of vertices in one place.
fn seams(places: &[Vec3]) -> Vec<[usize; 2]> {
    let pairs = (0..places.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
    pairs.filter(|pair| places[pair[0]].distance(places[pair[1]]) < 1e-5).collect()
}

/// The farthest that a seam has opened, in metres.
fn gap(seams: &[[usize; 2]], shown: &[Vec3]) -> f32 {
    seams.iter().map(|&[i, j]| shown[i].distance(shown[j])).fold(0.0, f32::max)
}

/// How far points are from where they were, moved and turned as a whole: root mean square of the differences of all distances.
fn deformation(now: &[Vec3], rest: &[Vec3]) -> f32 {
    let (mut sum, mut count) = (0.0_f64, 0.0_f64);
    for i in 0..now.len() {
        for j in 0..i {
            sum += f64::from(now[i].distance(now[j]) - rest[i].distance(rest[j])).powi(2);
            count += 1.0;
        }
    }
    (sum / count).sqrt() as f32
}

#[test]
fn a_dropped_jelly_keeps_its_volume_and_its_mesh_its_shape_and_seams() {
    let turned = Quat::from_euler(EulerRot::XYZ, 0.5, 0.3, 0.2);
    for (name, mesh, turn) in [
        ("cube", Cuboid::from_length(0.6).mesh().build(), Quat::IDENTITY),
        ("turned cube", Cuboid::from_length(0.6).mesh().build(), turned),
        ("sphere", Sphere::new(0.3).mesh().uv(24, 16), turned),
    ] {
        let rest = places(&mesh);
        let seams = seams(&rest);
        assert!(!seams.is_empty(), "{name} has its vertices once only");
        let place = Transform::from_xyz(0.0, 2.5, 0.0).with_rotation(turn);
        let (mut app, solid) = built(mesh, SoftBodyMesh::default(), place);
        app.world_mut().spawn(Obstacle::ground());
        let whole = own_volume(&app, solid);
        let (mut least, mut most, mut open, mut squeezed) = (1.0_f64, 1.0_f64, 0.0_f32, 0.0_f32);
        for _ in 0..8 * 64 {
            frame(&mut app, 1.0);
            let part = own_volume(&app, solid) / whole;
            (least, most) = (least.min(part), most.max(part));
            let shown = vertices(&app, solid);
            open = open.max(gap(&seams, &shown));
            squeezed = squeezed.max(deformation(&shown, &rest));
        }
        let lies = deformation(&vertices(&app, solid), &rest) / 0.6;
        println!(
            "{name}: volume from {least:.4} to {most:.4}; seams open by {open:e} m; squeezed by {:.4}, and by {lies:.5} at rest",
            squeezed / 0.6
        );
        assert_eq!(*app.world().get::<Activity>(solid).expect("built"), Activity::Resting);
        assert!(least > 0.95 && most < 1.05, "{name}: {least} to {most}");
        assert!(open < 1e-5, "{name}: seams open by {open} m");
        assert!(lies < 0.01, "{name}: {lies} of its size at rest");
        assert!(squeezed / 0.6 > 2.0 * lies, "{name}: it was squeezed");
        // Ground and thickness, within the half of a cell by which cells differ from the mesh.
        let lowest = world_vertices(&app, solid).iter().map(|place| place.y).fold(f32::INFINITY, f32::min);
        assert!(lowest.abs() < 0.05, "{name}: it lies {lowest} m over the ground");
    }
}

#[test]
fn a_cube_lies_on_its_ground_and_weighs_what_it_should() {
    let place = Transform::from_xyz(1.0, 0.32, -2.0).with_scale(Vec3::new(2.0, 1.0, 1.0));
    let (mut app, solid) = built(Cuboid::from_length(0.6).mesh().build(), SoftBodyMesh::new(0.13), place);
    assert!((mass(&app, solid) - 100.0 * 1.2 * 0.36).abs() < 1e-3, "{} kg", mass(&app, solid));
    assert_eq!(particles(&app, solid).len(), 11 * 6 * 6, "cells of 0.12 m");
    app.world_mut().spawn(Obstacle::ground());
    (0..300).for_each(|_| frame(&mut app, 1.0));
    let low = world_vertices(&app, solid).iter().map(|place| place.y).fold(f32::INFINITY, f32::min);
    assert!((low - 0.005).abs() < 2e-3, "its lowest corner is at {low} m");
}

#[test]
fn the_shown_mesh_keeps_textures_edges_and_its_place() {
    let mesh = Cuboid::new(0.5, 0.4, 0.3).mesh().build();
    let mirrored = Transform::from_xyz(5.0, 2.0, 1.0)
        .with_rotation(Quat::from_rotation_y(0.7))
        .with_scale(Vec3::new(-2.0, 2.0, 1.0));
    let mut app = app();
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    let handle = add(&mut app, mesh.clone());
    let solid = app.world_mut().spawn((Mesh3d(handle.clone()), SoftBodyMesh::default(), mirrored)).id();
    start(&mut app);
    (0..3).for_each(|_| frame(&mut app, 1.0));
    let shown = mesh_of(&app, solid);
    assert_eq!(shown.indices(), mesh.indices());
    assert_eq!(shown.attribute(Mesh::ATTRIBUTE_UV_0), mesh.attribute(Mesh::ATTRIBUTE_UV_0));
    assert!(farthest(&vertices(&app, solid), &places(&mesh)) < 1e-5, "nothing pulls at it");
    let normals = mesh.attribute(Mesh::ATTRIBUTE_NORMAL).and_then(VertexAttributeValues::as_float3);
    let normals: Vec<Vec3> = normals.expect("normals").iter().map(|&normal| normal.into()).collect();
    assert!(farthest(&normals_of(&app, solid), &normals) < 1e-4, "its edges are sharp");
    let bounds = app.world().get::<Aabb>(solid).expect("bounds");
    assert!((Vec3::from(bounds.half_extents) - Vec3::new(0.25, 0.2, 0.15)).abs().max_element() < 1e-4);
    let source = app.world().resource::<Assets<Mesh>>().get(&handle).expect("kept");
    assert_eq!(places(source), places(&mesh), "the asset is left alone");
}

#[test]
fn it_is_shown_between_steps() {
    let (mut app, solid) =
        built(Sphere::new(0.3).mesh().uv(12, 8), SoftBodyMesh::default(), Transform::default());
    (0..8).for_each(|_| frame(&mut app, 1.0));
    let before = vertices(&app, solid);
    frame(&mut app, 0.5);
    let between = vertices(&app, solid);
    frame(&mut app, 0.5);
    let after = vertices(&app, solid);
    let middle: Vec<Vec3> = before.iter().zip(&after).map(|(a, b)| (*a + *b) * 0.5).collect();
    assert!(farthest(&before, &after) > 0.01, "it falls");
    assert!(farthest(&between, &middle) < 1e-5, "half way");
}

/// A ball without the triangles around its pole.
fn holed() -> Mesh {
    let mut mesh = Sphere::new(0.3).mesh().uv(16, 9);
    let bevy::mesh::Indices::U32(indices) = mesh.indices_mut().expect("indices") else {
        panic!("of 32 bits");
    };
    indices.truncate(indices.len() - 3 * 16);
    mesh
}

#[test]
fn what_is_no_solid_is_refused_by_name_and_the_rest_runs_on() {
    let ball = || Sphere::new(0.3).mesh().uv(16, 9);
    let lines = Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0_f32; 3]; 2]);
    let solid = SoftBodyMesh::default;
    for (mesh, solid, words) in [
        (holed(), solid(), "not closed, as a solid must be: 16 of its edges"),
        (ball(), SoftBodyMesh::new(0.0), "spacing must be above zero"),
        (ball(), SoftBodyMesh::new(f32::NAN), "spacing must be finite"),
        (ball(), SoftBodyMesh::new(0.001), "cells of 0.001 m are too small for the mesh"),
        (Torus::new(0.4, 0.5).mesh().build(), SoftBodyMesh::new(2.0), "take a smaller spacing"),
        (ball(), SoftBodyMesh { density: -1.0, ..solid() }, "density must be above zero"),
        (ball(), SoftBodyMesh { stiffness: 1.5, ..solid() }, "stiffness must be from 0 to 1"),
        (ball(), SoftBodyMesh { damping: f32::NAN, ..solid() }, "damping must be finite"),
        (ball(), solid().with_pins([9999]), "a pin names particle 9999"),
        (
            ball(),
            SoftBodyMesh { painted_pins: Some(PaintChannel::Attribute("Held".into())), ..solid() },
            "no attribute “Held”",
        ),
        (lines, solid(), "it is a LineList"),
        (ball().scaled_by(Vec3::splat(1e-6)), solid(), "what is its unit of length?"),
    ] {
        let mut app = app();
        let witness = app.world_mut().spawn(Projectile::default()).id();
        let handle = add(&mut app, mesh);
        let bad = app.world_mut().spawn((Mesh3d(handle), solid)).id();
        start(&mut app);
        (0..32).for_each(|_| frame(&mut app, 1.0));
        let messages = refusals(&app, bad);
        assert_eq!(messages.len(), 1, "{messages:?}");
        for word in ["SoftBodyMesh", bad.to_string().as_str(), words] {
            assert!(messages[0].contains(word), "“{}” does not name {word}", messages[0]);
        }
        assert!(app.world().get::<Particles>(bad).is_none());
        let ball = app.world().get::<ProjectileState>(witness).expect("it flies");
        assert!(ball.position().y < -1.0, "the witness hangs at {}", ball.position());
        // Mended, it is built.
        let good = add(&mut app, Sphere::new(0.3).mesh().uv(16, 9));
        app.world_mut().entity_mut(bad).insert((Mesh3d(good), SoftBodyMesh::default()));
        frame(&mut app, 1.0);
        assert!(refusals(&app, bad).is_empty() && app.world().get::<Particles>(bad).is_some());
    }
}

#[test]
fn what_is_changed_is_built_anew_and_what_is_taken_off_leaves_nothing() {
    let count = |app: &App| app.world().resource::<Assets<Mesh>>().len();
    let mut app = app();
    let cube = add(&mut app, Cuboid::from_length(0.5).mesh().build());
    start(&mut app);
    frame(&mut app, 1.0);
    let before = app.world_mut().spawn((Mesh3d(cube.clone()), Transform::default())).id();
    frame(&mut app, 1.0);
    let plain: Vec<String> = names(&app, before);
    let solid = app.world_mut().spawn((Mesh3d(cube.clone()), SoftBodyMesh::default())).id();
    (0..10).for_each(|_| frame(&mut app, 1.0));
    let weighed = mass(&app, solid);
    app.world_mut().get_mut::<SoftBodyMesh>(solid).expect("described").density *= 2.0;
    frame(&mut app, 1.0);
    assert!((mass(&app, solid) / weighed - 2.0).abs() < 1e-5, "of the mesh and not of what it looks like");
    // The asset is saved anew.
    let large = Cuboid::from_length(1.0).mesh().build();
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&cube, large).expect("there");
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert!((mass(&app, solid) / weighed - 16.0).abs() < 1e-3);
    // Another mesh altogether.
    let ball = add(&mut app, Sphere::new(0.5).mesh().ico(3).expect("few"));
    app.world_mut().entity_mut(solid).insert(Mesh3d(ball.clone()));
    frame(&mut app, 1.0);
    assert!(
        (mass(&app, solid) / 200.0 - std::f64::consts::FRAC_PI_6).abs() < 0.02,
        "{} kg",
        mass(&app, solid)
    );
    // Those of the solids before are gone.
    frame(&mut app, 1.0);
    assert_eq!(count(&app), 3, "two meshes, and the copy that is shown");
    app.world_mut().entity_mut(solid).remove::<SoftBodyMesh>();
    frame(&mut app, 1.0);
    assert!(app.world().get::<Particles>(solid).is_none());
    // `Pressure` came by the solid's requirement, and stays as `Transform` does.
    app.world_mut().entity_mut(solid).remove::<Pressure>();
    assert_eq!(names(&app, solid), plain, "nothing else is left");
    app.world_mut().entity_mut(solid).insert(SoftBodyMesh::default());
    frame(&mut app, 1.0);
    app.world_mut().entity_mut(solid).despawn();
    (0..2).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(count(&app), 2, "the copy is gone with it");
}

/// The components of an entity that are not what Bevy's renderer side makes of any mesh.
fn names(app: &App, entity: Entity) -> Vec<String> {
    let components = app.world().inspect_entity(entity).expect("there");
    let mut names: Vec<String> = components.map(|(_, info)| info.name().to_string()).collect();
    names.sort_unstable();
    names
}

#[test]
fn pins_follow_the_entity() {
    let mesh = Cuboid::from_length(0.5).mesh().build();
    let top: Vec<u32> = (0..).zip(places(&mesh)).filter(|(_, place)| place.y > 0.0).map(|(i, _)| i).collect();
    let painted: Vec<[f32; 4]> =
        places(&mesh).iter().map(|place| [0.0, f32::from(place.y > 0.0), 0.0, 1.0]).collect();
    let painted = mesh.clone().with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, painted);
    let by_paint = SoftBodyMesh { painted_pins: Some(PaintChannel::Green), ..default() };
    for (mesh, solid) in [(mesh, SoftBodyMesh::default().with_pins(top.clone())), (painted, by_paint)] {
        let (mut app, solid) = built(mesh, solid, Transform::default());
        let at_first = vertices(&app, solid);
        (0..64).for_each(|_| frame(&mut app, 1.0));
        app.world_mut().get_mut::<Transform>(solid).expect("placed").translation.x = 0.2;
        (0..2).for_each(|_| frame(&mut app, 1.0));
        let now = vertices(&app, solid);
        for &vertex in &top {
            assert!(now[vertex as usize].distance(at_first[vertex as usize]) < 1e-4);
        }
        let body = app.world().get::<Particles>(solid).expect("built");
        assert_eq!(
            (0..body.len()).filter(|&i| body.is_pinned(i)).count(),
            4 * 8,
            "the four cells at the corners"
        );
    }
}

/// Green pins used to make the solid green.
#[test]
fn colours_that_are_read_as_paint_do_not_tint_the_solid() {
    let mesh = Cuboid::from_length(0.5).mesh().build();
    let green = vec![[0.0, 1.0, 0.0, 1.0]; mesh.count_vertices()];
    let painted = mesh.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, green);
    let has_colours = |painted_pins: Option<PaintChannel>| {
        let (app, solid) =
            built(painted.clone(), SoftBodyMesh { painted_pins, ..default() }, Transform::default());
        mesh_of(&app, solid).contains_attribute(Mesh::ATTRIBUTE_COLOR)
    };
    assert!(has_colours(None), "colours of another purpose");
    assert!(!has_colours(Some(PaintChannel::Green)));
}

#[test]
fn it_neither_tears_nor_is_cut() {
    let (mut app, solid) =
        built(Cuboid::from_length(0.5).mesh().build(), SoftBodyMesh::default(), Transform::default());
    let count = particles(&app, solid).len();
    app.world_mut().entity_mut(solid).insert(Tearable { strain: 0.001, ..default() });
    let blade = [Vec3::new(-2.0, 0.02, -2.0), Vec3::new(-2.0, 0.02, 2.0)];
    let far = blade.map(|place| place + Vec3::X * 4.0);
    app.world_mut().spawn((Obstacle::ground(), Transform::from_xyz(0.0, -1.0, 0.0)));
    app.world_mut().write_message(CutCloth::sweep(blade, far));
    (0..64).for_each(|_| frame(&mut app, 1.0));
    assert_eq!(particles(&app, solid).len(), count);
    assert_eq!(app.world_mut().query::<&Particles>().iter(app.world()).count(), 1);
    let messages = refusals(&app, solid);
    assert!(messages.len() == 1 && messages[0].contains("Tearable"), "{messages:?}");
}

#[test]
fn a_solid_with_a_skin_is_refused() {
    let mut app = app();
    app.init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>();
    let poses = vec![Mat4::IDENTITY];
    let poses = app
        .world_mut()
        .resource_mut::<Assets<bevy::mesh::skinning::SkinnedMeshInverseBindposes>>()
        .add(poses);
    let mesh = Cuboid::from_length(0.5).mesh().build();
    let count = mesh.count_vertices();
    let mesh = mesh
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(vec![[0; 4]; count]),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0_f32, 0.0, 0.0, 0.0]; count]);
    let handle = add(&mut app, mesh);
    let joint = app.world_mut().spawn(Transform::default()).id();
    let skin = bevy::mesh::skinning::SkinnedMesh { inverse_bindposes: poses, joints: vec![joint] };
    let solid = app.world_mut().spawn((Mesh3d(handle), SoftBodyMesh::default(), skin)).id();
    start(&mut app);
    (0..2).for_each(|_| frame(&mut app, 1.0));
    let messages = refusals(&app, solid);
    assert!(messages.len() == 1 && messages[0].contains("SkinnedMesh"), "{messages:?}");
}

#[test]
fn editors_and_scene_files_know_it_by_reflection() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    for name in ["SoftBodyMesh", "DrivenMesh"] {
        let registration = registry.get_with_short_type_path(name).expect(name);
        assert!(registration.data::<ReflectComponent>().is_some(), "{name} is no component there");
    }
    let solid = registry.get_with_short_type_path("SoftBodyMesh").expect("registered");
    assert!(solid.data::<ReflectDefault>().is_some());
}
