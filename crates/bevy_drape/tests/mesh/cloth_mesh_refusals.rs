//! Meshes and numbers that no cloth can be made of.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy_drape::render::ClothWeave;

use crate::cloth_mesh::{SIDES, SQUARE, add, hung, of, of_triangles, pipe, refusals};
use crate::*;

/// Each is refused in words that name entity, mesh and fault, once; with a good mesh in its place all is well.
#[test]
fn a_mesh_that_is_no_cloth_is_refused() {
    let list = PrimitiveTopology::TriangleList;
    let all = [0, 1, 3, 0, 3, 2];
    let no_place = [SQUARE[0], SQUARE[1], [f32::NAN; 3], SQUARE[3]];
    let mut taken = of_triangles(&SQUARE, &all);
    taken.take_gpu_data().expect("there");
    let far = SQUARE.map(|place| place.map(|x| 1e7 * x));
    let tiny = SQUARE.map(|place| place.map(|x| 1e-7 * x));
    let cases = [
        ("no positions", Mesh::new(list, RenderAssetUsages::default()), "no positions"),
        ("empty", of(list, vec![]), "no vertices"),
        ("points", of(PrimitiveTopology::PointList, SQUARE.to_vec()), "PointList: a cloth needs triangles"),
        ("lines", of(PrimitiveTopology::LineList, SQUARE.to_vec()), "LineList"),
        ("a line", of(PrimitiveTopology::LineStrip, SQUARE.to_vec()), "LineStrip"),
        ("no triangles", of_triangles(&SQUARE, &[]), "no triangles"),
        ("a strip of two", of(PrimitiveTopology::TriangleStrip, SQUARE[..2].to_vec()), "no triangles"),
        ("two thirds of a triangle", of_triangles(&SQUARE, &all[..5]), "5 indices"),
        ("four vertices without indices", of(list, SQUARE.to_vec()), "4 indices"),
        ("an index past the end", of_triangles(&SQUARE, &[0, 1, 4]), "vertex 4"),
        ("not a number", of_triangles(&no_place, &all), "vertex 2"),
        ("far away", of_triangles(&far, &all), "below 1e6 m"),
        ("tiny", of_triangles(&tiny, &all), "unit of length"),
        ("in one place", of_triangles(&[[1.0; 3]; 4], &all), "unit of length"),
        ("without area", of_triangles(&SQUARE, &[0, 0, 1, 2, 2, 2]), "area"),
        ("with the renderer", taken, "RenderAssetUsages"),
    ];
    for (name, mesh, words) in cases {
        let (mut app, cloth) = hung(mesh, ClothMesh::default(), Transform::default());
        (0..3).for_each(|_| frame(&mut app, 1.0));
        let said = refusals(&app, cloth);
        assert_eq!(said.len(), 1, "{name}: {said:?}");
        for word in ["ClothMesh", &cloth.to_string(), "a mesh made in code", words] {
            assert!(said[0].contains(word), "{name}: “{}” does not say “{word}”", said[0]);
        }
        assert!(app.world().get::<Particles>(cloth).is_none());
        let good = add(&mut app, pipe());
        app.world_mut().entity_mut(cloth).insert(Mesh3d(good));
        frame(&mut app, 1.0);
        assert!(refusals(&app, cloth).is_empty());
        assert_eq!(particles(&app, cloth).len(), (SIDES * 7) as usize, "{name}");
    }
}

#[test]
fn fields_out_of_range_and_places_that_are_none_are_refused_and_mended() {
    let bad = [
        (
            ClothMesh { weave: Some(ClothWeave { weft_stiffness: 0.0, ..default() }), ..default() },
            "weft stiffness",
        ),
        (
            ClothMesh { weave: Some(ClothWeave { bias_stiffness: f32::NAN, ..default() }), ..default() },
            "bias stiffness",
        ),
        (ClothMesh { weld_distance: Some(-1.0), ..default() }, "weld_distance"),
        (ClothMesh::default().with_pins([100_000]), "a pin"),
    ];
    let woven_badly = [
        (Fabric { areal_density: 0.0, ..default() }, "areal_density"),
        (Fabric { stretch_stiffness: 2.0, ..default() }, "stiffness"),
        (Fabric { bend_stiffness: f32::NAN, ..default() }, "stiffness"),
        (Fabric { damping: -1.0, ..default() }, "damping"),
    ];
    for (fabric, words) in woven_badly {
        let (mut app, entity) = hung(pipe(), (ClothMesh::default(), fabric), Transform::default());
        let told = refusals(&app, entity);
        assert!(told[0].contains("Fabric") && told[0].contains(words), "{told:?}");
        *app.world_mut().get_mut::<Fabric>(entity).expect("woven") = default();
        frame(&mut app, 1.0);
        assert!(refusals(&app, entity).is_empty());
    }
    for (cloth, words) in bad {
        let (mut app, entity) = hung(pipe(), cloth, Transform::default());
        assert!(refusals(&app, entity)[0].contains(words), "{:?}", refusals(&app, entity));
        *app.world_mut().get_mut::<ClothMesh>(entity).expect("described") = ClothMesh::default();
        frame(&mut app, 1.0);
        assert!(refusals(&app, entity).is_empty() && app.world().get::<Particles>(entity).is_some());
    }
    for place in [Transform::from_scale(Vec3::ZERO), Transform::from_xyz(f32::NAN, 0.0, 0.0)] {
        let (mut app, entity) = hung(pipe(), ClothMesh::default(), place);
        assert_eq!(refusals(&app, entity).len(), 1);
        *app.world_mut().get_mut::<Transform>(entity).expect("placed") = Transform::default();
        frame(&mut app, 1.0);
        assert!(refusals(&app, entity).is_empty() && app.world().get::<Particles>(entity).is_some());
    }
}

/// It was made anew of what it had looked like, without its paint: the copy that shows it was taken for its mesh.
#[test]
fn what_was_refused_and_is_mended_is_made_of_its_own_mesh() {
    let (mut app, cloth) = hung(pipe(), ClothMesh::default(), Transform::default());
    let made = |app: &App| {
        let particles = app.world().get::<Particles>(cloth).expect("built");
        (0..particles.len()).map(|i| (particles.position(i), particles.is_pinned(i))).collect::<Vec<_>>()
    };
    let expected = made(&app);
    assert!(expected.iter().any(|&(_, is_pinned)| is_pinned));
    app.insert_resource(Wind { velocity: Vec3::new(6.0, 0.0, 2.0), ..default() });
    (0..30).for_each(|_| frame(&mut app, 1.0));
    app.world_mut().get_mut::<Fabric>(cloth).expect("described").areal_density = 0.0;
    frame(&mut app, 1.0);
    assert_eq!(refusals(&app, cloth).len(), 1);
    app.insert_resource(Wind::default());
    app.insert_resource(DrapeGravity(Vec3::ZERO));
    app.world_mut().get_mut::<Fabric>(cloth).expect("described").areal_density = 0.2;
    frame(&mut app, 1.0);
    let now = made(&app);
    assert_eq!(now.len(), expected.len());
    for (now, expected) in now.iter().zip(&expected) {
        assert_eq!(now.1, expected.1);
        assert!(now.0.distance(expected.0) < 5e-3, "{now:?} {expected:?}");
    }
}
