//! What can be wrong with a mesh, and what was put right.

use core::fmt;

use glam::Vec3;
use thiserror::Error;

use crate::error::BuildError;

/// Why no cloth or solid can be made from a mesh.
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
    /// A triangle has a corner that is no vertex.
    #[error("triangle {face} has vertex {vertex} for a corner, but the mesh has {count}")]
    NoSuchVertex {
        /// The triangle, by its place in the list.
        face: usize,
        /// The index at fault.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// A corner of a triangle is at no place, or too far away to compute with.
    #[error("vertex {vertex} is at {position}: coordinates must be finite and below 1e6 m")]
    NotFinite {
        /// The vertex, by index.
        vertex: u32,
        /// Where it is said to be.
        position: Vec3,
    },
    /// The mesh is smaller than a tenth of a millimetre: not in metres, or scaled down to nothing.
    #[error(
        "the mesh is {extent} m long at most, which must be at least {least} m: what is its unit of length?"
    )]
    TooSmall {
        /// The longest side of its box in metres.
        extent: f32,
        /// The least that it may be in metres.
        least: f32,
    },
    /// All triangles are points or lines.
    #[error("none of the {faces} triangles of the mesh has an area")]
    NoArea {
        /// The number of its triangles.
        faces: usize,
    },
    /// A solid was to be made of a mesh with a hole.
    #[error("the mesh is not closed, as a solid must be: {edges} of its edges are not between two triangles")]
    NotClosed {
        /// The number of edges at holes.
        edges: usize,
    },
    /// A solid would have too many cells.
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
    /// A solid would have no cells.
    #[error("no cell of at most {spacing} m has its middle inside the mesh: take a smaller spacing")]
    NoCells {
        /// The greatest width of a cell in metres.
        spacing: f32,
    },
    /// A number is out of range, or a pin is no vertex.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// What was put right in a mesh, or is odd about it, when a cloth was made from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MeshRepairs {
    /// Triangles without an area, which were left out. Where their edges join what is part of the cloth, sticks do still.
    pub empty_faces: usize,
    /// Triangles with the corners of another, whichever way they turn, which were left out: the back of a sheet with two sides.
    pub repeated_faces: usize,
    /// Triangles that turned the other way than their neighbours, and were turned.
    pub turned_faces: usize,
    /// Pieces with one side only, as a Möbius strip has: their triangles turn as they did.
    pub one_sided_pieces: usize,
    /// Edges of more than two triangles. They hold together, and fold without resistance.
    pub crowded_edges: usize,
    /// Vertices in which pieces touch that have no edge in common there. They hold together.
    pub bow_ties: usize,
    /// Vertices that belong to no triangle with an area. They are not part of the cloth.
    pub unused_vertices: usize,
}

impl MeshRepairs {
    /// Whether there was nothing to put right.
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
