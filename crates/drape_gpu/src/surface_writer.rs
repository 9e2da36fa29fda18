//! Writes positions and normals of bodies into a buffer of vertices, such as that of a renderer, without a detour by the processor.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use drape_solver::glam::{Mat3, Vec3};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::growing_buffer::GrowingBuffer;
use crate::kernels::ListKernel;
use crate::source::LIST_WORKGROUP;
use crate::world::{BodyPlace, GpuBodyId, LastStep, Places, TubeId, WeldedId};

/// The way in which the vertices of a mesh lie on the particles of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum BodyMesh {
    /// One vertex for each particle, in the order of the particles.
    #[default]
    Particles,
    /// Several vertices may lie on a particle.
    Welded(WeldedId),
    /// A tube around a rope. Its rings start from the first normal that the buffer has, so that it does not spin: keep that from frame to frame, zero at
    /// first.
    Tube(TubeId),
}

impl BodyMesh {
    /// The number of vertices on a body of so many particles; none if it has too few for them.
    pub fn vertex_count(&self, particle_count: u32) -> Option<u32> {
        let (vertices, particles) = match self {
            Self::Particles => (particle_count, 0),
            Self::Welded(welded) => (welded.vertex_count, welded.particle_count),
            Self::Tube(tube) => (tube.vertex_count(), tube.particle_count),
        };
        (particles <= particle_count).then_some(vertices)
    }
}

/// The vertices of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyVertices {
    /// The body.
    pub body: GpuBodyId,
    /// The way in which the vertices lie on its particles.
    pub mesh: BodyMesh,
    /// Turns directions of the world into those of the vertices; invertible.
    pub to_local: Mat3,
    /// The place in the world that is the origin of the vertices, in metres.
    pub origin: Vec3,
    /// The number of vertices for which the buffer has room. A body with another number is left out.
    pub vertex_count: u32,
    /// Index of the 32-bit word with the x of the first vertex's position in the buffer.
    pub first_position: u32,
    /// The same of its normal.
    pub first_normal: u32,
    /// Words from one vertex to the next, at least 3.
    pub stride: u32,
}

/// `Surface` of `vertices.wgsl`.
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
    orientation: f32,
    first_position: u32,
    first_normal: u32,
    stride: u32,
    first_vertex: u32,
    radius: f32,
    ring_count: u32,
    sides: u32,
    unused: u32,
}

impl SurfaceData {
    fn new(place: &BodyPlace, vertices: &BodyVertices) -> Self {
        let axes = vertices.to_local;
        let data = Self {
            axis_x: axes.x_axis.to_array(),
            first_particle: place.first_particle,
            axis_y: axes.y_axis.to_array(),
            vertex_count: vertices.vertex_count,
            axis_z: axes.z_axis.to_array(),
            first_fan: place.first_fan,
            offset: (place.origin - vertices.origin).to_array(),
            first_position: vertices.first_position,
            first_normal: vertices.first_normal,
            stride: vertices.stride,
            // The triangles of a mesh look outwards in its own coordinates, those of a body in the world.
            orientation: 1.0,
            first_vertex: NONE,
            ..Self::default()
        };
        match vertices.mesh {
            BodyMesh::Particles => Self { orientation: axes.determinant().signum(), ..data },
            BodyMesh::Welded(WeldedId { first_pair, vertex_count, .. }) => {
                Self { first_vertex: first_pair, first_fan: first_pair + vertex_count, ..data }
            }
            BodyMesh::Tube(TubeId { first_pair, ring_count, sides, radius, .. }) => {
                Self { first_vertex: first_pair, ring_count, sides, radius, ..data }
            }
        }
    }
}

/// In the place of the first vertex: each particle is a vertex.
const NONE: u32 = u32::MAX;

/// Writes the vertices of some bodies: surfaces in one dispatch, and tubes in another.
///
/// It needs no world, only its [`LastStep`], so that a renderer may have it on another thread.
#[derive(Debug)]
pub struct SurfaceWriter {
    gpu: Gpu,
    surfaces: GrowingBuffer,
    of_surfaces: VertexPass,
    of_tubes: VertexPass,
    /// The places of the bodies, as `surfaces` has them.
    places: Option<Places>,
    /// Pairs of words of the world, and its positions before and after its last step.
    read: Option<[wgpu::Buffer; 3]>,
}

