//! Backstops and drives towards the animated pose that are painted on a mesh.

use bevy::mesh::{MeshVertexAttribute, VertexAttributeValues, VertexFormat};
use bevy::prelude::*;
use bevy_drape::drape_solver::{Backstop, PoseDrive};
use bevy_drape::render::{BackstopPaint, PaintChannel, PoseDrivePaint, WeldedVertices};

use crate::cloth_mesh::{SIDES, hung, pipe, refusals};
use crate::*;

const RADIUS: MeshVertexAttribute = MeshVertexAttribute::new("Radius", 77_101, VertexFormat::Float32);
const DISTANCE: MeshVertexAttribute = MeshVertexAttribute::new("Distance", 77_102, VertexFormat::Float32);

fn named(attribute: MeshVertexAttribute) -> Option<PaintChannel> {
    Some(PaintChannel::Attribute(attribute.name.into()))
}

/// A number that grows down the pipe, from 0 to 1.
fn down(place: [f32; 3]) -> f32 {
    0.5 - place[1]
}

/// The pipe with two attributes painted.
fn painted() -> (Mesh, Vec<[f32; 3]>) {
    let mut mesh = pipe();
    let places = mesh.attribute(Mesh::ATTRIBUTE_POSITION).and_then(VertexAttributeValues::as_float3);
    let places = places.expect("positions").to_vec();
    let [radius, distance] =
        [1.0, 0.5].map(|part| places.iter().map(|&place| part * down(place)).collect::<Vec<f32>>());
    mesh.insert_attribute(RADIUS, radius);
    mesh.insert_attribute(DISTANCE, distance);
    (mesh, places)
}

fn with(paint: ClothPaint) -> ClothMesh {
    ClothMesh { paint, ..default() }
}

/// The sphere lies behind each vertex, inside the pipe, wherever the mesh is and however it is scaled or mirrored.
#[test]
fn painted_backstops_lie_behind_their_vertices() {
    let backstop = BackstopPaint {
        radius: named(RADIUS),
        full_radius: 0.2,
        distance: named(DISTANCE),
        full_distance: 0.1,
    };
    let cloth = with(ClothPaint { backstop: Some(backstop), ..default() });
    for scale in [Vec3::ONE, Vec3::new(2.0, 1.0, 0.5), Vec3::new(-1.0, 1.0, 2.0)] {
        let place =
            Transform::from_xyz(0.3, 2.0, 0.0).with_rotation(Quat::from_rotation_z(0.5)).with_scale(scale);
        let (mesh, places) = painted();
        let (mut app, entity) = hung(mesh, cloth.clone(), place);
        assert_eq!(refusals(&app, entity), [""; 0]);
        // The animation moves on, and the spheres with it.
        for moved in [place, place.with_translation(Vec3::Z).with_rotation(Quat::from_rotation_x(0.7))] {
            app.world_mut().entity_mut(entity).insert(moved);
            frame(&mut app, 1.0);
            frame(&mut app, 1.0);
            let body = app.world().get::<Particles>(entity).expect("built");
            let welded = app.world().get::<WeldedVertices>(entity).expect("built");
            let mut count = 0;
            for (vertex, &place) in places.iter().enumerate() {
                let i = welded.particle(vertex).expect("part of it");
                let radius = 0.2 * down(place);
                let Some((centre, Backstop { distance, radius: found })) = body.backstop(i) else {
                    assert!(radius == 0.0 || body.is_pinned(i), "vertex {vertex} has none");
                    continue;
                };
                count += 1;
                assert!((found - radius).abs() < 1e-6 && (distance - 0.05 * down(place)).abs() < 1e-6);
                // Outwards, from the axis: normals go by the inverse of the scale.
                let outward = Vec3::new(place[0], 0.0, place[2]) / moved.scale;
                let normal = moved.rotation * outward.normalize();
                let expected = moved.transform_point(place.into()) - normal * (radius + distance);
                assert!(
                    centre.distance(expected) < 2e-3,
                    "vertex {vertex}, {scale}: {centre}, not {expected}"
                );
            }
            assert_eq!(count, SIDES as usize * 6 + 6, "all but the upper rim, those on the seam twice");
        }
    }
}

