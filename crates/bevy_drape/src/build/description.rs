//! Descriptions of bodies, and the bodies that are built from them.

use std::sync::Arc;

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::world::extent::Extent;
use drape_solver::{BuildError, Topology};

use crate::body::activity::Activity;
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::particles::{Particles, Sticks};
use crate::change_detection::collect_changed;
use crate::refusal::Refusals;

/// A component that describes a body.
pub(crate) trait Description: Component {
    /// What it is called in the log.
    const NAME: &'static str;

    /// The particles and topology of the body at `transform`.
    fn build(
        &self,
        transform: &GlobalTransform,
    ) -> Result<(drape_solver::Particles, Arc<Topology>), BuildError>;
}

/// Builds what was inserted or changed since the last step, and what could not be built where it was and has moved.
pub(crate) fn build_described<D: Description>(
    mut commands: Commands,
    described: Query<(Entity, Ref<D>)>,
    not_built: Query<(Entity, Ref<GlobalTransform>), (With<D>, Without<Particles>)>,
    descriptions: Query<(&D, &GlobalTransform)>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
    mut to_build: Local<Vec<Entity>>,
) {
    collect_changed(&described, &mut to_build);
    let is_listed = |entity: Entity| described.get(entity).is_ok_and(|(_, described)| described.is_changed());
    let listed = to_build.len();
    collect_changed(&not_built, &mut to_build);
    let mut row = 0;
    to_build.retain(|&entity| {
        row += 1;
        row <= listed || !is_listed(entity)
    });
    for entity in to_build.drain(..) {
        let Ok((description, transform)) = descriptions.get(entity) else { continue };
        let built = if transform.affine().is_finite() {
            description.build(transform).map_err(|error| (D::NAME, error.to_string()))
        } else {
            Err(("Transform", "it must be finite".to_string()))
        };
        match built {
            Ok(parts) => {
                refusals.forget(entity);
                insert_body(&mut commands, entity, order.next(), transform, parts);
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
    (particles, topology): (drape_solver::Particles, Arc<Topology>),
) {
    let anchor = transform.affine();
    let pins = pins_at(&anchor, &particles);
    let state = BodyState {
        order,
        anchor,
        rest: anchor,
        pins,
        extent: Extent::of(&particles, &topology),
        ..default()
    };
    commands.entity(entity).insert((Particles(particles), Sticks(topology), Activity::Active, state));
}

/// The pinned particles, and their places in the coordinates of an entity at `anchor`.
pub(crate) fn pins_at(anchor: &Affine3A, particles: &drape_solver::Particles) -> Vec<(u32, Vec3)> {
    let to_local = anchor.inverse();
    let pinned = (0..particles.len()).filter(|&i| particles.is_pinned(i));
    pinned.map(|i| (i as u32, to_local.transform_point3(particles.position(i)))).collect()
}

/// Takes off an entity what [`insert_body`] put there.
pub(crate) fn remove_body(commands: &mut Commands, entity: Entity) {
    commands.entity(entity).try_remove::<(Particles, Sticks, Activity, BodyState)>();
}

/// Takes the body off an entity that loses its `C`, the description it was built from.
pub(crate) fn remove_described_body<C: Component>(removed: On<Remove, C>, mut commands: Commands) {
    remove_body(&mut commands, removed.entity);
}
