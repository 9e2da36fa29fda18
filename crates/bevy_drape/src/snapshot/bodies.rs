//! The state of cloths, ropes and rigs.

use std::sync::Arc;

use bevy::ecs::entity_disabling::Disabled;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::Extent;
use drape_solver::{BodyContext, BodySettings, BuildError, Layers, ParticlesSnapshot, Topology};

use crate::attach::attachment::Attachment;
use crate::attach::attachment_state::AttachmentState;
use crate::attach::grab::Grab;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks};
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::body::tearable::Untearable;
use crate::body::torn_from::{TornFrom, WholeBody};
use crate::build::rigid_tetrahedron::RigidPlace;
use crate::detail::change::parts_at;
use crate::detail::level::CurrentDetail;
#[cfg(feature = "mesh")]
use crate::render::rope_mesh::RopeSurface;
#[cfg(feature = "mesh")]
use crate::render::surface::Surface;
use crate::rig::components::Rig;
use crate::snapshot::attachments::{self, AttachmentSnapshot};
use crate::snapshot::key::{Key, Keys, SnapshotError, entity, out_of_order};
use crate::snapshot::motions::{self, MotionSnapshot};
use crate::snapshot::tears::{self, Restored, TearSnapshot};
use crate::snapshot::world::{Placed, put_component, put_disabled};

/// The state of one body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BodySnapshot {
    order: u64,
    placed: Placed,
    activity: Activity,
    particles: ParticlesSnapshot,
    /// That of the whole body, if it is torn.
    stick_count: u64,
    tear: Option<TearSnapshot>,
    still_for: f32,
    anchor: [f32; 12],
    pins: Vec<(u32, [f32; 3])>,
    bounds: [[f32; 3]; 2],
    greatest_speed: f32,
    is_refused: bool,
    settings: BodySettings,
    layers: Layers,
    own_settings: Option<SolverSettings>,
    own_surface: Option<BodySurface>,
    fabric: Option<Fabric>,
    own_layers: Option<DrapeLayers>,
    grab: Option<Grab>,
    attachment: Option<AttachmentSnapshot>,
    motion: MotionSnapshot,
    detail: Option<CurrentDetail>,
    is_disabled: bool,
}

impl BodySnapshot {
    fn key(&self) -> Key {
        Key::Body(self.order)
    }

    /// The whole body at the snapshot's level of detail, by an entity that is left of it.
    fn whole(&self, entity: EntityRef) -> Option<Arc<WholeBody>> {
        let whole = tears::whole_of(entity)?;
        let wanted = self.detail.zip(entity.get::<CurrentDetail>());
        let wanted = wanted.filter(|(wanted, now)| wanted.coarseness != now.coarseness);
        match wanted.and_then(|(wanted, _)| parts_at(entity, wanted.coarseness)) {
            Some((_, topology)) => Some(Arc::new(WholeBody { order: whole.order, topology })),
            None => Some(whole),
        }
    }

    /// The entity of the body, or for a missing piece another that is left of the same whole body.
    fn source(&self, world: &World, keys: &Keys) -> Option<Entity> {
        let tear = self.tear.as_ref().filter(|tear| tear.whole() != self.order);
        entity(keys, self.key()).or_else(|| tears::left_of(tear?.whole(), world, keys))
    }

    /// Looks up of what the body is made.
    fn plan(&self, world: &World, all: &Keys, keys: &Keys) -> Result<Plan, SnapshotError> {
        let key = self.key();
        let missing = SnapshotError::Missing(key);
        // The number of a piece that is missing may be another body's by now, which stays.
        let is_taken = entity(keys, key).is_none() && entity(all, key).is_some();
        let source = self.source(world, keys).filter(|_| !is_taken).ok_or(missing.clone())?;
        let whole = self.whole(world.entity(source)).ok_or(missing)?;
        let found = whole.topology.stick_count();
        if found as u64 != self.stick_count {
            return Err(SnapshotError::AnotherBody { key, found, wanted: self.stick_count as usize });
        }
        let bad = |source| SnapshotError::BadState { key, source };
        let Some(tear) = &self.tear else {
            self.particles.validate(whole.topology.particle_count()).map_err(bad)?;
            return Ok(Plan { source, torn_from: None, topology: Arc::clone(&whole.topology) });
        };
        if world.entity(source).contains::<Rig>() || world.entity(source).contains::<Untearable>() {
            return Err(bad(BuildError::BadTopology { reason: "it is of what does not tear" }));
        }
        let (torn_from, topology) = tear.of(&whole, &self.particles).map_err(bad)?;
        Ok(Plan { source, torn_from: Some(torn_from), topology })
    }
}

/// Of what a body is made.
pub(super) struct Plan {
    /// Its entity, or another that is left of the same whole body.
    source: Entity,
    torn_from: Option<TornFrom>,
    topology: Arc<Topology>,
}

pub(super) fn take(world: &World, keys: &Keys) -> Vec<BodySnapshot> {
    let mut bodies = Vec::new();
    for &(key, entity) in keys {
        let Key::Body(order) = key else { continue };
        let entity = world.entity(entity);
        let (Some(particles), Some(sticks)) = (entity.get::<Particles>(), entity.get::<Sticks>()) else {
            continue;
        };
        let Some(state) = entity.get::<BodyState>() else { continue };
        bodies.push(BodySnapshot {
            order,
            placed: Placed::take(entity),
            activity: entity.get().copied().unwrap_or_default(),
            particles: particles.snapshot(),
            stick_count: match &state.torn_from {
                Some(torn_from) => torn_from.whole.topology.stick_count(),
                None => sticks.stick_count(),
            } as u64,
            tear: TearSnapshot::take(state, sticks),
            still_for: state.context.still_for(),
            anchor: state.anchor.to_cols_array(),
            pins: state.pins.iter().map(|&(pin, place)| (pin, place.to_array())).collect(),
            bounds: [state.extent.bounds.low, state.extent.bounds.high].map(|corner| corner.to_array()),
            greatest_speed: state.extent.greatest_speed,
            is_refused: state.refused,
            settings: state.settings,
            layers: state.layers,
            own_settings: entity.get().copied(),
            own_surface: entity.get().copied(),
            fabric: entity.get().copied(),
            own_layers: entity.get().copied(),
            grab: entity.get().cloned(),
            attachment: attachments::take(entity),
            motion: motions::take(entity),
            detail: entity.get().copied(),
            is_disabled: entity.contains::<Disabled>(),
        });
    }
    bodies
}

