//! Cloths from meshes as modelling tools write them: seams, two sides, and worse.

use core::f32::consts::TAU;

use drape_solver::glam::Vec3;
use drape_solver::state::measure;
use drape_solver::{
    BodySettings, BuildError, ClothMaterial, Island, MeshCloth, MeshClothBuilder, MeshError, MeshRepairs,
    StateHasher, StickKind,
};

use crate::common::*;

/// Vertices and triangles.
type Mesh = (Vec<Vec3>, Vec<[u32; 3]>);

/// An open tube about the Y axis, 0.5 m in radius and 1 m high, of `columns` x `rows` squares. The first and the last column
/// of vertices are in the same places, as at a seam of texture coordinates.
fn tube(columns: u32, rows: u32) -> Mesh {
    let at = |column: u32, row: u32| row * (columns + 1) + column;
    let place = |column: u32, row: u32| {
        // The last column has the bits of the first.
        let (sin, cos) = (TAU * (column % columns) as f32 / columns as f32).sin_cos();
        Vec3::new(0.5 * cos, 1.0 - row as f32 / rows as f32, -0.5 * sin)
    };
    let positions = (0..=rows).flat_map(|row| (0..=columns).map(move |column| place(column, row))).collect();
    let square = |column: u32, row: u32| {
        let [a, b, c, d] =
            [at(column, row), at(column + 1, row), at(column, row + 1), at(column + 1, row + 1)];
        [[a, c, d], [a, d, b]]
    };
    let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    (positions, squares.flat_map(|(column, row)| square(column, row)).collect())
}

