//! Resources: clock, gravity, wind, settings.

use bevy::ecs::component::Mutable;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryFilter};
use bevy::prelude::*;

use crate::ball::projectile::ProjectileRecord;
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::on_gpu::OnGpu;
use crate::body::settings::DefaultSolverSettings;
use crate::body::surface::DefaultBodySurface;
use crate::clock::DrapeClock;
use crate::contact::events::DrapeContactSettings;
use crate::environment::gravity::DrapeGravity;
use crate::environment::obstacle::Obstacle;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wind::Wind;
use crate::rig::components::Rig;
use crate::sleep::scene_manager::SceneManager;
use crate::snapshot::key::{Key, Keys, SnapshotError};
use crate::transform::interpolation::InterpolationState;

/// Resources of the simulation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct WorldSnapshot {
    pub clock: DrapeClock,
    gravity: DrapeGravity,
    wind: Wind,
    default_settings: DefaultSolverSettings,
    default_surface: DefaultBodySurface,
    manager: SceneManager,
    contact_settings: DrapeContactSettings,
    /// Values that the last step used.
    seen_gravity: [f32; 3],
    seen_wind: Wind,
    is_changed: bool,
    creation_order: u64,
}

pub(super) fn take(world: &World) -> WorldSnapshot {
    let solver = world.resource::<SolverEnvironment>();
    WorldSnapshot {
        clock: world.resource::<DrapeClock>().clone(),
        gravity: *world.resource(),
        wind: *world.resource(),
        default_settings: *world.resource(),
        default_surface: *world.resource(),
        manager: *world.resource(),
        contact_settings: *world.resource(),
        seen_gravity: solver.environment.gravity.to_array(),
        seen_wind: solver.environment.wind.into(),
        is_changed: solver.changed,
        creation_order: world.resource::<CreationOrder>().last(),
    }
}

pub(super) fn check(snapshot: &WorldSnapshot, world: &World) -> Result<(), SnapshotError> {
    let is_stepped = |clock: &DrapeClock| clock.steps() > 0;
    if !world.get_resource().is_some_and(is_stepped) || !is_stepped(&snapshot.clock) {
        return Err(SnapshotError::NotStepped);
    }
    if !DrapeGravity(snapshot.seen_gravity.into()).is_usable() {
        return Err(SnapshotError::BadWorld("gravity"));
    }
    if drape_solver::Wind::from(snapshot.seen_wind).validate().is_err() {
        return Err(SnapshotError::BadWorld("the wind"));
    }
    let is_time = snapshot.clock.elapsed().is_finite() && snapshot.clock.delta().is_finite();
    if is_time { Ok(()) } else { Err(SnapshotError::BadWorld("the clock")) }
}

pub(super) fn restore(snapshot: &WorldSnapshot, world: &mut World) {
    put(world, snapshot.clock.clone());
    put(world, snapshot.gravity);
    put(world, snapshot.wind);
    put(world, snapshot.default_settings);
    put(world, snapshot.default_surface);
    put(world, snapshot.manager);
    put(world, snapshot.contact_settings);
    let mut solver = world.resource_mut::<SolverEnvironment>();
    solver.environment.dt = snapshot.clock.delta();
    solver.environment.gravity = snapshot.seen_gravity.into();
    solver.environment.wind = snapshot.seen_wind.into();
    solver.changed = snapshot.is_changed;
}

/// Continues the order of creation as it was, after all that is left in the world.
pub(super) fn go_on_counting(snapshot: &WorldSnapshot, world: &mut World) {
    let mut bodies = world.query_filtered::<&BodyState, Allow<Disabled>>();
    let mut on_gpu = world.query_filtered::<&OnGpu, Allow<Disabled>>();
    let mut balls = world.query_filtered::<&ProjectileRecord, Allow<Disabled>>();
    let bodies = bodies.iter(world).chain(on_gpu.iter(world).map(|body| &body.state));
    let numbers = bodies.map(|state| state.order).chain(balls.iter(world).map(|record| record.order));
    let last = numbers.fold(snapshot.creation_order, u64::max);
    world.resource_mut::<CreationOrder>().go_on_from(last);
}

/// Sets a resource only if it differs, since a change wakes everything.
fn put<R: Resource<Mutability = Mutable> + PartialEq>(world: &mut World, value: R) {
    world.resource_mut::<R>().set_if_neq(value);
}

