//! Ten joints and the capsules on their bones.

use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;

/// Name, parent, place in the parent's coordinates, and the capsule: radius, length, middle.
pub const BONES: [(&str, Option<usize>, [f32; 3], [f32; 2], [f32; 3]); 10] = [
    ("hips", None, [0.0, 1.0, 0.0], [0.13, 0.1], [0.0, 0.0, 0.0]),
    ("spine", Some(0), [0.0, 0.15, 0.0], [0.12, 0.1], [0.0, 0.05, 0.0]),
    ("chest", Some(1), [0.0, 0.15, 0.0], [0.13, 0.14], [0.0, 0.06, 0.0]),
    ("head", Some(2), [0.0, 0.3, 0.0], [0.11, 0.02], [0.0, 0.13, 0.0]),
    ("left arm", Some(2), [-0.2, 0.15, 0.0], [0.045, 0.5], [0.0, -0.25, 0.0]),
    ("right arm", Some(2), [0.2, 0.15, 0.0], [0.045, 0.5], [0.0, -0.25, 0.0]),
    ("left thigh", Some(0), [-0.1, -0.05, 0.0], [0.08, 0.35], [0.0, -0.2, 0.0]),
    ("right thigh", Some(0), [0.1, -0.05, 0.0], [0.08, 0.35], [0.0, -0.2, 0.0]),
    ("left shin", Some(6), [0.0, -0.45, 0.0], [0.06, 0.35], [0.0, -0.2, 0.0]),
    ("right shin", Some(7), [0.0, -0.45, 0.0], [0.06, 0.35], [0.0, -0.2, 0.0]),
];

/// Joints by their numbers in [`BONES`].
pub const HIPS: usize = 0;
pub(super) const SPINE: usize = 1;
/// The chest.
pub const CHEST: usize = 2;
/// The head.
pub const HEAD: usize = 3;
/// Left and right.
pub const ARMS: [usize; 2] = [4, 5];
/// Left and right.
pub const THIGHS: [usize; 2] = [6, 7];
/// Left and right.
pub const SHINS: [usize; 2] = [8, 9];

/// The place of a joint in the mesh's coordinates, in metres.
pub fn bind_place(joint: usize) -> Vec3 {
    let (_, parent, place, ..) = BONES[joint];
    Vec3::from(place) + parent.map_or(Vec3::ZERO, bind_place)
}

/// The capsule of a bone along Y: radius, half the length, and its middle in the joint's coordinates.
pub fn capsule(joint: usize) -> (f32, f32, Vec3) {
    let (.., [radius, length], middle) = BONES[joint];
    (radius, length * 0.5, middle.into())
}

/// The matrices from the mesh's coordinates to each joint's.
pub fn inverse_bind_poses() -> Vec<Mat4> {
    (0..BONES.len()).map(|joint| Mat4::from_translation(-bind_place(joint))).collect()
}

/// A mesh that these joints move, from a pose of which `poses` are the inverses.
pub(super) fn skinned(
    world: &mut World,
    mesh: Mesh,
    joints: &[Entity],
    poses: Vec<Mat4>,
) -> (Mesh3d, SkinnedMesh) {
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    let poses = SkinnedMeshInverseBindposes::from(poses);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    (Mesh3d(mesh), SkinnedMesh { inverse_bindposes, joints: joints.to_vec() })
}
