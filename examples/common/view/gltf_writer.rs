//! Binary glTF files, written as an artist's tool would export them.

use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use serde_json::{Value, json};

/// glTF's codes of the component types of an accessor.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;

/// A binary glTF file in the making.
#[derive(Default)]
pub struct GltfWriter {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl GltfWriter {
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

    /// Adds rows of numbers, with their bounds if asked for; returns the index of their accessor.
    pub fn floats<const N: usize>(&mut self, rows: &[[f32; N]], is_bounded: bool) -> usize {
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

    /// Adds a mesh, and returns it as a primitive with this material.
    pub fn primitive(&mut self, mesh: &Mesh, material: usize) -> Value {
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
        if let Some(indices) = mesh.indices() {
            let indices: Vec<u32> = indices.iter().map(|index| index as u32).collect();
            primitive["indices"] = json!(self.indices(&indices));
        }
        primitive
    }

    /// The bytes of the file with this text, to which the buffer is added.
    pub fn file(self, mut text: Value) -> Vec<u8> {
        text["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        text["bufferViews"] = json!(self.views);
        text["accessors"] = json!(self.accessors);
        container(text.to_string().into_bytes(), self.bytes)
    }
}

/// A material of this name and colour, seen from both sides.
pub fn material(name: &str, colour: [f32; 4]) -> Value {
    let looks = json!({ "baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.8 });
    json!({ "name": name, "doubleSided": true, "pbrMetallicRoughness": looks })
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
