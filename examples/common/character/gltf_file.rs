//! The [character](crate::character) as a glTF file: what an artist would export, skinned, painted and animated.

use core::f32::consts::FRAC_PI_2;

use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::prelude::*;
use serde_json::{Value, json};

use crate::character::cape_mesh::cape_mesh;
use crate::character::skeleton::{BONES, bind_place, capsule, inverse_bind_poses};
use crate::character::walk_cycle::{Character, pace};

/// Poses of an animation, in frames per second.
const FRAMES: usize = 30;

/// glTF's codes of the component types of an accessor.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;

/// A binary glTF file in the making.
#[derive(Default)]
struct Model {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Model {
    /// Adds an accessor of rows of numbers; returns its index.
    fn add(
        &mut self,
        bytes: &[u8],
        count: usize,
        kind: &str,
        component: u32,
        bounds: Option<[Value; 2]>,
    ) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(),
        }));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut accessor = json!({
            "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind,
        });
        if let Some([low, high]) = bounds {
            accessor["min"] = low;
            accessor["max"] = high;
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, rows: &[[f32; N]], is_bounded: bool) -> usize {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let bound = |start: f32, pick: fn(f32, f32) -> f32| {
            let of = |k: usize| rows.iter().map(|row| row[k]).fold(start, pick);
            json!((0..N).map(of).collect::<Vec<_>>())
        };
        let bounds = is_bounded.then(|| [bound(f32::INFINITY, f32::min), bound(f32::NEG_INFINITY, f32::max)]);
        let kind = match N {
            1 => "SCALAR",
            3 => "VEC3",
            16 => "MAT4",
            _ => "VEC4",
        };
        self.add(&bytes, rows.len(), kind, FLOAT, bounds)
    }

    fn joints(&mut self, rows: &[[u16; 4]]) -> usize {
        let bytes: Vec<u8> = rows.iter().flatten().flat_map(|joint| joint.to_le_bytes()).collect();
        self.add(&bytes, rows.len(), "VEC4", UNSIGNED_SHORT, None)
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.add(&bytes, indices.len(), "SCALAR", UNSIGNED_INT, None)
    }

    /// The primitive of a mesh with this material.
    fn primitive(&mut self, mesh: &Mesh, material: usize) -> Value {
        let mut attributes = json!({});
        for (attribute, values) in mesh.attributes() {
            let (name, place) = match (attribute.id, values) {
                (id, VertexAttributeValues::Float32x3(rows)) if id == Mesh::ATTRIBUTE_POSITION.id => {
                    ("POSITION", self.floats(rows, true))
                }
                (id, VertexAttributeValues::Float32x3(rows)) if id == Mesh::ATTRIBUTE_NORMAL.id => {
                    ("NORMAL", self.floats(rows, false))
                }
                (id, VertexAttributeValues::Float32x4(rows)) if id == Mesh::ATTRIBUTE_COLOR.id => {
                    ("COLOR_0", self.floats(rows, false))
                }
                (id, VertexAttributeValues::Uint16x4(rows)) if id == Mesh::ATTRIBUTE_JOINT_INDEX.id => {
                    ("JOINTS_0", self.joints(rows))
                }
                (id, VertexAttributeValues::Float32x4(rows)) if id == Mesh::ATTRIBUTE_JOINT_WEIGHT.id => {
                    ("WEIGHTS_0", self.floats(rows, false))
                }
                _ => continue,
            };
            attributes[name] = json!(place);
        }
        let mut primitive = json!({ "attributes": attributes, "material": material });
        if let Some(Indices::U32(indices)) = mesh.indices() {
            primitive["indices"] = json!(self.indices(indices));
        }
        primitive
    }

    /// The animation of all joints in one stride of the character's walk, from a time at which it has this speed. It ends as it begins.
    fn animation(&mut self, name: &str, from: f32, speed: f32) -> Value {
        let length = 1.0 / pace(speed);
        let count = (length * FRAMES as f32).round() as usize;
        let mut character = Character::default();
        let mut first = Vec::new();
        let mut times = Vec::new();
        let mut poses = vec![Vec::new(); BONES.len()];
        let mut hips = Vec::new();
        for frame in 0..=count {
            let time = length * frame as f32 / count as f32;
            character.advance(from + time);
            let joints = if frame == count { first.clone() } else { character.pose().1 };
            if frame == 0 {
                first.clone_from(&joints);
            }
            times.push([time]);
            hips.push(joints[0].translation.to_array());
            poses.iter_mut().zip(&joints).for_each(|(poses, joint)| poses.push(joint.rotation.to_array()));
        }
        let input = self.floats(&times, true);
        let mut samplers = vec![json!({ "input": input, "output": self.floats(&hips, false) })];
        let mut channels = vec![json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } })];
        for (joint, poses) in poses.iter().enumerate() {
            let target = json!({ "node": joint, "path": "rotation" });
            channels.push(json!({ "sampler": samplers.len(), "target": target }));
            samplers.push(json!({ "input": input, "output": self.floats(poses, false) }));
        }
        json!({ "name": name, "samplers": samplers, "channels": channels })
    }
}

