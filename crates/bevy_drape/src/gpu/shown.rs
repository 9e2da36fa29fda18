//! Lists the bodies that a frame shows.

use bevy::math::Mat3;
use bevy::prelude::*;
use drape_gpu::{Gpu, GpuBodyId, GpuWorld, LastStep, WeldedId};

use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::{GpuBody, GpuVertices};
use crate::render::any_mesh::{AnyMesh, handle_of};
use crate::render::surface::{EntitySpace, Surface};
use crate::render::write_surfaces::InterpolateSurfaces;
use crate::transform::interpolation::step_fraction;

/// A body, and the mesh that shows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShownBody {
    pub body: GpuBodyId,
    /// The particles of its vertices; none if each particle is a vertex.
    pub welded: Option<WeldedId>,
    pub mesh: AssetId<Mesh>,
    /// Turns directions of the world into those of the entity.
    pub to_local: Mat3,
    /// Where the entity is.
    pub origin: Vec3,
}

/// The bodies on the GPU that a frame shows. The renderer takes them.
#[derive(Resource, Debug, Default)]
pub(crate) struct ShownBodies {
    pub bodies: Vec<ShownBody>,
    /// The device and its last step; none if there is nothing to show.
    pub step: Option<(Gpu, LastStep)>,
    /// From 0, before the step, to 1, after it.
    pub fraction: f32,
}

/// Lists the bodies that this frame shows, after all transforms have been propagated.
pub(crate) fn list_shown(
    on_gpu: Query<(
        &GpuBody,
        Option<&GpuVertices>,
        &Surface,
        AnyMesh,
        &GlobalTransform,
        Option<&InheritedVisibility>,
    )>,
    bodies: Res<GpuBodies>,
    interpolate: Res<InterpolateSurfaces>,
    time: Option<Res<Time<Fixed>>>,
    mut shown: ResMut<ShownBodies>,
) {
    let ShownBodies { bodies: list, step, fraction } = &mut *shown;
    list.clear();
    *step = bodies.world().and_then(|world| Some((world.gpu().clone(), world.last_step().ok()?)));
    let is_resting = bodies.world().is_none_or(GpuWorld::is_resting);
    let is_between = interpolate.0 && bodies.is_moving && !is_resting;
    *fraction = if is_between { step_fraction(time.as_deref()) } else { 1.0 };
    if step.is_none() {
        return;
    }
    for (body, vertices, surface, mesh, transform, visibility) in &on_gpu {
        let is_hidden = visibility.is_some_and(|visibility| !visibility.get());
        let Some(mesh) = handle_of(mesh).filter(|mesh| !is_hidden && mesh.id() == surface.mesh) else {
            continue;
        };
        let Some(space) = EntitySpace::new(transform) else { continue };
        list.push(ShownBody {
            body: body.id(),
            welded: vertices.map(|vertices| vertices.0),
            mesh: mesh.id(),
            to_local: space.to_local(),
            origin: transform.translation(),
        });
    }
}