/// Returns all bodies, balls and obstacles that have been stepped, sorted by their keys; also those that are
/// [disabled](bevy::ecs::entity_disabling::Disabled).
pub fn members(world: &mut World) -> Vec<(Key, Entity)> {
    let mut bodies = world.query_filtered::<(Entity, &BodyState), Allow<Disabled>>();
    let mut balls = world.query_filtered::<(Entity, &ProjectileRecord), Allow<Disabled>>();
    // A body that has not been stepped yet has no number.
    let bodies = bodies.iter(world).filter(|(_, state)| state.order > 0);
    let bodies = bodies.map(|(entity, state)| (Key::Body(state.order), entity));
    let balls = balls.iter(world).map(|(entity, record)| (Key::Ball(record.order), entity));
    let mut members: Vec<(Key, Entity)> = bodies.chain(balls).collect();
    if let Some(solver) = world.get_resource::<SolverEnvironment>() {
        let is_there = |&(_, entity): &(u64, Entity)| world.get::<Obstacle>(entity).is_some();
        let disabled = solver.obstacles.disabled().into_iter().filter(is_there);
        let obstacles = solver.obstacles.orders_and_entities().chain(disabled);
        members.extend(obstacles.map(|(order, entity)| (Key::Obstacle(order), entity)));
    }
    members.sort_unstable_by_key(|&(key, _)| key);
    members
}

/// Returns those of the [members](members) that match a filter.
pub(super) fn chosen<F: QueryFilter>(world: &mut World, members: &Keys) -> Vec<(Key, Entity)> {
    let chosen = world.query_filtered::<(), (F, Allow<Disabled>)>();
    let chosen = chosen.query_manual(world);
    let is_chosen = |&(_, entity): &(Key, Entity)| match world.get::<Rig>(entity) {
        Some(rig) => rig.particles().iter().any(|&particle| chosen.contains(particle)),
        None => chosen.contains(entity),
    };
    members.iter().copied().filter(is_chosen).collect()
}

/// A transform as plain numbers: translation, rotation, scale.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PlainTransform([f32; 3], [f32; 4], [f32; 3]);

impl From<Transform> for PlainTransform {
    fn from(Transform { translation, rotation, scale }: Transform) -> Self {
        Self(translation.to_array(), rotation.to_array(), scale.to_array())
    }
}

impl From<PlainTransform> for Transform {
    fn from(PlainTransform(translation, rotation, scale): PlainTransform) -> Self {
        let rotation = Quat::from_array(rotation);
        Self { translation: translation.into(), rotation, scale: scale.into() }
    }
}

/// Transform of an entity as of the last step, and its global transform.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Placed {
    own: PlainTransform,
    global: [f32; 12],
}

impl Placed {
    /// Reads the transforms of an entity; the identity without a transform.
    pub fn take(entity: EntityRef) -> Self {
        let mut transform = entity.get::<Transform>().copied().unwrap_or_default();
        if let Some(true_transform) = entity.get::<InterpolationState>().and_then(InterpolationState::end) {
            transform = true_transform;
        }
        let global = entity.get::<GlobalTransform>().copied().unwrap_or_default();
        Self { own: transform.into(), global: global.affine().to_cols_array() }
    }

    /// Returns its transform.
    pub fn transform(&self) -> Transform {
        self.own.into()
    }

    /// Returns its global transform.
    pub fn global(&self) -> GlobalTransform {
        bevy::math::Affine3A::from_cols_array(&self.global).into()
    }

    /// Restores the transforms of an entity, if it has any.
    pub fn restore(&self, entity: &mut EntityWorldMut) {
        // Marked as changed in any case, since the global transform may be older.
        if let Some(mut transform) = entity.get_mut::<Transform>() {
            *transform = self.transform();
        }
        if let Some(mut global) = entity.get_mut::<GlobalTransform>() {
            global.set_if_neq(self.global());
        }
        if let Some(mut interpolation) = entity.get_mut::<InterpolationState>() {
            *interpolation = InterpolationState::default();
        }
    }
}

/// Inserts or removes a component of an entity, if that makes a difference.
pub(super) fn put_component<C: Component + PartialEq + Clone>(
    entity: &mut EntityWorldMut,
    value: Option<&C>,
) {
    if entity.get::<C>() == value {
        return;
    }
    match value {
        Some(value) => entity.insert(value.clone()),
        None => entity.remove::<C>(),
    };
}

/// Enables or disables an entity.
pub(super) fn put_disabled(entity: &mut EntityWorldMut, is_disabled: bool) {
    match (entity.contains::<Disabled>(), is_disabled) {
        (false, true) => _ = entity.insert(Disabled),
        (true, false) => _ = entity.remove::<Disabled>(),
        _ => {}
    }
}
