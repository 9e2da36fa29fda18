//! Vertices of meshes that lie on particles.

use crate::error::GpuError;
use crate::model::{fans_of, ranges_of};
use crate::world::gpu_world::GpuWorld;

/// The vertices of a mesh whose triangles are a body's faces. Several may lie on one particle, as along a seam of texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct WeldedVertices<'a> {
    /// The particle of each vertex. A vertex without one is never written.
    pub particles: &'a [Option<u32>],
    /// For each vertex the one whose normal it has: itself, or another one in the same place.
    pub normals: &'a [u32],
    /// Triangles of vertices. Each adds its normal, counter-clockwise seen from the front, to those of its corners.
    pub faces: &'a [[u32; 3]],
}

/// The name of [`WeldedVertices`] in the [`GpuWorld`] that knows them. Another world cannot tell that it is not its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeldedId {
    /// Of the world's pairs of words: the particle of each vertex, the range of its fan, and all fans.
    pub(crate) first_pair: u32,
    pub(crate) vertex_count: u32,
    /// Particles that a body must have.
    pub(crate) particle_count: u32,
}

impl WeldedId {
    /// The number of vertices.
    pub fn vertex_count(self) -> u32 {
        self.vertex_count
    }
}

/// In the place of a particle: there is none.
const NONE: u32 = u32::MAX;

impl WeldedVertices<'_> {
    /// The pairs that the shader reads: `[particle, unused]` of each vertex; then, as around particles, the range of each vertex's fan, counted from
    /// the first range, and in it the particles of the two other corners of each triangle.
    fn pairs(&self) -> Result<Vec<[u32; 2]>, GpuError> {
        let Self { particles, normals, faces } = *self;
        let count = particles.len();
        let is_vertex = |&vertex: &u32| (vertex as usize) < count;
        let corners = faces.as_flattened();
        if normals.len() != count {
            return Err(GpuError::Vertices("each has one entry among the normals"));
        }
        if !normals.iter().chain(corners).all(is_vertex) {
            return Err(GpuError::Vertices("a normal or a triangle names one that is not there"));
        }
        if corners.iter().any(|&corner| particles[corner as usize].is_none()) {
            return Err(GpuError::Vertices("a corner of a triangle has no particle"));
        }
        if particles.contains(&Some(NONE)) {
            return Err(GpuError::Vertices("the number of a particle is too large"));
        }
        let particle = |vertex: u32| particles[vertex as usize].unwrap_or(NONE);
        let fans = fans_of(faces, count);
        let ranges: Vec<[u32; 2]> = ranges_of(&fans).collect();
        let mut pairs: Vec<[u32; 2]> =
            particles.iter().map(|particle| [particle.unwrap_or(NONE), 0]).collect();
        pairs.extend(normals.iter().map(|&vertex| ranges[vertex as usize]));
        pairs.extend(fans.iter().flatten().map(|corners| corners.map(particle)));
        Ok(pairs)
    }
}

impl GpuWorld {
    /// Tells the GPU how the vertices of a mesh lie on the particles of bodies, for [`BodyVertices`](crate::BodyVertices). Equal ones share their memory,
    /// which is kept as long as the world. A [`LastStep`](crate::LastStep) that was asked for before does not know them.
    ///
    /// # Errors
    /// [`GpuError::Vertices`]; [`GpuError::Limit`] if the device has no room.
    pub fn add_vertices(&mut self, vertices: &WeldedVertices) -> Result<WeldedId, GpuError> {
        let pairs = vertices.pairs()?;
        let most = vertices.particles.iter().flatten().max();
        Ok(WeldedId {
            first_pair: self.share_pairs(pairs)?,
            vertex_count: vertices.particles.len() as u32,
            particle_count: most.map_or(0, |&most| most + 1),
        })
    }

    /// The index of the first of these pairs, which equal lists share.
    pub(super) fn share_pairs(&mut self, pairs: Vec<[u32; 2]>) -> Result<u32, GpuError> {
        if let Some((_, first)) = self.shared_pairs.iter().find(|(known, _)| **known == *pairs) {
            return Ok(*first);
        }
        let first = self.buffers.push_pairs(&self.gpu, &pairs)?;
        self.shared_pairs.push((pairs.into(), first));
        Ok(first)
    }
}