/// A kernel, and a list that tells its workgroups what to do.
#[derive(Debug)]
struct VertexPass {
    kernel: ListKernel<6>,
    shares: GrowingBuffer,
    count: u32,
}

impl VertexPass {
    fn new(gpu: &Gpu, kernel: ListKernel<6>) -> Self {
        Self { kernel, shares: GrowingBuffer::new(gpu, "shares of vertices"), count: 0 }
    }

    /// Writes the list: a surface for each workgroup, and the first of its vertices there. The first entry is left for
    /// [`write_fraction`](Self::write_fraction).
    fn write(&mut self, gpu: &Gpu, shares: &[[u32; 2]]) -> Result<(), GpuError> {
        self.shares.reserve(gpu, 8 * shares.len() as u64)?;
        self.shares.write(gpu, 0, bytemuck::cast_slice(shares));
        self.count = shares.len() as u32 - 1;
        Ok(())
    }

    /// Writes the first entry of the list.
    fn write_fraction(&self, gpu: &Gpu, fraction: f32) {
        if self.count > 0 {
            self.shares.write(gpu, 0, bytemuck::bytes_of(&[self.count, fraction.to_bits()]));
        }
    }
}

impl SurfaceWriter {
    /// A writer of no bodies.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            gpu: gpu.clone(),
            surfaces: GrowingBuffer::new(gpu, "surfaces"),
            of_surfaces: VertexPass::new(gpu, ListKernel::of_surfaces(gpu)),
            of_tubes: VertexPass::new(gpu, ListKernel::of_tubes(gpu)),
            places: None,
            read: None,
        }
    }

    /// Sets the bodies to write once the [step](Self::set_step) is set too. Those that were added after `step`, or lack particles of their vertices, or
    /// have another number of vertices than there is room for, are left out.
    ///
    /// # Errors
    /// [`GpuError::Limit`] if the device has no room. Nothing is written then.
    pub fn set_bodies(&mut self, step: &LastStep, bodies: &[BodyVertices]) -> Result<(), GpuError> {
        (self.places, self.read) = (None, None);
        let (mut surface_shares, mut tube_shares) = (vec![[0; 2]], vec![[0; 2]]);
        let mut surfaces = Vec::new();
        for vertices in bodies {
            let Some(place) = step.place_of(vertices.body) else { continue };
            if vertices.mesh.vertex_count(place.particle_count) != Some(vertices.vertex_count) {
                continue;
            }
            let number = surfaces.len() as u32;
            if matches!(vertices.mesh, BodyMesh::Tube(_)) {
                tube_shares.push([number, 0]);
            } else {
                let firsts = (0..vertices.vertex_count).step_by(LIST_WORKGROUP as usize);
                surface_shares.extend(firsts.map(|first| [number, first]));
            }
            surfaces.push(SurfaceData::new(place, vertices));
        }
        let data: &[u8] = bytemuck::cast_slice(&surfaces);
        self.surfaces.reserve(&self.gpu, data.len() as u64)?;
        self.surfaces.write(&self.gpu, 0, data);
        self.of_surfaces.write(&self.gpu, &surface_shares)?;
        self.of_tubes.write(&self.gpu, &tube_shares)?;
        self.places = Some(Arc::clone(&step.places));
        Ok(())
    }

    /// Has the bodies written as they were at this fraction of a step: from 0, the state before it, to 1, that after it. False, and nothing is written, if
    /// they have to be [set](Self::set_bodies) first: for the first time, because that failed, or because bodies have come or gone since.
    pub fn set_step(&mut self, step: &LastStep, fraction: f32) -> bool {
        let is_known = self.places.as_ref().is_some_and(|places| Arc::ptr_eq(places, &step.places));
        self.read = is_known.then(|| step.read.clone());
        if is_known {
            self.of_surfaces.write_fraction(&self.gpu, fraction);
            self.of_tubes.write_fraction(&self.gpu, fraction);
        }
        is_known
    }

    /// Writes the vertices into `target` when the encoder's commands run. Words beyond its end are not written.
    ///
    /// # Panics
    /// By wgpu, if `target` may not be used as storage, or is larger than the device lets a shader see.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::Buffer) {
        let Some([pairs, before, after]) = &self.read else { return };
        for pass in [&self.of_surfaces, &self.of_tubes] {
            if pass.count > 0 {
                let bound = [pass.shares.get(), self.surfaces.get(), pairs, before, after, target];
                pass.kernel.encode(&self.gpu, encoder, bound, pass.count);
            }
        }
    }
}
