//! Writes bodies into the vertex buffers of Bevy's renderer, before anything is drawn from them: depth, shadows and colours see the same.
//!
//! Bevy keeps the vertices of many meshes in one large buffer, a slab. One dispatch writes all bodies of a slab.

use std::sync::Arc;

use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::mesh::RenderMesh;
use bevy::render::mesh::allocator::{MeshAllocator, MeshAllocatorSettings};
use bevy::render::render_asset::{ExtractedAssets, RenderAssets};
use bevy::render::render_resource::{Buffer, BufferUsages};
use bevy::render::renderer::{RenderContext, RenderDevice};
use drape_gpu::{BodyVertices, LastStep, SurfaceWriter};

use crate::gpu::shown::{ShownBodies, ShownBody};

/// Lets shaders write to the buffers that meshes are drawn from, on a device that has such shaders.
pub(crate) fn allow_writing(device: Res<RenderDevice>, mut settings: ResMut<MeshAllocatorSettings>) {
    if device.limits().max_storage_buffers_per_shader_stage > 0 {
        settings.extra_buffer_usages |= BufferUsages::STORAGE;
    }
}

/// Takes what the main world has listed.
pub(crate) fn take_shown(listed: Extract<Option<Res<ShownBodies>>>, mut shown: ResMut<ShownBodies>) {
    if let Some(listed) = &*listed {
        shown.clone_from(listed);
    }
}

/// A slab, and the bodies in it.
struct Slab {
    buffer: Buffer,
    bodies: Vec<BodyVertices>,
}

/// The place of a mesh's vertices.
#[derive(Clone, Copy)]
struct MeshPlace {
    mesh: AssetId<Mesh>,
    /// Among the slabs.
    slab: usize,
    vertex_count: u32,
    /// Words of the slab before the first position and the first normal, and from one vertex to the next.
    first_position: u32,
    first_normal: u32,
    stride: u32,
}

impl MeshPlace {
    /// The vertices of a body there.
    fn vertices(&self, body: &ShownBody) -> BodyVertices {
        BodyVertices {
            body: body.body,
            mesh: body.vertices,
            to_local: body.to_local,
            origin: body.origin,
            vertex_count: self.vertex_count,
            first_position: self.first_position,
            first_normal: self.first_normal,
            stride: self.stride,
        }
    }
}

/// The slabs with bodies, and a writer for each.
#[derive(Resource, Default)]
pub(crate) struct SlabWriters {
    slabs: Vec<Slab>,
    writers: Vec<SurfaceWriter>,
    /// Of the bodies in the last list, in its order: to look a mesh up takes longer than all else.
    places: Vec<Option<MeshPlace>>,
    /// The list that the places are of.
    last: Option<Arc<Vec<ShownBody>>>,
    /// True if some places were not found: those are looked for in each frame.
    has_gaps: bool,
}

impl SlabWriters {
    /// Looks up the meshes of bodies that are new in the list, and those that were not found before. True if the writers need another list.
    fn find_places(
        &mut self,
        shown: &ShownBodies,
        step: &LastStep,
        allocator: &MeshAllocator,
        meshes: &RenderAssets<RenderMesh>,
    ) -> bool {
        let is_same = self.last.as_ref().is_some_and(|last| Arc::ptr_eq(last, &shown.bodies));
        if is_same && !self.has_gaps {
            return false;
        }
        let mut is_new = !is_same;
        self.has_gaps = false;
        self.places.resize(shown.bodies.len(), None);
        for (body, place) in shown.bodies.iter().zip(&mut self.places) {
            if place.is_some_and(|place| place.mesh == body.mesh) {
                continue;
            }
            *place = find(body, step, allocator, meshes, &mut self.slabs);
            is_new |= place.is_some();
            self.has_gaps |= place.is_none();
        }
        self.last = Some(Arc::clone(&shown.bodies));
        is_new
    }
}

/// Forgets what belongs to a device that was lost.
pub(crate) fn forget_device(mut writers: ResMut<SlabWriters>, mut shown: ResMut<ShownBodies>) {
    *writers = SlabWriters::default();
    *shown = ShownBodies::default();
}