/// The same triangles, each with its own vertices.
fn soup((positions, faces): &Mesh) -> Mesh {
    let corners = faces.iter().flatten().map(|&corner| positions[corner as usize]).collect();
    (corners, (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// The same triangles with shuffled vertices, some of them duplicated.
fn shuffled((positions, faces): &Mesh) -> Mesh {
    let mut dice = Dice::new(3);
    let mut places: Vec<Vec3> = positions.iter().chain(positions).copied().collect();
    let mut numbers: Vec<usize> = (0..places.len()).collect();
    for i in (1..places.len()).rev() {
        let j = (dice.unit() * (i + 1) as f32) as usize;
        places.swap(i, j);
        numbers.swap(i, j);
    }
    let mut places_of = vec![[0; 2]; positions.len()];
    for (place, &number) in numbers.iter().enumerate() {
        places_of[number % positions.len()][number / positions.len()] = place as u32;
    }
    let corner = |corner: u32, dice: &mut Dice| places_of[corner as usize][usize::from(dice.unit() < 0.5)];
    (places, faces.iter().map(|face| face.map(|vertex| corner(vertex, &mut dice))).collect())
}

fn area((positions, faces): &Mesh) -> f64 {
    let of = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|corner| positions[corner as usize].as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    };
    faces.iter().map(of).sum()
}

fn builder((positions, faces): Mesh) -> MeshClothBuilder {
    MeshClothBuilder::new(positions, faces)
}

/// Pins all vertices at height 1 m.
fn hung(mesh: Mesh) -> MeshCloth {
    let tops: Vec<u32> = (0..mesh.0.len() as u32).filter(|&i| mesh.0[i as usize].y > 0.99).collect();
    tops.into_iter().fold(builder(mesh), MeshClothBuilder::pin).build_parts().expect("a good mesh")
}

fn island(cloth: MeshCloth, settings: BodySettings) -> Island {
    Island::of_body(drape_solver::Body::new(cloth.particles, cloth.topology.into(), settings))
}

#[test]
fn a_mesh_weighs_its_area_times_its_density() {
    for (name, mesh) in [("tube", tube(24, 10)), ("soup", soup(&tube(7, 3)))] {
        let material = ClothMaterial { areal_density: 0.31, ..ClothMaterial::default() };
        let expected = 0.31 * area(&mesh);
        let cloth = builder(mesh).material(material).build_parts().expect("a good mesh");
        law(&format!("mass of a {name} in kg"), measure::mass(&cloth.particles), expected, 1e-6);
    }
}

/// A corner of one triangle gets a third of the triangle's mass, not a quarter or a sixth of the square's.
#[test]
fn mass_lies_where_the_area_is() {
    let mesh = (vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::Y, Vec3::NEG_X], vec![[0, 1, 2], [0, 2, 3]]);
    let material = ClothMaterial { areal_density: 3.0, ..ClothMaterial::default() };
    let cloth = builder(mesh).material(material).build_parts().expect("a good mesh");
    let masses: Vec<f32> = (0..4).map(|i| 1.0 / cloth.particles.inverse_mass(i)).collect();
    assert_eq!(masses, [1.5, 1.0, 1.5, 0.5]);
}

#[test]
fn edges_and_the_corners_across_them_are_joined() {
    let cloth = builder(tube(24, 10)).build_parts().expect("a good mesh");
    let count = |kind| {
        let batches = cloth.topology.batches().iter().filter(|batch| batch.material.kind == kind);
        batches.map(|batch| batch.count).sum::<usize>()
    };
    assert_eq!(cloth.particles.len(), 24 * 11);
    let edges = 24 * 11 + 24 * 10 + 24 * 10;
    assert_eq!(count(StickKind::Structural), edges);
    assert_eq!(count(StickKind::Bend), edges - 2 * 24, "one across each edge that is not of the rim");
    assert!(cloth.repairs.is_empty(), "{}", cloth.repairs);
}

/// A tube that is blown up from inside stays closed at the seam.
#[test]
fn a_welded_tube_does_not_open_along_its_seam() {
    let (columns, rows) = unless_miri((24, 10), (6, 2));
    let cloth = hung(tube(columns, rows));
    let of = cloth.particle_of_vertex.clone();
    let mut island = island(cloth, BodySettings::default());
    let blow = |island: &mut Island| {
        let particles = &mut island.bodies[0].particles;
        for i in 0..particles.len() {
            let outwards = particles.position(i).with_y(0.0).normalize_or_zero();
            particles.add_force(i, outwards * 0.05);
        }
    };
    let around = |island: &Island, row: u32, column: u32| {
        let [a, b] = [column, column + 1].map(|column| of[(row * (columns + 1) + column) as usize]);
        let [a, b] = [a, b].map(|i| particles(island).position(i.expect("part of it") as usize));
        f64::from(a.distance(b))
    };
    let rest = around(&island, 0, 0);
    for _ in 0..unless_miri(120, 1) {
        blow(&mut island);
        drape_solver::step(&mut island, &gravity(FRAME)).expect("a good step");
    }
    let mut open = 0.0_f64;
    for row in 0..=rows {
        assert_eq!(of[(row * (columns + 1)) as usize], of[(row * (columns + 1) + columns) as usize]);
        let girth: f64 = (0..columns).map(|column| around(&island, row, column)).sum();
        open = open.max(girth / (rest * f64::from(columns)) - 1.0);
    }
    law_of_error("stretch of a tube's girth", open, 0.02);
}

#[test]
fn the_drape_is_the_same_whichever_way_vertices_are_split() {
    let mesh = tube(unless_miri(16, 5), unless_miri(8, 2));
    let end = |mesh: Mesh| {
        let mut island = island(hung(mesh), BodySettings::default());
        run(&mut island, &gravity(FRAME), 1.0);
        StateHasher::new().particles(particles(&island)).finish()
    };
    let expected = end(mesh.clone());
    assert_eq!(end(soup(&mesh)), expected);
    assert_eq!(end(shuffled(&mesh)), expected);
}

#[test]
fn vertices_that_almost_meet_are_welded_as_far_apart_as_is_asked() {
    let (mut positions, faces) = soup(&tube(8, 2));
    let mut dice = Dice::new(1);
    positions.iter_mut().for_each(|position| *position += dice.vector(1e-3));
    let count = |builder: MeshClothBuilder| builder.build_parts().expect("a mesh").particles.len();
    assert_eq!(count(builder((positions.clone(), faces.clone()))), positions.len());
    assert_eq!(count(builder((positions, faces)).weld_distance(4e-3)), 8 * 3);
}

/// Four corners of a square metre.
fn square() -> Mesh {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y];
    (positions, vec![[0, 1, 3], [0, 3, 2]])
}

fn with_vertices(more: &[Vec3], faces: &[[u32; 3]]) -> Mesh {
    let (mut positions, mut all) = square();
    positions.extend(more);
    all.extend(faces);
    (positions, all)
}

