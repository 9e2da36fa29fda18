//! Builds bodies from their descriptions: inserts particles, sticks, activity and state as components.

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::system::SystemParam;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::BuildError;
use drape_solver::world::extent::Extent;

use crate::body::activity::Activity;
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::fabric::Fabric;
use crate::body::on_gpu::OnGpu;
use crate::body::particles::{BodyParts, Particles, Sticks};
use crate::build::built::BodyBuilt;
use crate::change_detection::{collect_changed, retain_from};
use crate::refusal::{Cause, Refusals};

/// Entities with a `D` whose fabric may have changed.
#[derive(SystemParam)]
pub(crate) struct ChangedFabrics<'w, 's, D: Component> {
    fabrics: Query<'w, 's, (Entity, Ref<'static, Fabric>), With<D>>,
    bodies: Query<'w, 's, AnyOf<(&'static BodyState, &'static OnGpu)>>,
}

impl<D: Component> ChangedFabrics<'_, '_, D> {
    /// Appends to `found` the entities whose fabric was changed since the last step so that they need other sticks, and those that
    /// have no body yet.
    pub fn collect(&self, found: &mut Vec<Entity>) {
        let first = found.len();
        collect_changed(&self.fabrics, found);
        let is_other = |entity: Entity| {
            let wanted = self.fabrics.get(entity).ok().map(|(_, fabric)| fabric.material());
            let body = self.bodies.get(entity).ok();
            let state = body.and_then(|(here, on_gpu)| here.or(on_gpu.map(|on_gpu| &on_gpu.state)));
            state.is_none_or(|state| state.material != wanted)
        };
        retain_from(found, first, is_other);
    }
}

/// A component that describes a body.
pub(crate) trait Description: Component {
    /// Name in the log.
    const NAME: &'static str;

    /// Builds the particles and topology of the body at `transform`; `fabric` matters to cloths only.
    fn build(&self, fabric: &Fabric, transform: &GlobalTransform) -> Result<BodyParts, BuildError>;
}

/// Builds bodies whose description was inserted or changed since the last step, those whose fabric asks for other sticks, and
/// refused ones that have moved.
pub(crate) fn build_described<D: Description>(
    mut commands: Commands,
    described: Query<(Entity, Ref<D>)>,
    not_built: Query<(Entity, Ref<GlobalTransform>), (With<D>, Without<Particles>, Without<OnGpu>)>,
    fabrics: ChangedFabrics<D>,
    descriptions: Query<(&D, Option<&Fabric>, &GlobalTransform)>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
    mut to_build: Local<Vec<Entity>>,
) {
    collect_changed(&described, &mut to_build);
    let is_listed = |entity: Entity| described.get(entity).is_ok_and(|(_, described)| described.is_changed());
    let listed = to_build.len();
    collect_changed(&not_built, &mut to_build);
    fabrics.collect(&mut to_build);
    let mut seen = EntityHashSet::default();
    retain_from(&mut to_build, listed, |entity| !is_listed(entity) && seen.insert(entity));
    for entity in to_build.drain(..) {
        let Ok((description, fabric, transform)) = descriptions.get(entity) else { continue };
        let built = if transform.affine().is_finite() {
            description
                .build(&fabric.copied().unwrap_or_default(), transform)
                .map_err(|error| (Fabric::or_description(fabric, Some(&error), D::NAME), Cause::from(error)))
        } else {
            Err(("Transform", "it must be finite".into()))
        };
        match built {
            Ok(parts) => {
                refusals.forget(entity);
                insert_body(&mut commands, entity, order.next(), transform, parts, fabric);
            }
            Err((component, reason)) => {
                refusals.entity(entity, component, reason);
                remove_body(&mut commands, entity);
            }
        }
    }
}

/// Puts a newly built body on an entity.
pub(crate) fn insert_body(
    commands: &mut Commands,
    entity: Entity,
    order: u64,
    transform: &GlobalTransform,
    (particles, topology): BodyParts,
    fabric: Option<&Fabric>,
) {
    let anchor = transform.affine();
    let pins = pins_at(&anchor, &particles);
    let state = BodyState {
        order,
        anchor,
        rest: anchor,
        pins,
        material: fabric.map(Fabric::material),
        extent: Extent::of(&particles, &topology),
        ..default()
    };
    commands.entity(entity).insert((Particles(particles), Sticks(topology), Activity::Active, state));
    commands.write_message(BodyBuilt { body: entity });
}

/// Returns the pinned particles and their positions in the coordinates of an entity at `anchor`.
pub(crate) fn pins_at(anchor: &Affine3A, particles: &drape_solver::Particles) -> Vec<(u32, Vec3)> {
    let to_local = anchor.inverse();
    let pinned = (0..particles.len()).filter(|&i| particles.is_pinned(i));
    pinned.map(|i| (i as u32, to_local.transform_point3(particles.position(i)))).collect()
}

/// Removes everything that [`insert_body`] inserts, and what it becomes on the GPU.
pub(crate) fn remove_body(commands: &mut Commands, entity: Entity) {
    commands.entity(entity).try_remove::<(Particles, Sticks, Activity, BodyState, OnGpu)>();
}

/// Removes the body from an entity that loses its description `C`.
pub(crate) fn remove_described_body<C: Component>(removed: On<Remove<C>>, mut commands: Commands) {
    remove_body(&mut commands, removed.entity);
}
