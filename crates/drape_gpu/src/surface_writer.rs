//! Writes positions and normals of bodies into a buffer of vertices, such as that of a renderer, without a detour by the processor.

use bytemuck::{Pod, Zeroable};
use drape_solver::glam::{Mat3, Vec3};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::growing_buffer::GrowingBuffer;
use crate::kernels::ListKernel;
use crate::source::LIST_WORKGROUP;
use crate::world::{GpuBodyId, LastStep, WeldedId};

/// The vertices of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyVertices {
    /// The body.
    pub body: GpuBodyId,
    /// The particles of the vertices. None: one vertex for each particle, in the order of the particles.
    pub welded: Option<WeldedId>,
    /// Turns directions of the world into those of the vertices; invertible.
    pub to_local: Mat3,
    /// The place in the world that is the origin of the vertices, in metres.
    pub origin: Vec3,
    /// From 0, the state before the last step, to 1, that after it.
    pub fraction: f32,
    /// The number of vertices for which the buffer has room. A body with another number is left out.
    pub vertex_count: u32,
    /// Index of the 32-bit word with the x of the first vertex's position in the buffer.
    pub first_position: u32,
    /// The same of its normal.
    pub first_normal: u32,
    /// Words from one vertex to the next, at least 3.
    pub stride: u32,
}

/// `Surface` of `surface.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct SurfaceData {
    axis_x: [f32; 3],
    first_particle: u32,
    axis_y: [f32; 3],
    vertex_count: u32,
    axis_z: [f32; 3],
    first_fan: u32,
    offset: [f32; 3],
    fraction: f32,
    first_position: u32,
    first_normal: u32,
    stride: u32,
    orientation: f32,
    first_vertex: u32,
    unused: [u32; 3],
}

/// In the place of the first vertex: each particle is a vertex.
const NONE: u32 = u32::MAX;

/// Writes the vertices of some bodies in one dispatch.
///
/// It needs no world, only its [`LastStep`], so that a renderer may have it on another thread.
#[derive(Debug)]
pub struct SurfaceWriter {
    gpu: Gpu,
    kernel: ListKernel<6>,
    shares: GrowingBuffer,
    surfaces: GrowingBuffer,
    share_count: u32,
    /// Pairs of words of the world, and its positions before and after its last step.
    read: Option<[wgpu::Buffer; 3]>,
}

impl SurfaceWriter {
    /// A writer of no bodies.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            gpu: gpu.clone(),
            kernel: ListKernel::of_surfaces(gpu),
            shares: GrowingBuffer::new(gpu, "shares of vertices"),
            surfaces: GrowingBuffer::new(gpu, "surfaces"),
            share_count: 0,
            read: None,
        }
    }

    /// Sets the bodies to write. Those that were added after `step`, or lack particles of their vertices, or have another number of vertices than there is room for,
    /// are left out.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no room.
    pub fn set_bodies(&mut self, step: &LastStep, bodies: &[BodyVertices]) -> Result<(), GpuError> {
        let (mut shares, mut surfaces) = (vec![[0; 2]], Vec::new());
        for vertices in bodies {
            let Some(place) = step.place_of(vertices.body) else { continue };
            let (vertex_count, particle_count) = vertices
                .welded
                .map_or((place.particle_count, 0), |welded| (welded.vertex_count, welded.particle_count));
            if vertex_count != vertices.vertex_count || place.particle_count < particle_count {
                continue;
            }
            let first_fan =
                vertices.welded.map_or(place.first_fan, |welded| welded.first_pair + welded.vertex_count);
            let firsts = (0..vertex_count).step_by(LIST_WORKGROUP as usize);
            shares.extend(firsts.map(|first| [surfaces.len() as u32, first]));
            let axes = vertices.to_local;
            surfaces.push(SurfaceData {
                axis_x: axes.x_axis.to_array(),
                first_particle: place.first_particle,
                axis_y: axes.y_axis.to_array(),
                vertex_count,
                axis_z: axes.z_axis.to_array(),
                first_fan,
                offset: (place.origin - vertices.origin).to_array(),
                fraction: vertices.fraction,
                first_position: vertices.first_position,
                first_normal: vertices.first_normal,
                stride: vertices.stride,
                // The triangles of a mesh look outwards in its own coordinates, those of a body in the world.
                orientation: if vertices.welded.is_some() { 1.0 } else { axes.determinant().signum() },
                first_vertex: vertices.welded.map_or(NONE, |welded| welded.first_pair),
                unused: [0; 3],
            });
        }
        let count = shares.len() as u32 - 1;
        shares[0][0] = count;
        for (buffer, data) in [
            (&mut self.shares, bytemuck::cast_slice::<_, u8>(&shares)),
            (&mut self.surfaces, bytemuck::cast_slice(&surfaces)),
        ] {
            buffer.reserve(&self.gpu, data.len() as u64)?;
            buffer.write(&self.gpu, 0, data);
        }
        self.share_count = count;
        self.read = Some(step.read.clone());
        Ok(())
    }

    /// Writes the vertices into `target` when the encoder's commands run. Words beyond its end are not written.
    ///
    /// # Panics
    /// By wgpu, if `target` may not be used as storage, or is larger than the device lets a shader see.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::Buffer) {
        let Some([pairs, before, after]) = &self.read else { return };
        if self.share_count > 0 {
            let bound = [self.shares.get(), self.surfaces.get(), pairs, before, after, target];
            self.kernel.encode(&self.gpu, encoder, bound, self.share_count);
        }
    }
}
