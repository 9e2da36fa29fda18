//! Reads meshes from glTF files in their binary form.

use core::fmt;

use bevy::prelude::*;
use gltf::accessor::{Accessor, DataType, Dimensions};
use gltf::mesh::util::{ReadColors, ReadTexCoords};
use gltf::mesh::{Mode, Semantic};
use gltf::{Gltf, Primitive};
use serde::{Deserialize, Serialize};

use super::triangle_mesh::triangle_mesh;

/// A mesh of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct FileMesh {
    pub name: String,
    /// In metres.
    positions: Vec<[f32; 3]>,
    /// One per position, or none.
    normals: Vec<[f32; 3]>,
    /// Texture coordinates: one per position, or none.
    coordinates: Vec<[f32; 2]>,
    /// Vertex colours: one per position, or none.
    colours: Vec<[f32; 4]>,
    triangles: Vec<[u32; 3]>,
}

impl FileMesh {
    /// The mesh as Bevy has it.
    pub fn to_bevy(&self) -> Mesh {
        let mut mesh = triangle_mesh(self.positions.clone(), &self.triangles);
        if !self.normals.is_empty() {
            mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, self.normals.clone());
        }
        if !self.coordinates.is_empty() {
            mesh.insert_attribute(Mesh::ATTRIBUTE_UV_0, self.coordinates.clone());
        }
        if !self.colours.is_empty() {
            mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, self.colours.clone());
        }
        mesh
    }

    /// Adds the triangles of a primitive.
    fn add(&mut self, primitive: &Primitive, buffer: &[u8]) -> Result<(), String> {
        if primitive.mode() != Mode::Triangles {
            return Err(format!("mesh `{}`: expected triangles, found {:?}", self.name, primitive.mode()));
        }
        let fail = |problem: String| format!("mesh `{}`: {problem}", self.name);
        for (semantic, accessor) in primitive.attributes() {
            check(&semantic, &accessor, buffer).map_err(&fail)?;
        }
        if let Some(indices) = primitive.indices() {
            fits(&indices, buffer).map_err(&fail)?;
        }
        let first = self.positions.len() as u32;
        let reader = primitive.reader(|_| Some(buffer));
        let positions = reader.read_positions().ok_or_else(|| fail("it has no positions".into()))?;
        self.positions.extend(positions);
        let count = self.positions.len();
        // The mesh keeps an attribute only if all of its primitives have it.
        extend(&mut self.normals, reader.read_normals(), first, count);
        extend(&mut self.coordinates, reader.read_tex_coords(0).map(ReadTexCoords::into_f32), first, count);
        extend(&mut self.colours, reader.read_colors(0).map(ReadColors::into_rgba_f32), first, count);
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().map(|index| index.saturating_add(first)).collect(),
            None => (first..count as u32).collect(),
        };
        self.triangles.extend(indices.as_chunks().0);
        Ok(())
    }
}

/// Adds one value per new vertex, up to `count` in all. Clears `values` if their number differs then.
fn extend<T>(values: &mut Vec<T>, new: Option<impl Iterator<Item = T>>, first: u32, count: usize) {
    if values.len() == first as usize {
        values.extend(new.into_iter().flatten());
    }
    if values.len() != count {
        values.clear();
    }
}

/// Reads all meshes of a file.
///
/// # Errors
/// The problem, in words.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<FileMesh>, String> {
    let in_words = |error: &dyn fmt::Display| error.to_string();
    if !bytes.starts_with(b"glTF") {
        return Err("expected the binary form (`.glb`)".into());
    }
    let file = Gltf::from_slice(bytes).map_err(|error| in_words(&error))?;
    let buffer = file.blob.as_deref().unwrap_or_default();
    let mut meshes = Vec::new();
    for mesh in file.meshes() {
        let name = mesh.name().map_or_else(|| mesh.index().to_string(), str::to_string);
        let mut read = FileMesh { name, ..FileMesh::default() };
        for primitive in mesh.primitives() {
            read.add(&primitive, buffer)?;
        }
        meshes.push(read);
    }
    Ok(meshes)
}

/// Checks the type of an attribute, which the reader of the `gltf` crate takes for granted.
fn check(semantic: &Semantic, accessor: &Accessor, buffer: &[u8]) -> Result<(), String> {
    let numbers = [DataType::F32, DataType::U8, DataType::U16];
    let (dimensions, types): (&[Dimensions], &[DataType]) = match semantic {
        Semantic::Positions | Semantic::Normals => (&[Dimensions::Vec3], &numbers[..1]),
        Semantic::TexCoords(0) => (&[Dimensions::Vec2], &numbers),
        Semantic::Colors(0) => (&[Dimensions::Vec3, Dimensions::Vec4], &numbers),
        _ => return Ok(()),
    };
    if !dimensions.contains(&accessor.dimensions()) || !types.contains(&accessor.data_type()) {
        return Err(format!("{semantic:?} of {:?} {:?}", accessor.dimensions(), accessor.data_type()));
    }
    fits(accessor, buffer)
}

/// Checks that an accessor lies within its view, and the view within the file's own buffer.
fn fits(accessor: &Accessor, buffer: &[u8]) -> Result<(), String> {
    let Some(view) = accessor.view().filter(|_| accessor.sparse().is_none()) else {
        return Err("sparse numbers are not read".into());
    };
    if !matches!(view.buffer().source(), gltf::buffer::Source::Bin) {
        return Err("its numbers are in another file; export all into one".into());
    }
    let size = accessor.size();
    let stride = view.stride().unwrap_or(size);
    let last = accessor.count().checked_sub(1).and_then(|last| last.checked_mul(stride));
    let end = last.and_then(|last| last.checked_add(size)?.checked_add(accessor.offset()));
    let view_end = view.offset().checked_add(view.length());
    let is_within = stride >= size
        && end.is_some_and(|end| end <= view.length())
        && view_end.is_some_and(|end| end <= buffer.len());
    if is_within { Ok(()) } else { Err("the file is shorter than it says".into()) }
}