fn scaled(by: f32) -> Mesh {
    let (positions, faces) = square();
    (positions.into_iter().map(|p| p * by).collect(), faces)
}

fn moved(vertex: usize, to: Vec3) -> Mesh {
    let (mut positions, faces) = square();
    positions[vertex] = to;
    (positions, faces)
}

#[test]
fn what_is_no_cloth_is_refused_in_words_that_name_the_fault() {
    let all_faces = |faces: &[[u32; 3]]| (square().0, faces.to_vec());
    let cases: [(&str, Mesh, &str); 13] = [
        ("empty", (vec![], vec![]), "no vertices"),
        ("triangles without vertices", (vec![], vec![[0, 1, 2]]), "no vertices"),
        ("a cloud of points", (square().0, vec![]), "4 vertices, but no triangles"),
        ("an index past the end", all_faces(&[[0, 1, 3], [0, 3, 4]]), "triangle 1 has vertex 4"),
        ("the index that stands for none", all_faces(&[[0, 1, u32::MAX]]), "vertex 4294967295"),
        ("not a number", moved(2, Vec3::new(0.0, f32::NAN, 0.0)), "vertex 2 is at"),
        ("infinite", moved(3, Vec3::Z * f32::NEG_INFINITY), "vertex 3 is at"),
        ("light years", moved(1, Vec3::X * 1e17), "below 1e6 m"),
        ("nanometres", scaled(1e-9), "unit of length"),
        ("denormal", scaled(1e-40), "unit of length"),
        ("all in one place", (vec![Vec3::ONE; 4], square().1), "unit of length"),
        ("triangles of one vertex", all_faces(&[[0, 0, 0], [1, 1, 1], [2, 2, 3]]), "none of the 3 triangles"),
        (
            "all in a line",
            ((0..4).map(|i| Vec3::ONE * i as f32).collect(), square().1),
            "none of the 2 triangles",
        ),
    ];
    for (name, mesh, words) in cases {
        let error = builder(mesh).build_parts().expect_err(name);
        assert!(error.to_string().contains(words), "{name}: {error}");
    }
    let density = |areal_density| ClothMaterial { areal_density, ..ClothMaterial::default() };
    let stiffness = |bend_stiffness| ClothMaterial { bend_stiffness, ..ClothMaterial::default() };
    let fields = [
        (builder(square()).material(density(0.0)), "areal_density"),
        (builder(square()).material(density(f32::NAN)), "areal_density"),
        (builder(square()).material(stiffness(2.0)), "stiffness"),
        (builder(square()).weld_distance(-1.0), "weld_distance"),
        (builder(square()).weld_distance(f32::NAN), "weld_distance"),
        (builder(square()).weld_distance(10.0), "none of the 2 triangles"),
    ];
    for (builder, words) in fields {
        let error = builder.build_parts().expect_err(words);
        assert!(error.to_string().contains(words), "{error}");
    }
    let pin = builder(square()).pin(4).build_parts().expect_err("no such vertex");
    assert_eq!(pin, MeshError::Build(BuildError::NoSuchParticle { what: "a pin", index: 4, count: 4 }));
}

/// A strip of `count` squares, closed with half a twist.
fn moebius(count: u32) -> Mesh {
    let point = |i: u32, side: f32| {
        let angle = TAU * i as f32 / count as f32;
        let (sin, cos) = angle.sin_cos();
        let (lift, out) = (0.5 * angle).sin_cos();
        Vec3::new(cos, 0.0, sin) * (1.0 + 0.3 * side * out) + Vec3::Y * (0.3 * side * lift)
    };
    let positions = (0..count).flat_map(|i| [point(i, -1.0), point(i, 1.0)]).collect();
    let faces = (0..count).flat_map(|i| {
        let [a, b] = [2 * i, 2 * i + 1];
        let [c, d] = if i + 1 < count { [a + 2, b + 2] } else { [1, 0] };
        [[a, b, c], [b, d, c]]
    });
    (positions, faces.collect())
}

