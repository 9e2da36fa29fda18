//! Errors of meshes that cannot be built, and repairs of those that can.
//!
//! Design: docs/design/cloth_from_meshes.md.

use core::fmt;

use glam::Vec3;
use thiserror::Error;

use crate::error::BuildError;

/// The reason why a mesh cannot become a cloth or a solid.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh has no vertices.
    #[error("the mesh has no vertices")]
    NoVertices,
    /// The mesh has vertices, but no triangles between them.
    #[error("the mesh has {vertices} vertices, but no triangles between them")]
    NoFaces {
        /// The number of its vertices.
        vertices: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {face} has vertex {vertex} for a corner, but the mesh has {count}")]
    NoSuchVertex {
        /// Index of the triangle.
        face: usize,
        /// Index of the missing vertex.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// A corner of a triangle is not finite, or too far away.
    #[error("vertex {vertex} is at {position}: coordinates must be finite and below 1e6 m")]
    NotFinite {
        /// Index of the vertex.
        vertex: u32,
        /// Its position in metres.
        position: Vec3,
    },
    /// The mesh is smaller than a tenth of a millimetre: not in metres, or scaled down to nothing.
    #[error(
        "the mesh is {extent} m long at most, which must be at least {least} m: what is its unit of length?"
    )]
    TooSmall {
        /// The longest side of its box in metres.
        extent: f32,
        /// The least length in metres.
        least: f32,
    },
    /// All triangles are points or lines.
    #[error("none of the {faces} triangles of the mesh has an area")]
    NoArea {
        /// The number of its triangles.
        faces: usize,
    },
    /// The mesh of a solid has a hole.
    #[error("the mesh is not closed, as a solid must be: {edges} of its edges are not between two triangles")]
    NotClosed {
        /// The number of edges at holes.
        edges: usize,
    },
    /// The solid would have too many cells.
    #[error(
        "cells of {spacing} m are too small for the mesh: {cells:.0} of them along an axis, of which there may be {most}"
    )]
    TooManyCells {
        /// The greatest width of a cell in metres.
        spacing: f32,
        /// The number of cells along an axis.
        cells: f32,
        /// The greatest number allowed.
        most: u32,
    },
    /// The solid would have no cells.
    #[error("no cell of at most {spacing} m has its middle inside the mesh: take a smaller spacing")]
    NoCells {
        /// The greatest width of a cell in metres.
        spacing: f32,
    },
    /// A number is out of range, or a pin names a vertex that does not exist.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// Repairs and oddities of a mesh, counted when a cloth is built from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshRepairs {
    /// Triangles without an area, left out. Their edges still become sticks where they join particles of the cloth.
    pub empty_faces: usize,
    /// Triangles with the same three corners as another, left out: the back of a sheet with two sides.
    pub repeated_faces: usize,
    /// Triangles whose winding differed from their neighbours, and was reversed.
    pub turned_faces: usize,
    /// Pieces with one side only, such as a Möbius strip. Their triangles keep their winding.
    pub one_sided_pieces: usize,
    /// Edges of more than two triangles. They stay joined, and fold without resistance.
    pub crowded_edges: usize,
    /// Vertices that join pieces without a common edge there. They stay joined.
    pub bow_ties: usize,
    /// Vertices that belong to no triangle with an area. They are not part of the cloth.
    pub unused_vertices: usize,
}

impl MeshRepairs {
    /// True if there was nothing to repair.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for MeshRepairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all = [
            (self.empty_faces, "triangles without an area, left out"),
            (self.repeated_faces, "triangles that were there twice, left out"),
            (self.turned_faces, "triangles that turned the other way than their neighbours, turned"),
            (self.one_sided_pieces, "pieces with one side only"),
            (self.crowded_edges, "edges of more than two triangles, which fold without resistance"),
            (self.bow_ties, "vertices in which pieces touch that have no edge in common there"),
            (self.unused_vertices, "vertices without a triangle, left out"),
        ];
        for (i, (count, what)) in all.iter().filter(|(count, _)| *count > 0).enumerate() {
            let comma = if i > 0 { "; " } else { "" };
            write!(f, "{comma}{count} {what}")?;
        }
        Ok(())
    }
}
