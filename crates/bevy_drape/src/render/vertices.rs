//! How the vertices of a mesh follow the particles of the body that it shows.

use drape_solver::Embedding;

use crate::render::smoothing::SmoothingGroups;
use crate::render::vertex_map::VertexMap;

/// How the vertices of a mesh follow the particles of the body that it shows.
#[derive(Clone, Debug, Default)]
pub(crate) enum Vertices {
    /// Each vertex is a particle, in their order.
    #[default]
    Particles,
    /// Vertices in one place are one particle.
    Welded(VertexMap),
    /// Vertices lie among particles, of which there may be fewer.
    Embedded(EmbeddedVertices),
}

impl Vertices {
    /// The number of vertices that show a body of so many particles.
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
    /// Which of the vertices in one place share a normal.
    pub groups: SmoothingGroups,
}

impl EmbeddedVertices {
    /// The vertices of a mesh with these parts.
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