#[test]
fn what_is_odd_is_put_right_said_and_simulated() {
    let none = MeshRepairs::default;
    let repairs = |set: fn(&mut MeshRepairs)| {
        let mut repairs = none();
        set(&mut repairs);
        repairs
    };
    let back = Vec3::new(0.0, 0.0, 0.5);
    let cases: [(&str, Mesh, MeshRepairs, &str); 12] = [
        ("a square", square(), none(), ""),
        (
            "a triangle twice",
            with_vertices(&[], &[[1, 3, 0]]),
            repairs(|r| r.repeated_faces = 1),
            "1 triangles that were there twice",
        ),
        (
            "a sheet with a back",
            with_vertices(&[], &[[0, 3, 1], [0, 2, 3]]),
            repairs(|r| r.repeated_faces = 2),
            "2 triangles that were there twice",
        ),
        (
            "a triangle that is a point",
            with_vertices(&[], &[[2, 2, 2]]),
            repairs(|r| r.empty_faces = 1),
            "1 triangles without an area",
        ),
        (
            "a triangle that is a line",
            with_vertices(&[Vec3::new(0.5, 0.0, 0.0)], &[[0, 4, 1]]),
            repairs(|r| (r.empty_faces, r.unused_vertices) = (1, 1)),
            "1 triangles without an area, left out; 1 vertices without a triangle",
        ),
        (
            "one that turns the other way",
            (square().0, vec![[0, 1, 3], [0, 2, 3]]),
            repairs(|r| r.turned_faces = 1),
            "1 triangles that turned the other way",
        ),
        (
            "three triangles at an edge",
            with_vertices(&[back], &[[0, 3, 4]]),
            repairs(|r| r.crowded_edges = 1),
            "1 edges of more than two triangles",
        ),
        (
            "a bow tie",
            with_vertices(&[Vec3::NEG_X, Vec3::NEG_Y], &[[0, 4, 5]]),
            repairs(|r| r.bow_ties = 1),
            "1 vertices in which pieces touch",
        ),
        (
            "a vertex without a triangle",
            with_vertices(&[Vec3::splat(f32::NAN)], &[]),
            repairs(|r| r.unused_vertices = 1),
            "1 vertices without a triangle",
        ),
        ("a Möbius strip", moebius(12), repairs(|r| r.one_sided_pieces = 1), "1 pieces with one side only"),
        ("two pieces", with_vertices(&[back, back + Vec3::X, back + Vec3::Y], &[[4, 5, 6]]), none(), ""),
        ("a needle", moved(3, Vec3::new(1000.0, 1000.1, 0.0)), none(), ""),
    ];
    for (name, mesh, expected, words) in cases {
        let expected_mass = 0.25 * area(&mesh);
        let cloth = builder(mesh).pin(0).build_parts().unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(cloth.repairs, expected, "{name}: {}", cloth.repairs);
        assert!(cloth.repairs.to_string().contains(words), "{name}: {}", cloth.repairs);
        assert_eq!(words.is_empty(), cloth.repairs.is_empty());
        assert!(measure::mass(&cloth.particles) < expected_mass, "a pin weighs nothing");
        let mut island = island(cloth, BodySettings::default());
        run(&mut island, &gravity(FRAME), 2.0);
        assert!(particles(&island).is_finite(), "{name}");
        let speed = greatest_speed(&island);
        assert!(speed < 50.0, "{name}: {speed} m/s");
    }
}

/// Three triangles meet a larger one along its side, and a triangle without an area fills the gap. Without its edges the
/// cloth would open there.
#[test]
fn what_an_empty_triangle_joins_stays_joined() {
    let positions = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::new(0.5, 0.0, 0.0),
        Vec3::new(0.5, 1.0, 0.0),
        Vec3::new(0.5, -1.0, 0.0),
    ];
    let faces = vec![[0, 1, 3], [0, 4, 2], [2, 4, 1], [0, 2, 1]];
    let cloth = builder((positions, faces)).pin(3).build_parts().expect("a mesh");
    assert_eq!((cloth.repairs.empty_faces, cloth.particles.len()), (1, 5));
    let middle = cloth.particle_of_vertex[2].expect("part of it") as usize;
    let mut island = island(cloth, BodySettings::default());
    run(&mut island, &gravity(FRAME), 2.0);
    let place = particles(&island).position(middle);
    assert!((place - Vec3::new(0.5, 0.0, 0.0)).length() < 0.05, "{place}");
}