/// Neck and shoulders, which do not reach the cape: joint, radius, length, and middle; the second lies along X.
const NECK_AND_SHOULDERS: [(usize, f32, f32, Vec3); 2] =
    [(3, 0.05, 0.12, Vec3::new(0.0, 0.0, 0.0)), (2, 0.06, 0.34, Vec3::new(0.0, 0.15, 0.0))];

/// The body: one capsule for each bone, a little thinner than the capsule that the cape touches.
fn figure() -> Mesh {
    let bones = (0..BONES.len()).map(|joint| {
        let (radius, half, middle) = capsule(joint);
        (joint, radius * 0.97, 2.0 * half, middle)
    });
    let mut figure: Option<Mesh> = None;
    for (i, (joint, radius, length, middle)) in bones.chain(NECK_AND_SHOULDERS).enumerate() {
        let is_across = i == BONES.len() + 1;
        let turned = if is_across { Quat::from_rotation_z(FRAC_PI_2) } else { Quat::IDENTITY };
        let part = Capsule3d::new(radius, length).mesh().longitudes(10).latitudes(6).build();
        let mut part = part.rotated_by(turned).translated_by(bind_place(joint) + middle);
        part.remove_attribute(Mesh::ATTRIBUTE_UV_0);
        let count = part.count_vertices();
        let joints = VertexAttributeValues::Uint16x4(vec![[joint as u16, 0, 0, 0]; count]);
        part.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
        part.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0_f32, 0.0, 0.0, 0.0]; count]);
        match &mut figure {
            // Never an error: all parts have the same attributes.
            Some(figure) => _ = figure.merge(&part),
            None => figure = Some(part),
        }
    }
    figure.unwrap_or_else(|| Mesh::from(Capsule3d::default()))
}

/// The bytes of the file.
pub fn model() -> Vec<u8> {
    let mut model = Model::default();
    let meshes = [("Figure", figure(), 0), ("Cape", cape_mesh(), 1)];
    let meshes: Vec<Value> = meshes
        .iter()
        .map(|(name, mesh, material)| json!({ "name": name, "primitives": [model.primitive(mesh, *material)] }))
        .collect();
    let bind_poses: Vec<[f32; 16]> = inverse_bind_poses().iter().map(Mat4::to_cols_array).collect();
    let bind_poses = model.floats(&bind_poses, false);
    let animations = [model.animation("Walk", 2.0, 1.5), model.animation("Run", 10.1, 5.0)];
    let mut nodes: Vec<Value> = (0..BONES.len())
        .map(|joint| {
            let (name, _, place, ..) = BONES[joint];
            let children: Vec<usize> =
                (0..BONES.len()).filter(|&child| BONES[child].1 == Some(joint)).collect();
            let mut node = json!({ "name": name, "translation": place });
            if !children.is_empty() {
                node["children"] = json!(children);
            }
            node
        })
        .collect();
    let joints: Vec<usize> = (0..BONES.len()).collect();
    let first_mesh = nodes.len();
    for (mesh, name) in ["Figure", "Cape"].into_iter().enumerate() {
        nodes.push(json!({ "name": name, "mesh": mesh, "skin": 0 }));
    }
    nodes.push(json!({ "name": "Character", "children": [0, first_mesh, first_mesh + 1] }));
    let material = |name: &str, colour: [f32; 4]| {
        let looks = json!({ "baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.8 });
        json!({ "name": name, "doubleSided": true, "pbrMetallicRoughness": looks })
    };
    let text = json!({
        "asset": { "version": "2.0", "generator": "bevy_drape, examples/cape_model.rs" },
        "scene": 0,
        "scenes": [{ "nodes": [nodes.len() - 1] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [material("skin", [0.2, 0.18, 0.16, 1.0]), material("cloth", [0.34, 0.012, 0.02, 1.0])],
        "skins": [{ "joints": joints, "inverseBindMatrices": bind_poses, "skeleton": 0 }],
        "animations": animations,
        "buffers": [{ "byteLength": model.bytes.len() }],
        "bufferViews": model.views,
        "accessors": model.accessors,
    });
    container(text.to_string().into_bytes(), model.bytes)
}

/// Text and numbers in one file, in the binary format of glTF 2.0.
fn container(mut text: Vec<u8>, numbers: Vec<u8>) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + numbers.len();
    let mut file = b"glTF".to_vec();
    for number in [2, length as u32, text.len() as u32] {
        file.extend(number.to_le_bytes());
    }
    file.extend(b"JSON");
    file.extend(text);
    file.extend((numbers.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(numbers);
    file
}