/// What is painted draws; the rest is free.
#[test]
fn painted_drives_draw_their_vertices() {
    let pose_drive = PoseDrivePaint {
        frequency: named(RADIUS),
        full_frequency: 80.0,
        damping: named(DISTANCE),
        full_damping: 4.0,
    };
    let cloth = with(ClothPaint { pose_drive: Some(pose_drive), pins: None, ..default() });
    let (mesh, places) = painted();
    let (app, entity) = hung(mesh, cloth, Transform::default());
    let body = app.world().get::<Particles>(entity).expect("built");
    let welded = app.world().get::<WeldedVertices>(entity).expect("built");
    for (vertex, &place) in places.iter().enumerate() {
        let i = welded.particle(vertex).expect("part of it");
        let part = down(place);
        match body.pose_drive(i) {
            None => assert!(part == 0.0, "vertex {vertex} has none"),
            Some((target, PoseDrive { angular_frequency, damping_ratio })) => {
                assert!(target.distance(place.into()) < 1e-6);
                assert!((angular_frequency - 80.0 * part).abs() < 1e-4, "{angular_frequency}");
                assert!((damping_ratio - 2.0 * part).abs() < 1e-5, "{damping_ratio}");
            }
        }
    }
}

/// A pipe that nothing pins is held up by its drives, and sags by `g / w^2`.
#[test]
fn a_driven_cloth_follows_its_entity() {
    let pose_drive = PoseDrivePaint { full_frequency: 40.0, ..default() };
    let cloth = with(ClothPaint { pose_drive: Some(pose_drive), pins: None, ..default() });
    let (mesh, places) = painted();
    let (mut app, entity) = hung(mesh, cloth, Transform::default());
    let moved = Transform::from_xyz(0.5, 0.2, 0.0);
    app.world_mut().entity_mut(entity).insert(moved);
    (0..120).for_each(|_| frame(&mut app, 1.0));
    let body = app.world().get::<Particles>(entity).expect("built");
    let welded = app.world().get::<WeldedVertices>(entity).expect("built");
    let sag = Vec3::NEG_Y * (9.81 / (40.0 * 40.0));
    for (vertex, &place) in places.iter().enumerate() {
        let i = welded.particle(vertex).expect("part of it");
        let off = body.position(i) - moved.transform_point(place.into());
        assert!((off - sag).length() < 1e-3, "vertex {vertex} is {off} off");
    }
}

#[test]
fn paint_out_of_range_is_refused_and_mended() {
    let stop = |full_radius, full_distance| ClothPaint {
        backstop: Some(BackstopPaint { full_radius, full_distance, ..default() }),
        ..default()
    };
    let drive = |full_frequency, full_damping| ClothPaint {
        pose_drive: Some(PoseDrivePaint { full_frequency, full_damping, ..default() }),
        ..default()
    };
    for (paint, word) in [
        (stop(-1.0, 0.0), "radius of a backstop"),
        (stop(f32::NAN, 0.0), "radius of a backstop"),
        (stop(0.1, f32::INFINITY), "distance of a backstop"),
        (drive(-1.0, 1.0), "angular frequency of a pose drive"),
        (drive(f32::NAN, 1.0), "angular frequency of a pose drive"),
        (drive(10.0, -1.0), "damping ratio of a pose drive"),
    ] {
        let (mut app, entity) = hung(painted().0, with(paint), Transform::default());
        let said = refusals(&app, entity);
        assert!(said.len() == 1 && said[0].contains(word) && said[0].contains("paint"), "{word}: {said:?}");
        app.world_mut().entity_mut(entity).insert(ClothMesh::default());
        frame(&mut app, 1.0);
        assert!(refusals(&app, entity).is_empty());
    }
    let nowhere = Some(PaintChannel::Attribute("Nowhere".into()));
    let backstop = Some(BackstopPaint { radius: nowhere, ..default() });
    let (app, entity) = hung(painted().0, with(ClothPaint { backstop, ..default() }), Transform::default());
    assert!(refusals(&app, entity)[0].contains("no attribute “Nowhere”"));
}

/// Colours that a backstop or a drive reads are paint.
#[test]
fn colours_of_backstops_and_drives_do_not_tint_the_cloth() {
    let is_tinted = |paint: ClothPaint| {
        let (app, entity) = hung(pipe(), with(ClothPaint { pins: None, ..paint }), Transform::default());
        mesh_of(&app, entity).contains_attribute(Mesh::ATTRIBUTE_COLOR)
    };
    let backstop = Some(BackstopPaint { radius: Some(PaintChannel::Blue), ..default() });
    let pose_drive = Some(PoseDrivePaint { damping: Some(PaintChannel::Blue), ..default() });
    assert!(is_tinted(ClothPaint::default()));
    assert!(is_tinted(ClothPaint { backstop: Some(default()), ..default() }), "no colour is read");
    assert!(!is_tinted(ClothPaint { backstop, ..default() }));
    assert!(!is_tinted(ClothPaint { pose_drive, ..default() }));
}
