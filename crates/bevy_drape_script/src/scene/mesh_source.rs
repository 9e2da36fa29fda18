//! Meshes that bodies are made of.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::number::bracketed;
use super::{Positive, Vector, Whole};
use crate::mesh_file::MeshFiles;

/// Where the mesh of a body comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum MeshSource {
    /// A mesh of a glTF file in its binary form (`.glb`), in its own coordinates: the transforms of the file's nodes do not
    /// count.
    File {
        /// The file, from the folder of the scene that is opened.
        path: String,
        /// Name of the mesh; may be left out where the file has only one.
        #[serde(default)]
        name: Option<String>,
    },
    /// A sphere of nearly equal triangles.
    Sphere {
        /// Radius in metres.
        radius: Positive,
        /// How often an icosahedron is divided, 0 to 6: 2 has 162 corners, each more four times as many.
        divisions: Whole<0, 6>,
    },
    /// A box.
    Cuboid {
        /// Its sides in metres.
        #[serde(deserialize_with = "bracketed")]
        size: (Positive, Positive, Positive),
    },
    /// Triangles by hand.
    Triangles {
        /// Corners in metres.
        vertices: Vec<Vector>,
        /// Three numbers of corners each, counter-clockwise as seen from the front.
        triangles: Vec<[u32; 3]>,
    },
}

impl Default for MeshSource {
    fn default() -> Self {
        Self::Sphere { radius: Positive::known(0.25), divisions: Whole::known(2) }
    }
}

impl MeshSource {
    /// The mesh itself, if it is of a file, from `files`.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub(crate) fn mesh(&self, files: &MeshFiles) -> Result<Mesh, String> {
        Ok(match self {
            Self::File { path, name } => files.mesh(path, name.as_deref())?,
            Self::Sphere { radius, divisions } => sphere(radius.get(), divisions.get()),
            Self::Cuboid { size: (x, y, z) } => Cuboid::new(x.get(), y.get(), z.get()).mesh().build(),
            Self::Triangles { vertices, triangles } => {
                mesh(vertices.iter().map(|corner| corner.get()).collect(), triangles.clone())
            }
        })
    }

    /// The file that it is in, if it is in one.
    pub(crate) fn file(&self) -> Option<&str> {
        match self {
            Self::File { path, .. } => Some(path),
            _ => None,
        }
    }
}

fn mesh(corners: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
        .with_inserted_indices(Indices::U32(triangles.into_flattened()))
}

/// A divided icosahedron. Bevy's own takes sines, which differ from machine to machine; this one takes roots only.
fn sphere(radius: f32, divisions: u32) -> Mesh {
    // Three golden rectangles, each through the other two.
    let (a, b) = (1.0, (1.0 + 5.0_f32.sqrt()) / 2.0);
    let mut corners: Vec<Vec3> = [[-a, b, 0.0], [a, b, 0.0], [-a, -b, 0.0], [a, -b, 0.0]]
        .into_iter()
        .flat_map(|[x, y, z]| [Vec3::new(x, y, z), Vec3::new(z, x, y), Vec3::new(y, z, x)])
        .map(Vec3::normalize)
        .collect();
    // Corners of the icosahedron are neighbours if they are as near as two can be.
    let edge =
        corners.iter().map(|corner| corner.distance(corners[0])).filter(|&d| d > 0.1).fold(9.0, f32::min);
    let near = |i: usize, j: usize| corners[i].distance(corners[j]) < 1.1 * edge;
    let mut triangles = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| (i, j, k))))
    {
        if near(i, j) && near(j, k) && near(k, i) {
            let outwards = (corners[j] - corners[i]).cross(corners[k] - corners[i]).dot(corners[i]) > 0.0;
            let [j, k] = if outwards { [j, k] } else { [k, j] };
            triangles.push([i, j, k].map(|corner| corner as u32));
        }
    }
    for _ in 0..divisions {
        let mut middles: Vec<([u32; 2], u32)> = Vec::new();
        for &[i, j, k] in &triangles {
            middles.extend([[i, j], [j, k], [k, i]].map(|[p, q]| ([p.min(q), p.max(q)], 0)));
        }
        middles.sort_unstable();
        middles.dedup();
        for ([p, q], middle) in &mut middles {
            *middle = corners.len() as u32;
            corners.push((corners[*p as usize] + corners[*q as usize]).normalize());
        }
        let middle = |p: u32, q: u32| {
            let at = middles.binary_search_by_key(&[p.min(q), p.max(q)], |&(ends, _)| ends);
            at.map_or(p, |at| middles[at].1)
        };
        let quarters = |&[i, j, k]: &[u32; 3]| {
            let (ij, jk, ki) = (middle(i, j), middle(j, k), middle(k, i));
            [[i, ij, ki], [ij, j, jk], [ki, jk, k], [ij, jk, ki]]
        };
        triangles = triangles.iter().flat_map(quarters).collect();
    }
    mesh(corners.into_iter().map(|corner| corner * radius).collect(), triangles)
}
