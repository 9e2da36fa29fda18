//! Binding of a mesh's vertices to the particles of a body.

use drape_solver::Embedding;

use crate::render::smoothing::SmoothingGroups;
use crate::render::vertex_map::VertexMap;

/// Binding of a mesh's vertices to the particles of a body.
#[derive(Clone, Debug, Default)]
pub(crate) enum Vertices {
    /// Each vertex is a particle, in order.
    #[default]
    Particles,
    /// Vertices in one place are one particle.
    Welded(VertexMap),
    /// Vertices lie among fewer particles.
    Embedded(EmbeddedVertices),
}

impl Vertices {
    /// Returns the number of vertices for a number of particles.
    pub fn count(&self, particles: usize) -> usize {
        match self {
            Self::Particles => particles,
            Self::Welded(map) => map.particles.len(),
            Self::Embedded(vertices) => vertices.embedding.len(),
        }
    }
}

/// Vertices that lie among particles.
#[derive(Clone, Debug)]
pub(crate) struct EmbeddedVertices {
    pub embedding: Embedding,
    /// Vertices in one place that share a normal.
    pub groups: SmoothingGroups,
}

impl EmbeddedVertices {
    /// Groups the vertices of a mesh with these parts by shared normals.
    pub fn new(
        embedding: Embedding,
        positions: &[[f32; 3]],
        normals: Option<&[[f32; 3]]>,
        faces: &[[u32; 3]],
    ) -> Self {
        let points = embedding.firsts().iter().copied().map(Some);
        let groups = SmoothingGroups::new(points, positions, normals, faces);
        Self { embedding, groups }
    }
}
