//! Meshes of the obstacles of a scene.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_drape_script::scene::{Number, Positive, Shape, Vector};
use drape_solver::parry3d::transformation::try_convex_hull;

use crate::view::shape_meshes::{Placed, flat, plane, tapered_capsule};

/// The meshes of an obstacle of a scene: one for each of its parts, none for the inside of a box.
pub fn meshes_of(shape: &Shape) -> Vec<Placed> {
    let at_home = |mesh: Mesh| vec![(mesh, Transform::IDENTITY)];
    let sides = |(x, y, z): &(Positive, Positive, Positive)| Vec3::new(x.get(), y.get(), z.get());
    match shape {
        Shape::Ground => vec![plane(Vec3::Y)],
        Shape::HalfSpace { normal } => vec![plane(normal.get())],
        Shape::Sphere { radius } => at_home(Sphere::new(radius.get()).mesh().uv(48, 24)),
        Shape::Capsule { radius, length } => {
            at_home(Capsule3d::new(radius.get(), length.get()).mesh().build())
        }
        Shape::TaperedCapsule { bottom_radius, top_radius, length } => {
            at_home(tapered_capsule(length.get() * 0.5, bottom_radius.get(), top_radius.get()))
        }
        Shape::Cuboid { size } | Shape::RoundCuboid { size, .. } => {
            at_home(Cuboid::from_size(sides(size)).mesh().build())
        }
        Shape::Container { .. } => Vec::new(),
        Shape::Cylinder { radius, height } => {
            at_home(Cylinder::new(radius.get(), height.get()).mesh().resolution(48).build())
        }
        Shape::Cone { radius, height } => {
            at_home(Cone::new(radius.get(), height.get()).mesh().resolution(48).build())
        }
        Shape::ConvexHull { points } => match try_convex_hull(&places(points)) {
            Ok((corners, triangles)) => at_home(flat(&corners, &triangles)),
            Err(_) => Vec::new(),
        },
        Shape::Mesh { vertices, triangles } => at_home(flat(&places(vertices), triangles)),
        Shape::HeightField { size: (x, z), heights } => at_home(land(x.get(), z.get(), heights)),
        Shape::Voxels { side, cubes } => {
            let cube = Cuboid::from_length(side.get()).mesh().build();
            let place = |&[x, y, z]: &[i32; 3]| (IVec3::new(x, y, z).as_vec3() + 0.5) * side.get();
            cubes.iter().map(|at| (cube.clone(), Transform::from_translation(place(at)))).collect()
        }
        Shape::Compound { parts } => parts
            .iter()
            .flat_map(|part| {
                let place = Transform::from_translation(part.at.get()).with_rotation(part.turn.quaternion());
                meshes_of(&part.shape).into_iter().map(move |(mesh, own)| (mesh, place * own))
            })
            .collect(),
    }
}

fn places(vectors: &[Vector]) -> Vec<Vec3> {
    vectors.iter().map(|vector| vector.get()).collect()
}

/// Heights on a grid, the first row at least Z.
fn land(x: f32, z: f32, heights: &[Vec<Number>]) -> Mesh {
    let (rows, columns) = (heights.len(), heights.first().map_or(0, Vec::len));
    let along =
        |index: usize, count: usize, side: f32| side * (index as f32 / (count.max(2) - 1) as f32 - 0.5);
    let mut positions = Vec::new();
    for (row, heights) in heights.iter().enumerate() {
        let place = |(column, height): (usize, &Number)| {
            Vec3::new(along(column, columns, x), height.get(), along(row, rows, z))
        };
        positions.extend(heights.iter().enumerate().map(place));
    }
    let mut indices = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            let here = (row * columns + column) as u32;
            let (left, up) = (here - 1, here - columns as u32);
            indices.extend([up - 1, left, up, up, left, here]);
        }
    }
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_indices(Indices::U32(indices))
        .with_computed_smooth_normals()
}
