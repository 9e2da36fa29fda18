//! Tubes around ropes.

use crate::error::GpuError;
use crate::world::gpu_world::GpuWorld;

/// A tube around a line of particles: a ring of vertices for each of them, the first of which is there twice, and a cap at each end with a ring of its own
/// and a vertex in its middle.
#[derive(Clone, Copy, Debug)]
pub struct TubeVertices<'a> {
    /// The particles, from one end to the other; at least 2.
    pub particles: &'a [u32],
    /// Number of corners of a ring, at least 3.
    pub sides: u32,
    /// Radius in the coordinates of the vertices.
    pub radius: f32,
}

/// The name of [`TubeVertices`] in the [`GpuWorld`] that knows them. Another world cannot tell that it is not its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeId {
    /// Of the world's pairs of words: the particle of each ring.
    pub(crate) first_pair: u32,
    pub(crate) ring_count: u32,
    /// Particles that a body must have.
    pub(crate) particle_count: u32,
    pub(crate) sides: u32,
    pub(crate) radius: f32,
}

impl TubeId {
    /// The number of vertices.
    pub fn vertex_count(self) -> u32 {
        vertex_count(self.ring_count, self.sides) as u32
    }
}

/// The number of vertices of rings and caps.
fn vertex_count(rings: u32, sides: u32) -> u64 {
    (u64::from(rings) + 2) * (u64::from(sides) + 1) + 2
}

impl GpuWorld {
    /// Tells the GPU which particles a tube is around, for [`BodyVertices`](crate::BodyVertices). Tubes around the same particles share their
    /// memory, which is kept as long as the world. A [`LastStep`](crate::LastStep) that was asked for before does not know it.
    ///
    /// # Errors
    /// [`GpuError::Vertices`]; [`GpuError::Limit`] if the device has no room.
    pub fn add_tube(&mut self, tube: &TubeVertices) -> Result<TubeId, GpuError> {
        let TubeVertices { particles, sides, radius } = *tube;
        let most = particles.iter().max().copied().unwrap_or(0);
        if particles.len() < 2 {
            return Err(GpuError::Vertices("a tube has fewer than two rings"));
        }
        if sides < 3 || !(radius > 0.0 && radius.is_finite()) {
            return Err(GpuError::Vertices("a tube has fewer than three sides, or no radius"));
        }
        let ring_count = particles.len() as u32;
        if most == u32::MAX || vertex_count(ring_count, sides) > u64::from(u32::MAX) {
            return Err(GpuError::Vertices(
                "a tube has too many vertices, or the number of a particle is too large",
            ));
        }
        Ok(TubeId {
            first_pair: self.share_pairs(particles.iter().map(|&particle| [particle, 0]).collect())?,
            ring_count,
            particle_count: most + 1,
            sides,
            radius,
        })
    }
}