/// Forgets where meshes lie if one is about to be uploaded or freed: others may move then.
pub(crate) fn note_moved_meshes(meshes: Res<ExtractedAssets<RenderMesh>>, mut writers: ResMut<SlabWriters>) {
    if !meshes.extracted.is_empty() || !meshes.removed.is_empty() {
        let SlabWriters { slabs, places, last, .. } = &mut *writers;
        slabs.clear();
        places.clear();
        *last = None;
    }
}

/// Writes positions and normals of all shown bodies.
pub(crate) fn write_slabs(
    mut context: RenderContext,
    shown: Res<ShownBodies>,
    allocator: Res<MeshAllocator>,
    meshes: Res<RenderAssets<RenderMesh>>,
    device: Res<RenderDevice>,
    mut writers: ResMut<SlabWriters>,
) {
    let Some((gpu, step)) = &shown.step else { return };
    let is_new = writers.find_places(&shown, step, &allocator, &meshes);
    let SlabWriters { slabs, writers, places, .. } = &mut *writers;
    let mut used = writers.iter_mut().take(slabs.len());
    if is_new || !used.all(|writer| writer.set_step(step, shown.fraction)) {
        slabs.iter_mut().for_each(|slab| slab.bodies.clear());
        for (body, place) in shown.bodies.iter().zip(&*places) {
            let Some(place) = place else { continue };
            slabs[place.slab].bodies.push(place.vertices(body));
        }
        while writers.len() < slabs.len() {
            writers.push(SurfaceWriter::new(gpu));
        }
        for (Slab { bodies, .. }, writer) in slabs.iter().zip(&mut *writers) {
            match writer.set_bodies(step, bodies) {
                // It has bodies of this very step.
                Ok(()) => _ = writer.set_step(step, shown.fraction),
                Err(error) => warn_once!("bodies on the GPU are not shown: {error}"),
            }
        }
    }
    let limits = device.limits();
    for (Slab { buffer, .. }, writer) in slabs.iter().zip(writers) {
        if buffer.size() > limits.max_storage_buffer_binding_size {
            warn_once!("bodies on the GPU are not shown in meshes beyond maxStorageBufferBindingSize");
        } else {
            writer.encode(context.command_encoder(), buffer);
        }
    }
}

/// The place of a body's mesh, whose slab is added to `slabs` if it is not among them. None before the mesh is uploaded, and for one that cannot be
/// written.
fn find(
    body: &ShownBody,
    step: &LastStep,
    allocator: &MeshAllocator,
    meshes: &RenderAssets<RenderMesh>,
    slabs: &mut Vec<Slab>,
) -> Option<MeshPlace> {
    let (slice, mesh) = (allocator.mesh_vertex_slice(&body.mesh)?, meshes.get(body.mesh)?);
    let vertex_count = slice.range.len() as u32;
    if body.vertices.vertex_count(step.particle_count(body.body)?) != Some(vertex_count) {
        warn_once!("a mesh of a body on the GPU has more or fewer vertices than the body: it is not written");
        return None;
    }
    let layout = &mesh.layout.0;
    let offset = |attribute: MeshVertexAttribute| {
        let place = layout.attribute_ids().iter().position(|&id| id == attribute.id)?;
        let attribute = layout.layout().attributes.get(place)?;
        // Compressed ones are not.
        (attribute.format == VertexFormat::Float32x3).then_some((attribute.offset / WORD) as u32)
    };
    let stride = (layout.layout().array_stride / WORD) as u32;
    let first = slice.range.start * stride;
    let first_position = first + offset(Mesh::ATTRIBUTE_POSITION)?;
    let first_normal = first + offset(Mesh::ATTRIBUTE_NORMAL)?;
    let known = slabs.iter().rposition(|slab| slab.buffer.id() == slice.buffer.id());
    let slab = known.unwrap_or_else(|| {
        slabs.push(Slab { buffer: slice.buffer.clone(), bodies: Vec::new() });
        slabs.len() - 1
    });
    Some(MeshPlace { mesh: body.mesh, slab, vertex_count, first_position, first_normal, stride })
}

/// Bytes of what a shader writes at once. Strides and offsets of positions and normals are multiples of it.
const WORD: u64 = 4;
