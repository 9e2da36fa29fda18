//! Spring bones that come with glTF files (`VRMC_springBone` 1.0).

use std::path::PathBuf;

use bevy::gltf::GltfAssetLabel;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::bones::{SpringBones, SpringCollider, SpringJoint};
use bevy_drape::prelude::*;
use drape_examples::view::gltf_files::{GltfFilePlugins, wait_for_files};
use serde_json::{Value, json};

/// A head on hips, with a chain of hair, and this extension.
fn file(extension: Value) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["VRMC_springBone"],
        "extensions": { "VRMC_springBone": extension },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "hips", "translation": [0.0, 1.0, 0.0], "children": [1] },
            { "name": "head", "translation": [0.0, 0.6, 0.0], "children": [2] },
            { "name": "hair 1", "translation": [0.0, 0.1, 0.1], "children": [3] },
            { "name": "hair 2", "translation": [0.0, 0.0, 0.1], "children": [4] },
            { "name": "hair end", "translation": [0.0, 0.0, 0.1] },
        ],
    })
}

fn extension() -> Value {
    json!({
        "specVersion": "1.0",
        "colliders": [
            { "node": 1, "shape": { "sphere": { "offset": [0.0, 0.05, 0.0], "radius": 0.1 } } },
            { "node": 0, "shape": { "capsule": { "offset": [0.0, 0.1, 0.0], "radius": 0.2, "tail": [0.0, 0.4, 0.1] } } },
            { "node": 0, "shape": { "sphere": { "radius": 0.3 } } },
        ],
        "colliderGroups": [{ "name": "unused", "colliders": [2] }, { "name": "body", "colliders": [0, 1] }],
        "springs": [{
            "name": "hair",
            "joints": [
                { "node": 2, "hitRadius": 0.02, "stiffness": 0.5, "gravityPower": 0.7, "gravityDir": [0.6, -0.8, 0.0], "dragForce": 0.3 },
                { "node": 3 },
                { "node": 4 },
            ],
            "colliderGroups": [1],
            "center": 0,
        }],
    })
}

/// An app in which the scene of a file with this extension has been spawned, and its root.
fn spawn(name: &str, extension: Value) -> (App, Entity) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = format!("{name}.gltf");
    std::fs::write(folder.join(&path), file(extension).to_string()).expect("a file");
    let mut app = App::new();
    let assets = AssetPlugin { file_path: folder.to_string_lossy().into_owned(), ..default() };
    app.add_plugins((MinimalPlugins, assets, TransformPlugin, MeshPlugin, ImagePlugin::default()))
        .add_plugins((GltfFilePlugins, AnimationPlugin))
        .add_plugins(DrapePlugins::default())
        .insert_resource(Time::<Fixed>::from_seconds(1.0 / 60.0))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    let scene = app.world().resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset(path));
    let root = app.world_mut().spawn(WorldAssetRoot(scene)).id();
    wait_for_files(&mut app).expect("a scene");
    app.update();
    assert!(named(&mut app, "hair end").is_some(), "the scene is there");
    (app, root)
}

fn named(app: &mut App, name: &str) -> Option<Entity> {
    let mut all = app.world_mut().query::<(Entity, &Name)>();
    all.iter(app.world()).find(|(_, known)| known.as_str() == name).map(|(entity, _)| entity)
}

fn place(app: &mut App, name: &str) -> Vec3 {
    let entity = named(app, name).expect("a joint");
    app.world().get::<GlobalTransform>(entity).expect("a place").translation()
}

#[test]
fn a_gltf_file_brings_its_spring_bones_along() {
    let (mut app, root) = spawn("spring_bones", extension());
    let joints = ["hair 1", "hair 2", "hair end"].map(|name| named(&mut app, name).expect("a joint"));
    let hips = named(&mut app, "hips").expect("a joint");
    let springs = app.world_mut().query::<&SpringBones>().single(app.world()).expect("one spring").clone();
    let first = SpringJoint {
        hit_radius: 0.02,
        stiffness: 0.5,
        gravity_power: 0.7,
        gravity_dir: Vec3::new(0.6, -0.8, 0.0),
        drag_force: 0.3,
        ..SpringJoint::new(joints[0])
    };
    assert_eq!(springs.joints, [first, SpringJoint::new(joints[1]), SpringJoint::new(joints[2])]);
    assert_eq!(springs.center, Some(hips));
    let colliders: Vec<(SpringCollider, Vec3)> = springs
        .colliders
        .iter()
        .map(|&collider| {
            let collider = app.world().entity(collider);
            let place = collider.get::<GlobalTransform>().expect("a place").translation();
            (*collider.get::<SpringCollider>().expect("a collider"), place)
        })
        .collect();
    let ball = SpringCollider { radius: 0.1, tail: Vec3::ZERO };
    let capsule = SpringCollider { radius: 0.2, tail: Vec3::new(0.0, 0.3, 0.1) };
    assert_eq!(colliders, [(ball, Vec3::new(0.0, 1.65, 0.0)), (capsule, Vec3::new(0.0, 1.1, 0.0))]);
    assert!(app.world().resource::<Refusals>().is_empty());

    // The head nods: the hair swings.
    for _ in 0..120 {
        app.update();
    }
    let still = place(&mut app, "hair end") - place(&mut app, "hair 1");
    app.world_mut().get_mut::<Transform>(root).expect("a root").rotation = Quat::from_rotation_y(1.0);
    let head = named(&mut app, "head").expect("a joint");
    app.world_mut().get_mut::<Transform>(head).expect("a head").rotation = Quat::from_rotation_x(0.5);
    app.update();
    app.update();
    let swung = place(&mut app, "hair end") - place(&mut app, "hair 1");
    let turned = Quat::from_rotation_y(1.0) * Quat::from_rotation_x(0.5) * still;
    assert!(swung.angle_between(turned) > 0.1, "{still} {swung} {turned}");
}

#[test]
fn a_gltf_file_with_a_faulty_extension_loads_without_springs() {
    let mut old = extension();
    old["specVersion"] = json!("0.9");
    let mut lost = extension();
    lost["springs"][0]["joints"][1]["node"] = json!(77);
    let mut shapeless = extension();
    shapeless["colliders"][0]["shape"] = json!({});
    let mut no_group = extension();
    no_group["springs"][0]["colliderGroups"] = json!([2]);
    let mut no_collider = extension();
    no_collider["colliderGroups"][1]["colliders"] = json!([0, 3]);
    let faulty = [
        ("old", old),
        ("lost", lost),
        ("shapeless", shapeless),
        ("empty", json!([])),
        ("no_group", no_group),
        ("no_collider", no_collider),
    ];
    for (name, extension) in faulty {
        let (mut app, _) = spawn(name, extension);
        assert_eq!(app.world_mut().query::<&SpringBones>().iter(app.world()).count(), 0);
        assert_eq!(app.world_mut().query::<&SpringCollider>().iter(app.world()).count(), 0);
    }
}
