//! The cape: a skinned mesh with pins and limits painted on it.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::render::PaintChannel;

use crate::character::skeleton::{CHEST, HIPS, THIGHS};

/// Columns and rows of the cape.
pub const CAPE: [usize; 2] = [13, 23];

/// Greatest distance of the hem from its animated place, in metres.
pub const FULL_DISTANCE: f32 = 0.7;

/// The joints of a vertex at (across, down), each from 0 to 1, and their weights.
fn skin(across: f32, down: f32) -> ([u16; 4], [f32; 4]) {
    let chest = (1.0 - 2.0 * down).max(0.0);
    let legs = (0.6 * (down - 0.5)).max(0.0);
    let joints = [CHEST, HIPS, THIGHS[0], THIGHS[1]].map(|joint| joint as u16);
    (joints, [chest, 1.0 - chest - legs, legs * (1.0 - across), legs * across])
}

/// A cape behind the shoulders: red paints pins, green paints limits of motion.
pub fn cape_mesh() -> Mesh {
    let [columns, rows] = CAPE;
    let part = |i: usize, n: usize| i as f32 / (n - 1) as f32;
    let mut places = Vec::new();
    let (mut joints, mut weights, mut colours) = (Vec::new(), Vec::new(), Vec::new());
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let (across, down) = (part(column, columns), part(row, rows));
        let half = 0.19 + 0.16 * down;
        let aside = 2.0 * across - 1.0;
        // The collar lies round the neck, its ends on the shoulders; further down the cape hangs behind the arms.
        let collar = aside * aside * (1.0 - down).powi(6);
        let (height, behind) = (1.46 - 0.95 * down + 0.04 * collar, 0.16 + 0.08 * down - 0.14 * collar);
        places.push([aside * half, height, behind]);
        let (joint, weight) = skin(across, down);
        joints.push(joint);
        weights.push(weight);
        colours.push([f32::from(row == 0), down, 0.0, 1.0]);
    }
    let square = |row: usize, column: usize| {
        let corner = (row * columns + column) as u32;
        let below = corner + columns as u32;
        [corner, below, corner + 1, corner + 1, below, below + 1]
    };
    let squares = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (row, column)));
    let indices = squares.flat_map(|(row, column)| square(row, column)).collect();
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colours)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
        .with_inserted_indices(Indices::U32(indices))
        .with_computed_normals()
}

/// The cape as it is worn.
pub fn cape() -> (ClothMesh, Fabric) {
    let paint =
        ClothPaint { max_distance: Some(PaintChannel::Green), full_distance: FULL_DISTANCE, ..default() };
    (ClothMesh { paint, ..default() }, Fabric { areal_density: 0.3, ..default() })
}
