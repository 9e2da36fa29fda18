//! Writes bodies into the vertex buffers of Bevy's renderer, before anything is drawn from them: depth, shadows and colours see the same.
//!
//! Bevy keeps the vertices of many meshes in one large buffer, a slab. One dispatch writes all bodies of a slab.

use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::prelude::*;
use bevy::render::MainWorld;
use bevy::render::mesh::RenderMesh;
use bevy::render::mesh::allocator::{MeshAllocator, MeshAllocatorSettings};
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{Buffer, BufferUsages};
use bevy::render::renderer::{RenderContext, RenderDevice};
use drape_gpu::{BodyVertices, SurfaceWriter};

use crate::gpu::shown::{ShownBodies, ShownBody};

/// Lets shaders write to the buffers that meshes are drawn from, on a device that has such shaders.
pub(crate) fn allow_writing(device: Res<RenderDevice>, mut settings: ResMut<MeshAllocatorSettings>) {
    if device.limits().max_storage_buffers_per_shader_stage > 0 {
        settings.extra_buffer_usages |= BufferUsages::STORAGE;
    }
}

/// Takes what the main world has listed, and leaves it the memory of the last list.
pub(crate) fn take_shown(mut main: ResMut<MainWorld>, mut shown: ResMut<ShownBodies>) {
    if let Some(mut listed) = main.get_resource_mut::<ShownBodies>() {
        core::mem::swap(&mut *listed, &mut *shown);
    }
}

/// A slab, and the bodies in it.
struct Slab {
    buffer: Buffer,
    bodies: Vec<BodyVertices>,
}

/// The slabs of this frame, and a writer for each.
#[derive(Resource, Default)]
pub(crate) struct SlabWriters {
    slabs: Vec<Slab>,
    writers: Vec<SurfaceWriter>,
}

/// Forgets what belongs to a device that was lost.
pub(crate) fn forget_device(mut writers: ResMut<SlabWriters>, mut shown: ResMut<ShownBodies>) {
    *writers = SlabWriters::default();
    *shown = ShownBodies::default();
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
    let SlabWriters { slabs, writers } = &mut *writers;
    slabs.clear();
    for body in &shown.bodies {
        // Neither is there before the mesh is uploaded.
        let (Some(slice), Some(mesh)) = (allocator.mesh_vertex_slice(&body.mesh), meshes.get(body.mesh))
        else {
            continue;
        };
        let vertices = vertices_of(mesh, slice.range.start, body, shown.fraction);
        let count =
            body.welded.map_or_else(|| step.particle_count(body.body), |welded| Some(welded.vertex_count()));
        let (Some(vertices), Some(count)) = (vertices, count) else { continue };
        if slice.range.len() != count as usize {
            warn_once!(
                "a mesh of a body on the GPU has more or fewer vertices than the body: it is not written"
            );
            continue;
        }
        match slabs.iter_mut().rfind(|slab| slab.buffer.id() == slice.buffer.id()) {
            Some(slab) => slab.bodies.push(vertices),
            None => slabs.push(Slab { buffer: slice.buffer.clone(), bodies: vec![vertices] }),
        }
    }
    let limits = device.limits();
    for (i, Slab { buffer, bodies }) in slabs.iter().enumerate() {
        if buffer.size() > limits.max_storage_buffer_binding_size {
            warn_once!("bodies on the GPU are not shown in meshes beyond maxStorageBufferBindingSize");
            continue;
        }
        if i == writers.len() {
            writers.push(SurfaceWriter::new(gpu));
        }
        match writers[i].set_bodies(step, bodies) {
            Ok(()) => writers[i].encode(context.command_encoder(), buffer),
            Err(error) => warn_once!("bodies on the GPU are not shown: {error}"),
        }
    }
}

/// The place of a body's vertices in a slab where its mesh begins at vertex `first`; none if the mesh lacks positions or normals, or has them
/// compressed.
fn vertices_of(mesh: &RenderMesh, first: u32, body: &ShownBody, fraction: f32) -> Option<BodyVertices> {
    let layout = &mesh.layout.0;
    let offset = |attribute: MeshVertexAttribute| {
        let place = layout.attribute_ids().iter().position(|&id| id == attribute.id)?;
        let attribute = layout.layout().attributes.get(place)?;
        (attribute.format == VertexFormat::Float32x3).then_some((attribute.offset / WORD) as u32)
    };
    let stride = (layout.layout().array_stride / WORD) as u32;
    let ShownBody { body, welded, to_local, origin, .. } = *body;
    Some(BodyVertices {
        body,
        welded,
        to_local,
        origin,
        fraction,
        first_position: first * stride + offset(Mesh::ATTRIBUTE_POSITION)?,
        first_normal: first * stride + offset(Mesh::ATTRIBUTE_NORMAL)?,
        stride,
    })
}

/// Bytes of what a shader writes at once. Strides and offsets of positions and normals are multiples of it.
const WORD: u64 = 4;
