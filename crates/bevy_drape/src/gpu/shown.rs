//! Lists the bodies that a frame shows.

use std::sync::Arc;

use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::Mat3;
use bevy::prelude::*;
use drape_gpu::{BodyMesh, Gpu, GpuBodyId, GpuWorld, LastStep};

use crate::body::activity::Activity;
use crate::body::on_gpu::OnGpu;
use crate::gpu::bodies::GpuBodies;
use crate::gpu::components::{GpuBody, GpuVertices};
use crate::render::any_mesh::{AnyMesh, handle_of};
use crate::render::entity_space::EntitySpace;
use crate::render::rope_mesh::RopeSurface;
use crate::render::surface::Surface;
use crate::transform::interpolation::{ShowsBetweenSteps, step_fraction};

/// A body, and the mesh that shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShownBody {
    entity: Entity,
    pub body: GpuBodyId,
    /// The way in which its vertices lie on its particles.
    pub vertices: BodyMesh,
    pub mesh: AssetId<Mesh>,
    /// Turns directions of the world into those of the entity.
    pub to_local: Mat3,
    /// The place of the entity.
    pub origin: Vec3,
}

/// The bodies on the GPU that a frame shows. The renderer takes them.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct ShownBodies {
    /// The same list from frame to frame, until one of them changes: then it is copied, as the renderer has it too.
    pub bodies: Arc<Vec<ShownBody>>,
    /// The device and its last step; none if there is nothing to show.
    pub step: Option<(Gpu, LastStep)>,
    /// From 0, before the step, to 1, after it.
    pub fraction: f32,
}

/// The components that decide how a body is shown.
#[derive(QueryData)]
pub(crate) struct ShownParts {
    entity: Entity,
    body: &'static GpuBody,
    parts: &'static OnGpu,
    activity: &'static Activity,
    vertices: Option<&'static GpuVertices>,
    surface: Option<&'static Surface>,
    rope: Option<&'static RopeSurface>,
    mesh: AnyMesh,
    transform: &'static GlobalTransform,
    visibility: Option<&'static InheritedVisibility>,
}

impl ShownPartsItem<'_, '_> {
    /// The body as it is to be shown; none if it is not.
    fn shown(self) -> Option<ShownBody> {
        let vertices = self.vertices.map(|vertices| vertices.0).unwrap_or_default();
        let written = match vertices {
            BodyMesh::Tube(_) => self.rope?.mesh,
            BodyMesh::Particles | BodyMesh::Welded(_) => self.surface?.mesh,
        };
        let mesh = handle_of(self.mesh).filter(|mesh| mesh.id() == written)?;
        self.visibility.is_none_or(|visibility| visibility.get()).then_some(())?;
        let transform = self.parts.seen_from(*self.activity, self.transform);
        Some(ShownBody {
            entity: self.entity,
            body: self.body.id(),
            vertices,
            mesh: mesh.id(),
            to_local: EntitySpace::new(&transform)?.to_local(),
            origin: transform.translation(),
        })
    }
}

/// Any of the [components](ShownParts) has changed.
type ShownChanged = Or<(
    Changed<GpuBody>,
    Changed<Activity>,
    Changed<GpuVertices>,
    Changed<Surface>,
    Changed<RopeSurface>,
    Changed<Mesh3d>,
    Changed<Mesh2d>,
    Changed<GlobalTransform>,
    Changed<InheritedVisibility>,
)>;

/// Entities that have lost one of the [components](ShownParts).
#[derive(SystemParam)]
pub(crate) struct ShownRemoved<'w, 's> {
    body: RemovedComponents<'w, 's, GpuBody>,
    vertices: RemovedComponents<'w, 's, GpuVertices>,
    surface: RemovedComponents<'w, 's, Surface>,
    rope: RemovedComponents<'w, 's, RopeSurface>,
    solid: RemovedComponents<'w, 's, Mesh3d>,
    flat: RemovedComponents<'w, 's, Mesh2d>,
}

impl ShownRemoved<'_, '_> {
    fn read(&mut self) -> impl Iterator<Item = Entity> {
        let Self { body, vertices, surface, rope, solid, flat } = self;
        let of_mesh = solid.read().chain(flat.read());
        body.read().chain(vertices.read()).chain(surface.read()).chain(rope.read()).chain(of_mesh)
    }
}

/// Lists the bodies that this frame shows, after all transforms have been propagated. While nothing changes the list stays the same one.
pub(crate) fn list_shown(
    all: Query<ShownParts, Allow<Disabled>>,
    changed: Query<Entity, (With<GpuBody>, ShownChanged, Allow<Disabled>)>,
    mut lost: ShownRemoved,
    bodies: Res<GpuBodies>,
    between: Res<ShowsBetweenSteps>,
    time: Option<Res<Time<Fixed>>>,
    mut shown: ResMut<ShownBodies>,
    mut places: Local<EntityHashMap<usize>>,
) {
    let ShownBodies { bodies: list, step, fraction } = &mut *shown;
    for entity in changed.iter().chain(lost.read()) {
        let known = places.get(&entity).copied();
        match (known, all.get(entity).ok().and_then(ShownPartsItem::shown)) {
            (Some(place), Some(body)) if list[place] == body => {}
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
    let is_between = between.0 && bodies.is_moving && !is_resting;
    *fraction = if is_between { step_fraction(time.as_deref()) } else { 1.0 };
}
