//! Lists the bodies that a frame shows.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::Mat3;
use bevy::prelude::*;
use drape_gpu::{BodyMesh, Gpu, GpuBodyId, GpuWorld, LastStep};

use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::{GpuBody, GpuVertices};
use crate::render::any_mesh::{AnyMesh, handle_of};
use crate::render::rope_mesh::RopeSurface;
use crate::render::surface::{EntitySpace, Surface};
use crate::render::write_surfaces::InterpolateSurfaces;
use crate::transform::interpolation::step_fraction;

/// A body, and the mesh that shows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShownBody {
    entity: Entity,
    pub body: GpuBodyId,
    /// How its vertices lie on its particles.
    pub vertices: BodyMesh,
    pub mesh: AssetId<Mesh>,
    /// Turns directions of the world into those of the entity.
    pub to_local: Mat3,
    /// Where the entity is.
    pub origin: Vec3,
}

/// The bodies on the GPU that a frame shows. The renderer takes them.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct ShownBodies {
    /// The same list from frame to frame, until one of them changes.
    pub bodies: Arc<Vec<ShownBody>>,
    /// The device and its last step; none if there is nothing to show.
    pub step: Option<(Gpu, LastStep)>,
    /// From 0, before the step, to 1, after it.
    pub fraction: f32,
}

/// The components that decide how a body is shown.
#[derive(QueryData)]
pub(crate) struct Looks {
    entity: Entity,
    body: &'static GpuBody,
    vertices: Option<&'static GpuVertices>,
    surface: Option<&'static Surface>,
    rope: Option<&'static RopeSurface>,
    mesh: AnyMesh,
    transform: &'static GlobalTransform,
    visibility: Option<&'static InheritedVisibility>,
}

impl LooksItem<'_, '_> {
    /// The body as it is to be shown; none if it is not.
    fn shown(self) -> Option<ShownBody> {
        let vertices = self.vertices.map(|vertices| vertices.0);
        let written = match (self.surface, self.rope) {
            (Some(surface), _) => surface.mesh,
            // Once the GPU knows its tube.
            (None, rope) => rope.filter(|_| vertices.is_some())?.mesh,
        };
        let mesh = handle_of(self.mesh).filter(|mesh| mesh.id() == written)?;
        self.visibility.is_none_or(|visibility| visibility.get()).then_some(())?;
        Some(ShownBody {
            entity: self.entity,
            body: self.body.id(),
            vertices: vertices.unwrap_or_default(),
            mesh: mesh.id(),
            to_local: EntitySpace::new(self.transform)?.to_local(),
            origin: self.transform.translation(),
        })
    }
}

/// Any of the [components](Looks) has changed.
type LooksChanged = Or<(
    Changed<GpuBody>,
    Changed<GpuVertices>,
    Changed<Surface>,
    Changed<RopeSurface>,
    Changed<Mesh3d>,
    Changed<Mesh2d>,
    Changed<GlobalTransform>,
    Changed<InheritedVisibility>,
)>;

/// Entities that have lost one of the [components](Looks).
#[derive(SystemParam)]
pub(crate) struct LooksLost<'w, 's> {
    body: RemovedComponents<'w, 's, GpuBody>,
    vertices: RemovedComponents<'w, 's, GpuVertices>,
    surface: RemovedComponents<'w, 's, Surface>,
    rope: RemovedComponents<'w, 's, RopeSurface>,
    solid: RemovedComponents<'w, 's, Mesh3d>,
    flat: RemovedComponents<'w, 's, Mesh2d>,
}

impl LooksLost<'_, '_> {
    fn read(&mut self) -> impl Iterator<Item = Entity> {
        let Self { body, vertices, surface, rope, solid, flat } = self;
        let of_mesh = solid.read().chain(flat.read());
        body.read().chain(vertices.read()).chain(surface.read()).chain(rope.read()).chain(of_mesh)
    }
}

/// Lists the bodies that this frame shows, after all transforms have been propagated. Takes time for those that have changed only.
pub(crate) fn list_shown(
    all: Query<Looks>,
    changed: Query<Entity, (With<GpuBody>, LooksChanged)>,
    mut lost: LooksLost,
    bodies: Res<GpuBodies>,
    interpolate: Res<InterpolateSurfaces>,
    time: Option<Res<Time<Fixed>>>,
    mut shown: ResMut<ShownBodies>,
    mut places: Local<EntityHashMap<usize>>,
) {
    let ShownBodies { bodies: list, step, fraction } = &mut *shown;
    for entity in changed.iter().chain(lost.read()) {
        let known = places.get(&entity).copied();
        match (known, all.get(entity).ok().and_then(LooksItem::shown)) {
            (Some(place), Some(body)) => Arc::make_mut(list)[place] = body,
            (None, Some(body)) => {
                places.insert(entity, list.len());
                Arc::make_mut(list).push(body);
            }
            (Some(place), None) => {
                places.remove(&entity);
                Arc::make_mut(list).swap_remove(place);
                if let Some(moved) = list.get(place) {
                    places.insert(moved.entity, place);
                }
            }
            (None, None) => {}
        }
    }
    *step = bodies.world().and_then(|world| Some((world.gpu().clone(), world.last_step().ok()?)));
    let is_resting = bodies.world().is_none_or(GpuWorld::is_resting);
    let is_between = interpolate.0 && bodies.is_moving && !is_resting;
    *fraction = if is_between { step_fraction(time.as_deref()) } else { 1.0 };
}