/// Checks that bodies can be restored, and looks up of what.
pub(super) fn plan(
    bodies: &[BodySnapshot],
    world: &World,
    all: &Keys,
    keys: &Keys,
) -> Result<Vec<Plan>, SnapshotError> {
    out_of_order(bodies.iter().map(BodySnapshot::key))?;
    bodies.iter().map(|body| body.plan(world, all, keys)).collect()
}

/// Spawns the pieces that are missing, and returns them with the other `keys`.
fn spawn_pieces(
    bodies: &[BodySnapshot],
    plans: &[Plan],
    world: &mut World,
    keys: &Keys,
) -> Vec<(Key, Entity)> {
    let mut every = keys.to_vec();
    for (body, Plan { source, torn_from, .. }) in bodies.iter().zip(plans) {
        if let Some(TornFrom { whole, .. }) = torn_from
            && entity(keys, body.key()).is_none()
            && let Some(piece) = tears::spawn(body.order, whole, *source, world)
        {
            if body.attachment.is_none() {
                world.entity_mut(piece).remove::<(Attachment, AttachmentState)>();
            }
            every.push((body.key(), piece));
        }
    }
    every.sort_unstable_by_key(|&(key, _)| key);
    every
}

/// Restores bodies as [planned](plan).
pub(super) fn restore(
    bodies: &[BodySnapshot],
    plans: &[Plan],
    world: &mut World,
    keys: &Keys,
) -> Result<(), SnapshotError> {
    let keys = &spawn_pieces(bodies, plans, world, keys);
    for &(key, body) in keys {
        let is_known = bodies.binary_search_by_key(&key, BodySnapshot::key).is_ok();
        if matches!(key, Key::Body(_)) && !is_known {
            world.despawn(body);
        }
    }
    for (body, Plan { torn_from, topology, .. }) in bodies.iter().zip(plans) {
        let key = body.key();
        let found = entity(keys, key).and_then(|entity| world.get_entity_mut(entity).ok());
        let mut entity = found.ok_or(SnapshotError::Missing(key))?;
        let restored = tears::restore(torn_from.as_ref(), topology, &body.particles, &mut entity);
        let restored = restored.map_err(|source| SnapshotError::BadState { key, source })?;
        put_component(&mut entity, body.detail.as_ref());
        if let Some(mut particles) = entity.get_mut::<Particles>().filter(|_| restored == Restored::AsItIs) {
            let restored = particles.restore(&body.particles);
            restored.map_err(|source| SnapshotError::BadState { key, source })?;
        }
        #[cfg(feature = "mesh")]
        restart_surface(&mut entity);
        if let Some(mut state) = entity.get_mut::<BodyState>() {
            state.context = BodyContext::default();
            state.scratch = default();
            state.context.set_still_for(body.still_for);
            state.anchor = Affine3A::from_cols_array(&body.anchor);
            state.pins = body.pins.iter().map(|&(pin, place)| (pin, place.into())).collect();
            let [low, high] = body.bounds.map(Vec3::from_array);
            state.extent = Extent { bounds: Bounds::new(low, high), greatest_speed: body.greatest_speed };
            state.refused = body.is_refused;
            state.settings = body.settings;
            state.layers = body.layers;
        }
        if let Some(mut activity) = entity.get_mut::<Activity>() {
            activity.set_if_neq(body.activity);
        }
        body.placed.restore(&mut entity);
        if let Some(mut place) = entity.get_mut::<RigidPlace>() {
            place.set(body.placed.transform());
        }
        // A rig takes its settings from one of its particles.
        if !entity.contains::<Rig>() {
            put_component(&mut entity, body.own_settings.as_ref());
            put_component(&mut entity, body.own_surface.as_ref());
        }
        if let (Some(mut fabric), Some(was)) = (entity.get_mut::<Fabric>(), body.fabric) {
            // The sticks stay those that the cloth has now, as all of its description does.
            let restored = Fabric { extensible: was.extensible, ..fabric.with_surface(was.surface()) };
            fabric.set_if_neq(restored);
        }
        put_component(&mut entity, body.own_layers.as_ref());
        put_component(&mut entity, body.grab.as_ref());
        put_disabled(&mut entity, body.is_disabled);
        motions::restore(&body.motion, &mut entity);
        attachments::restore(
            body.attachment.as_ref(),
            body.order,
            restored == Restored::FromTear,
            &mut entity,
        );
    }
    Ok(())
}

/// Shows the body as it is now, and nothing between that and how it was before it was restored.
#[cfg(feature = "mesh")]
fn restart_surface(entity: &mut EntityWorldMut) {
    let Ok((particles, surface, rope)) =
        entity.get_components_mut::<(&Particles, Option<&mut Surface>, Option<&mut RopeSurface>)>()
    else {
        return;
    };
    if let Some(mut surface) = surface.filter(|surface| surface.topology.particle_count() == particles.len())
    {
        surface.restart(particles);
    }
    if let Some(mut rope) = rope {
        rope.restart(particles);
    }
}
