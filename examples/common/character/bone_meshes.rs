//! Skinned surfaces on chains of joints: a tail, and a skirt.

use core::f32::consts::TAU;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::ecs::system::RunSystemOnce;
use bevy::math::Affine3A;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;

use crate::character::gltf_file::figure;
use crate::character::skeleton::{inverse_bind_poses, skinned};

/// Vertices of a tail all the way round.
const ROUND: usize = 12;
/// Vertices of a skirt from one chain to the next.
const BETWEEN: usize = 4;

/// A vertex: its place in the world, and the two joints that move it, with their weights.
type Vertex = (Vec3, [usize; 2], [f32; 2]);

/// Spawns a tail round a chain, thickest in its upper half, with `bundle` besides.
pub fn spawn_tail(world: &mut World, chain: &[Entity], radius: f32, bundle: impl Bundle) {
    let places = places(world, chain);
    let bone = ends(&places);
    let last = places.len() - 1;
    let rings = (0..=2 * places.len()).map(|ring| {
        let part = ring as f32 / (2 * places.len()) as f32;
        // From the root: quickly thick, slowly thin, a point.
        let thick = radius * (4.0 * part).min(1.0).sqrt().min((1.0 - part).max(0.0).sqrt() * 1.2);
        let (joint, along) = (ring / 2, 0.5 * (ring % 2) as f32);
        let at = places[joint.min(last)];
        let middle = at.transform_point3(Vec3::Y * bone * (along + (joint - joint.min(last)) as f32));
        // At a joint both bones count alike.
        let moves = if along > 0.0 { [joint; 2] } else { [joint.saturating_sub(1), joint.min(last)] };
        (0..ROUND).map(move |i| {
            let angle = TAU * i as f32 / ROUND as f32;
            let out = at.transform_vector3(Vec3::new(libm::cosf(angle), 0.0, libm::sinf(angle)) * thick);
            (middle + out, moves, [0.5; 2])
        })
    });
    let vertices: Vec<Vertex> = rings.flatten().collect();
    spawn(world, chain, &places, &vertices, ROUND, bundle);
}

/// Spawns a skirt along chains that stand side by side in a ring, with `bundle` besides.
pub fn spawn_skirt(world: &mut World, chains: &[Vec<Entity>], bundle: impl Bundle) {
    let joints: Vec<Entity> = chains.iter().flatten().copied().collect();
    let places = places(world, &joints);
    let length = chains[0].len();
    let bone = ends(&places[..length]);
    let mut vertices: Vec<Vertex> = Vec::new();
    for row in 0..=length {
        // The hem hangs on the last joints.
        let (joint, beyond) = (row.min(length - 1), (row - row.min(length - 1)) as f32);
        for chain in 0..chains.len() {
            let sides = [chain, (chain + 1) % chains.len()].map(|chain| chain * length + joint);
            let [left, right] = sides.map(|joint| places[joint].transform_point3(Vec3::Y * bone * beyond));
            vertices.extend((0..BETWEEN).map(|i| {
                let part = i as f32 / BETWEEN as f32;
                (left.lerp(right, part), sides, [1.0 - part, part])
            }));
        }
    }
    spawn(world, &joints, &places, &vertices, BETWEEN * chains.len(), bundle);
}

/// Spawns the figure of a character with these joints, with `bundle` besides.
pub fn spawn_figure(world: &mut World, joints: &[Entity], bundle: impl Bundle) {
    skin(world, joints, figure(), inverse_bind_poses(), bundle);
}

/// The places of joints, whose global transforms do not exist yet.
fn places(world: &mut World, joints: &[Entity]) -> Vec<Affine3A> {
    let place = |In(joints): In<Vec<Entity>>, transforms: TransformHelper| {
        let place = |joint| transforms.compute_global_transform(joint).unwrap_or_default().affine();
        joints.into_iter().map(place).collect::<Vec<_>>()
    };
    world.run_system_once_with(place, joints.to_vec()).unwrap_or_default()
}

/// Length of the bones of a chain.
fn ends(chain: &[Affine3A]) -> f32 {
    chain[0].translation.distance(chain[1].translation)
}

/// Spawns the surface of rings of `round` vertices each, skinned to `joints` in the pose `places`.
fn spawn(
    world: &mut World,
    joints: &[Entity],
    places: &[Affine3A],
    vertices: &[Vertex],
    round: usize,
    bundle: impl Bundle,
) {
    let square = |ring: usize, i: usize| {
        let [a, b] = [i, (i + 1) % round].map(|i| (ring * round + i) as u32);
        let [c, d] = [a, b].map(|above| above + round as u32);
        [a, c, b, b, c, d]
    };
    let rings = vertices.len() / round;
    let squares = (0..rings - 1).flat_map(|ring| (0..round).map(move |i| (ring, i)));
    let indices = squares.flat_map(|(ring, i)| square(ring, i)).collect();
    let uv = |i: usize| [(i % round) as f32 / round as f32, (i / round) as f32 / (rings - 1) as f32];
    let moves: Vec<[u16; 4]> = vertices.iter().map(|(_, [a, b], _)| [*a as u16, *b as u16, 0, 0]).collect();
    let weights: Vec<[f32; 4]> = vertices.iter().map(|(.., [a, b])| [*a, *b, 0.0, 0.0]).collect();
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_POSITION,
            vertices.iter().map(|v| v.0.to_array()).collect::<Vec<_>>(),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, (0..vertices.len()).map(uv).collect::<Vec<_>>())
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(moves))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
        .with_inserted_indices(Indices::U32(indices))
        .with_computed_normals();
    let poses = places.iter().map(|place| Mat4::from(place.inverse())).collect();
    skin(world, joints, mesh, poses, bundle);
}

/// Spawns a skinned mesh.
fn skin(world: &mut World, joints: &[Entity], mesh: Mesh, poses: Vec<Mat4>, bundle: impl Bundle) {
    let skinned = skinned(world, mesh, joints, poses);
    // The box of the mesh is that of its first pose.
    world.spawn((skinned, NoFrustumCulling, Transform::default(), bundle));
}
