//! What the obstacles of a scene look like.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_drape_script::recording::Form;
use bevy_drape_script::scene::{Number, Positive, Shape, Vector};
use drape_solver::parry3d::transformation::try_convex_hull;

/// Side of the piece of a plane that is shown, in metres.
const PLANE: f32 = 600.0;

/// A mesh, and where it is in the obstacle's coordinates.
pub type Placed = (Mesh, Transform);

/// What an obstacle of a recording looks like. None for the inside of a box.
pub fn mesh_of(form: Form) -> Option<Placed> {
    let (half, middle) = match form {
        Form::HalfSpace { normal } => return Some(plane(Vec3::from_array(normal))),
        Form::Sphere { radius } => return Some((Sphere::new(radius).mesh().uv(48, 24), Transform::IDENTITY)),
        Form::Capsule { half_length, radius } => {
            let capsule = Capsule3d::new(radius, 2.0 * half_length).mesh().build();
            return Some((capsule, Transform::IDENTITY));
        }
        Form::Cuboid { half_extents } => (Vec3::from_array(half_extents), Vec3::ZERO),
        Form::Container { .. } => return None,
        Form::Other { low, high } => {
            let [low, high] = [low, high].map(Vec3::from_array);
            ((high - low) * 0.5, (low + high) * 0.5)
        }
    };
    let is_box = half.is_finite() && middle.is_finite();
    is_box.then(|| (Cuboid::from_size(half * 2.0).mesh().build(), Transform::from_translation(middle)))
}

/// What an obstacle of a scene looks like: of one with several parts, all of them. Nothing for the inside of a box.
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

fn plane(normal: Vec3) -> Placed {
    let turn = Quat::from_rotation_arc(Vec3::Y, normal.normalize_or(Vec3::Y));
    (Plane3d::default().mesh().size(PLANE, PLANE).build(), Transform::from_rotation(turn))
}

/// Triangles with edges that are seen.
pub fn flat(corners: &[Vec3], triangles: &[[u32; 3]]) -> Mesh {
    let corner = |index: &u32| corners.get(*index as usize).copied().unwrap_or_default();
    let positions: Vec<Vec3> = triangles.iter().flatten().map(corner).collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_computed_flat_normals()
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

/// What obstacles are made of. Where only the box is known, it can be seen through.
pub fn material_of(form: Form, colour: Color) -> StandardMaterial {
    let is_known = !matches!(form, Form::Other { .. });
    StandardMaterial {
        base_color: if is_known { colour } else { colour.with_alpha(0.25) },
        alpha_mode: if is_known { AlphaMode::Opaque } else { AlphaMode::Blend },
        ..solid(colour)
    }
}

/// What obstacles of this colour are made of. Thin sheets are seen from both sides.
pub fn solid(colour: Color) -> StandardMaterial {
    StandardMaterial {
        base_color: colour,
        perceptual_roughness: 0.9,
        reflectance: 0.15,
        double_sided: true,
        cull_mode: None,
        ..default()
    }
}
