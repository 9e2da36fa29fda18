//! The [character](crate::character) as a glTF file: what an artist would export, skinned, painted and animated.

use core::f32::consts::FRAC_PI_2;

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use serde_json::{Value, json};

use crate::character::cape_mesh::cape_mesh;
use crate::character::skeleton::{BONES, bind_place, capsule, inverse_bind_poses};
use crate::character::walk_cycle::{Character, pace};
use crate::view::gltf_writer::{GltfWriter, material};

/// Poses of an animation, in frames per second.
const FRAMES: usize = 30;

/// The animation of all joints in one stride of the character's walk, from a time at which it has this speed. It ends as it begins.
fn animation(model: &mut GltfWriter, name: &str, from: f32, speed: f32) -> Value {
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
    let input = model.floats(&times, true);
    let mut samplers = vec![json!({ "input": input, "output": model.floats(&hips, false) })];
    let mut channels = vec![json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } })];
    for (joint, poses) in poses.iter().enumerate() {
        let target = json!({ "node": joint, "path": "rotation" });
        channels.push(json!({ "sampler": samplers.len(), "target": target }));
        samplers.push(json!({ "input": input, "output": model.floats(poses, false) }));
    }
    json!({ "name": name, "samplers": samplers, "channels": channels })
}

/// Neck and shoulders, which a cape behind the back does not reach: joint, radius, length, and middle; the second lies along X.
pub(super) const NECK_AND_SHOULDERS: [(usize, f32, f32, Vec3); 2] =
    [(3, 0.05, 0.12, Vec3::new(0.0, 0.0, 0.0)), (2, 0.06, 0.34, Vec3::new(0.0, 0.15, 0.0))];

/// The body: one capsule for each bone, a little thinner than the capsule that the cape touches.
pub fn figure() -> Mesh {
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
    let mut model = GltfWriter::default();
    let meshes = [("Figure", figure(), 0), ("Cape", cape_mesh(), 1)];
    let meshes: Vec<Value> = meshes
        .iter()
        .map(|(name, mesh, material)| json!({ "name": name, "primitives": [model.primitive(mesh, *material)] }))
        .collect();
    let bind_poses: Vec<[f32; 16]> = inverse_bind_poses().iter().map(Mat4::to_cols_array).collect();
    let bind_poses = model.floats(&bind_poses, false);
    let animations = [animation(&mut model, "Walk", 2.0, 1.5), animation(&mut model, "Run", 10.1, 5.0)];
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
    model.file(json!({
        "asset": { "version": "2.0", "generator": "bevy_drape, examples/models.rs" },
        "scene": 0,
        "scenes": [{ "nodes": [nodes.len() - 1] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [material("skin", [0.2, 0.18, 0.16, 1.0]), material("cloth", [0.34, 0.012, 0.02, 1.0])],
        "skins": [{ "joints": joints, "inverseBindMatrices": bind_poses, "skeleton": 0 }],
        "animations": animations,
    }))
}
