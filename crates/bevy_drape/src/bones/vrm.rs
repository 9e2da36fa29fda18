//! Reads the extension `VRMC_springBone` 1.0 from glTF files.

use std::collections::BTreeMap;

use bevy::asset::LoadContext;
use bevy::gltf::GltfLoaderSettings;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler, GltfExtensionHandlers};
use bevy::gltf::gltf::{self, json::Value};
use bevy::prelude::*;

use crate::bones::spring_bones::{SpringBones, SpringCollider, SpringJoint};

/// The name of the extension.
const EXTENSION: &str = "VRMC_springBone";

/// Gives scenes of glTF files that have the extension `VRMC_springBone` their [`SpringBones`] and colliders.
pub(crate) struct VrmPlugin;

impl Plugin for VrmPlugin {
    fn build(&self, app: &mut App) {
        let handlers = app.world_mut().get_resource_or_init::<GltfExtensionHandlers>();
        // Nothing is loaded yet; browsers cannot wait.
        match handlers.0.try_write() {
            Some(mut handlers) => handlers.push(Box::new(SpringBoneReader::default())),
            None => error!("{EXTENSION} is not read: a file is being loaded already"),
        }
    }
}

/// Reads the extension while a file is loaded.
#[derive(Clone, Debug, Default)]
struct SpringBoneReader {
    extension: Option<Value>,
    /// The entities of a scene's nodes.
    nodes: BTreeMap<usize, Entity>,
}

impl GltfExtensionHandler for SpringBoneReader {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_root(&mut self, _: &mut LoadContext<'_>, gltf: &gltf::Gltf, _: &GltfLoaderSettings) {
        self.extension = gltf.extension_value(EXTENSION).cloned();
    }

    fn on_gltf_node(&mut self, _: &mut LoadContext<'_>, node: &gltf::Node, entity: &mut EntityWorldMut) {
        if self.extension.is_some() {
            self.nodes.insert(node.index(), entity.id());
        }
    }

    fn on_scene_completed(
        &mut self,
        context: &mut LoadContext<'_>,
        _: &gltf::Scene,
        root: Entity,
        world: &mut World,
    ) {
        let nodes = core::mem::take(&mut self.nodes);
        let Some(extension) = &self.extension else { return };
        if let Err(fault) = spawn(extension, &nodes, root, world) {
            error!("{EXTENSION} of {} is left out of the simulation: {fault}", context.path());
        }
    }
}

/// Spawns the springs and colliders of a scene.
fn spawn(
    extension: &Value,
    nodes: &BTreeMap<usize, Entity>,
    root: Entity,
    world: &mut World,
) -> Result<(), String> {
    match extension.get("specVersion").and_then(Value::as_str) {
        Some("1.0") => {}
        version => return Err(format!("`specVersion` must be 1.0, but is {version:?}")),
    }
    let node_of = |value: &Value, field: &str| {
        let node = value.get(field).and_then(Value::as_u64);
        let node = node.ok_or_else(|| format!("`{field}` must be the number of a node: {value}"))?;
        nodes.get(&(node as usize)).copied().ok_or_else(|| format!("there is no node {node} in the scene"))
    };
    let is_here = |joint: &Value| node_of(joint, "node").is_ok();
    if !array(extension, "springs").iter().flat_map(|spring| array(spring, "joints")).any(is_here) {
        // Another scene of the file has them.
        return Ok(());
    }
    // All that is wrong is found before anything is spawned.
    let colliders = array(extension, "colliders").iter().map(|collider| {
        let shape = read_collider(collider);
        let (shape, offset) =
            shape.ok_or_else(|| format!("a collider needs a sphere or a capsule: {collider}"))?;
        Ok((shape, offset, node_of(collider, "node")?))
    });
    let colliders: Vec<(SpringCollider, Vec3, Entity)> = colliders.collect::<Result<_, String>>()?;
    let springs = array(extension, "springs").iter().map(|spring| {
        let joints = array(spring, "joints").iter();
        let joints = joints
            .map(|joint| Ok(read_joint(joint, node_of(joint, "node")?)))
            .collect::<Result<_, String>>()?;
        let center = spring.get("center").map(|_| node_of(spring, "center")).transpose()?;
        let name = spring.get("name").and_then(Value::as_str).unwrap_or("spring").to_string();
        let mut touched = Vec::new();
        for group in indices(spring, "colliderGroups") {
            let group = array(extension, "colliderGroups").get(group);
            let group = group.ok_or("a spring names a group of colliders that does not exist")?;
            touched.extend(indices(group, "colliders"));
        }
        if touched.iter().any(|&collider| collider >= colliders.len()) {
            return Err("a group names a collider that does not exist".to_string());
        }
        Ok((name, joints, center, touched))
    });
    let springs: Vec<(String, Vec<SpringJoint>, Option<Entity>, Vec<usize>)> =
        springs.collect::<Result<_, String>>()?;
    let colliders: Vec<Entity> = colliders
        .into_iter()
        .map(|(collider, offset, node)| {
            let place = Transform::from_translation(offset);
            world.spawn((collider, place, Visibility::default(), ChildOf(node))).id()
        })
        .collect();
    for (name, joints, center, touched) in springs {
        let colliders = touched.iter().map(|&collider| colliders[collider]).collect();
        world.spawn((Name::new(name), SpringBones { joints, colliders, center }, ChildOf(root)));
    }
    Ok(())
}

/// A joint; what is not said is as in the specification.
fn read_joint(value: &Value, joint: Entity) -> SpringJoint {
    let default = SpringJoint::new(joint);
    SpringJoint {
        hit_radius: number(value, "hitRadius").unwrap_or(default.hit_radius),
        stiffness: number(value, "stiffness").unwrap_or(default.stiffness),
        gravity_power: number(value, "gravityPower").unwrap_or(default.gravity_power),
        gravity_dir: vector(value, "gravityDir").unwrap_or(default.gravity_dir),
        drag_force: number(value, "dragForce").unwrap_or(default.drag_force),
        ..default
    }
}

/// A collider, and its place on its node. None if it has no shape.
fn read_collider(value: &Value) -> Option<(SpringCollider, Vec3)> {
    let shape = value.get("shape")?;
    let (shape, is_capsule) = match shape.get("sphere") {
        Some(sphere) => (sphere, false),
        None => (shape.get("capsule")?, true),
    };
    let offset = vector(shape, "offset").unwrap_or_default();
    let tail = vector(shape, "tail").filter(|_| is_capsule).map_or(Vec3::ZERO, |tail| tail - offset);
    Some((SpringCollider { radius: number(shape, "radius").unwrap_or_default(), tail }, offset))
}

/// The elements of a field; none if it is not there.
fn array<'a>(value: &'a Value, field: &str) -> &'a [Value] {
    value.get(field).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn indices<'a>(value: &'a Value, field: &str) -> impl Iterator<Item = usize> + use<'a> {
    array(value, field).iter().filter_map(Value::as_u64).map(|index| index as usize)
}

fn number(value: &Value, field: &str) -> Option<f32> {
    value.get(field).and_then(Value::as_f64).map(|number| number as f32)
}

fn vector(value: &Value, field: &str) -> Option<Vec3> {
    let number = |place: usize| value.get(field)?.get(place)?.as_f64().map(|number| number as f32);
    Some(Vec3::new(number(0)?, number(1)?, number(2)?))
}
