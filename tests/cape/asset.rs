//! The glTF file of the character with a cape.

use std::sync::LazyLock;

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use drape_examples::character::gltf_file::model;
use drape_examples::character::{BONES, cape_mesh};
use serde_json::Value;

/// The file in the repository.
static FILE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/models/cape.glb")).expect("the file")
});

/// The text of the file, and its numbers.
fn parts() -> (Value, &'static [u8]) {
    let number = |at: usize| u32::from_le_bytes(FILE[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&FILE[..4], number(4), number(8)), (&b"glTF"[..], 2, FILE.len()));
    let text = 20..20 + number(12);
    let numbers = text.end + 8..text.end + 8 + number(text.end);
    (serde_json::from_slice(&FILE[text]).expect("JSON"), &FILE[numbers])
}

fn size(value: &Value) -> usize {
    value.as_u64().expect("a number") as usize
}

/// The bytes of an accessor.
fn bytes<'a>(text: &Value, numbers: &'a [u8], accessor: &Value) -> &'a [u8] {
    let view = &text["bufferViews"][size(&text["accessors"][size(accessor)]["bufferView"])];
    let start = size(&view["byteOffset"]);
    &numbers[start..start + size(&view["byteLength"])]
}

#[test]
fn the_file_is_what_the_example_writes() {
    assert!(*FILE == model(), "run `cargo run --features meshes --example models`");
    assert!(FILE.len() < 200_000, "{} bytes", FILE.len());
}

#[test]
fn the_furniture_is_what_the_example_writes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/models/furniture.glb");
    let file = std::fs::read(path).expect("the file");
    assert!(file == drape_examples::furniture::model(), "run `cargo run --features meshes --example models`");
}

#[test]
fn the_cape_in_the_file_is_painted_and_skinned() {
    let (text, numbers) = parts();
    let node = text["nodes"].as_array().expect("nodes").iter().find(|node| node["name"] == "Cape");
    let node = node.expect("a cape");
    let attributes = &text["meshes"][size(&node["mesh"])]["primitives"][0]["attributes"];
    let mesh = cape_mesh();
    let floats =
        |rows: &[[f32; 4]]| -> Vec<u8> { rows.iter().flatten().flat_map(|v| v.to_le_bytes()).collect() };
    for (name, attribute) in [("COLOR_0", Mesh::ATTRIBUTE_COLOR), ("WEIGHTS_0", Mesh::ATTRIBUTE_JOINT_WEIGHT)]
    {
        let Some(VertexAttributeValues::Float32x4(rows)) = mesh.attribute(attribute) else {
            panic!("no {name}");
        };
        assert_eq!(bytes(&text, numbers, &attributes[name]), floats(rows), "{name}");
    }
    let skin = &text["skins"][size(&node["skin"])];
    let joints: Vec<usize> = skin["joints"].as_array().expect("joints").iter().map(size).collect();
    for (joint, (name, ..)) in joints.iter().zip(BONES) {
        assert_eq!(text["nodes"][joint]["name"], name);
    }
    assert_eq!(size(&text["accessors"][size(&skin["inverseBindMatrices"])]["count"]), BONES.len());
}

/// Accessors and views name what is there, and lie within the file: what a loader checks first.
#[test]
fn everything_in_the_file_is_where_it_says() {
    let (text, numbers) = parts();
    assert_eq!(size(&text["buffers"][0]["byteLength"]), numbers.len());
    for accessor in text["accessors"].as_array().expect("accessors") {
        let view = &text["bufferViews"][size(&accessor["bufferView"])];
        let lanes = match accessor["type"].as_str().expect("a type") {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let width = if accessor["componentType"] == 5123 { 2 } else { 4 };
        assert_eq!(size(&view["byteLength"]), size(&accessor["count"]) * lanes * width);
        assert!(size(&view["byteOffset"]).is_multiple_of(4));
        assert!(size(&view["byteOffset"]) + size(&view["byteLength"]) <= numbers.len());
    }
    for animation in text["animations"].as_array().expect("animations") {
        for channel in animation["channels"].as_array().expect("channels") {
            let sampler = &animation["samplers"][size(&channel["sampler"])];
            let count = |accessor: &Value| size(&text["accessors"][size(accessor)]["count"]);
            assert_eq!(count(&sampler["input"]), count(&sampler["output"]));
            assert!(size(&channel["target"]["node"]) < BONES.len());
        }
    }
}

/// They used to last a number of seconds, and jumped when they began anew.
#[test]
fn the_animations_end_as_they_begin() {
    let (text, numbers) = parts();
    for animation in text["animations"].as_array().expect("animations") {
        for sampler in animation["samplers"].as_array().expect("samplers") {
            let count = size(&text["accessors"][size(&sampler["output"])]["count"]);
            let poses = bytes(&text, numbers, &sampler["output"]);
            let width = poses.len() / count;
            assert!(count > 10);
            assert_eq!(poses[..width], poses[poses.len() - width..], "{}", animation["name"]);
        }
    }
}
