//! Furniture as a glTF file, made in code: a table with a lamp, an armchair, a stool, a vase and a rug.

use core::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use serde_json::{Value, json};

use crate::view::gltf_writer::{GltfWriter, material};

/// A part of a piece of furniture: its mesh, its place, and its material by index.
type Part = (Mesh, Vec3, usize);

const WOOD: usize = 0;
const LEATHER: usize = 1;
const CLAY: usize = 2;
const BRASS: usize = 3;
const WOOL: usize = 4;

/// A box of this size in metres around `middle`.
fn block(size: [f32; 3], middle: [f32; 3], material: usize) -> Part {
    (Cuboid::from_size(size.into()).into(), middle.into(), material)
}

/// A pole of this radius between two heights.
fn pole(radius: f32, [x, z]: [f32; 2], [low, high]: [f32; 2], material: usize) -> Part {
    let mesh = Cylinder::new(radius, high - low).mesh().resolution(24).build();
    (mesh, Vec3::new(x, 0.5 * (low + high), z), material)
}

/// A potter's work: an outline of radii and heights in metres, from the middle of the foot to the middle of the top.
///
/// ```text
/// height   top
///    |  <--+   .
///    |      )  .   turned about the axis
///    |  <--+   .
///    +---------+-- radius
/// ```
fn turned(outline: &[[f32; 2]], middle: [f32; 2], material: usize) -> Part {
    const AROUND: u32 = 32;
    let mut corners = Vec::new();
    for step in 0..AROUND {
        let (sine, cosine) = (TAU * step as f32 / AROUND as f32).sin_cos();
        corners.extend(outline.iter().map(|&[radius, height]| [radius * cosine, height, radius * sine]));
    }
    let rows = outline.len() as u32;
    let mut indices = Vec::new();
    for step in 0..AROUND {
        let (here, next) = (step * rows, (step + 1) % AROUND * rows);
        for row in 0..rows - 1 {
            let [a, b, c, d] = [here + row, here + row + 1, next + row + 1, next + row];
            indices.extend([a, b, c, a, c, d]);
        }
    }
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
        .with_inserted_indices(Indices::U32(indices))
        .with_computed_smooth_normals();
    (mesh, Vec3::new(middle[0], 0.0, middle[1]), material)
}

/// All pieces by name.
fn pieces() -> Vec<(&'static str, Vec<Part>)> {
    let table_legs = [[-0.5, -0.27], [-0.5, 0.27], [0.5, -0.27], [0.5, 0.27]];
    let mut table: Vec<Part> = table_legs.iter().map(|&foot| pole(0.03, foot, [0.0, 0.7], WOOD)).collect();
    table.push(block([1.2, 0.04, 0.7], [0.0, 0.72, 0.0], WOOD));
    let lamp = vec![
        turned(
            &[[0.0, 0.74], [0.11, 0.74], [0.1, 0.77], [0.02, 0.79], [0.015, 1.02], [0.0, 1.02]],
            [-0.25, 0.0],
            BRASS,
        ),
        turned(&[[0.0, 1.02], [0.17, 1.02], [0.09, 1.24], [0.0, 1.24]], [-0.25, 0.0], CLAY),
    ];
    let armchair = vec![
        block([0.8, 0.3, 0.75], [-1.55, 0.25, 0.0], LEATHER),
        block([0.8, 0.95, 0.18], [-1.55, 0.475, -0.4], LEATHER),
        block([0.16, 0.6, 0.75], [-1.95, 0.3, 0.0], LEATHER),
        block([0.16, 0.6, 0.75], [-1.15, 0.3, 0.0], LEATHER),
    ];
    let stool_legs = [[1.26, -0.14], [1.26, 0.14], [1.54, -0.14], [1.54, 0.14]];
    let mut stool: Vec<Part> = stool_legs.iter().map(|&foot| pole(0.022, foot, [0.0, 0.45], WOOD)).collect();
    stool.push(pole(0.24, [1.4, 0.0], [0.45, 0.49], WOOD));
    let vase = vec![turned(
        &[
            [0.0, 0.49],
            [0.07, 0.49],
            [0.15, 0.62],
            [0.16, 0.72],
            [0.11, 0.84],
            [0.06, 0.9],
            [0.09, 0.97],
            [0.0, 0.97],
        ],
        [1.4, 0.0],
        CLAY,
    )];
    let rug = vec![block([4.4, 0.01, 1.8], [-0.1, 0.005, 0.1], WOOL)];
    vec![
        ("Table", table),
        ("Lamp", lamp),
        ("Armchair", armchair),
        ("Stool", stool),
        ("Vase", vase),
        ("Rug", rug),
    ]
}

/// The bytes of the file: a node for each piece, and below it one for each of its parts.
pub fn model() -> Vec<u8> {
    let mut model = GltfWriter::default();
    let (mut nodes, mut meshes, mut roots) = (Vec::<Value>::new(), Vec::<Value>::new(), Vec::new());
    for (name, parts) in pieces() {
        let mut children = Vec::new();
        for (mesh, place, material) in parts {
            children.push(nodes.len());
            nodes.push(json!({ "mesh": meshes.len(), "translation": place.to_array() }));
            let mesh = mesh.with_removed_attribute(Mesh::ATTRIBUTE_UV_0);
            meshes.push(json!({ "primitives": [model.primitive(&mesh, material)] }));
        }
        roots.push(nodes.len());
        nodes.push(json!({ "name": name, "children": children }));
    }
    let materials = [
        material("wood", [0.20, 0.09, 0.035, 1.0]),
        material("leather", [0.16, 0.03, 0.02, 1.0]),
        material("clay", [0.55, 0.2, 0.09, 1.0]),
        material("brass", [0.55, 0.36, 0.08, 1.0]),
        material("wool", [0.06, 0.10, 0.16, 1.0]),
    ];
    model.file(json!({
        "asset": { "version": "2.0", "generator": "bevy_drape, examples/models.rs" },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
    }))
}
