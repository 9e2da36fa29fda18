//! The state of cloths, ropes and rigs.

use bevy::ecs::entity_disabling::Disabled;
use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::Extent;
use drape_solver::{BodyContext, BodySettings, Layers, ParticlesSnapshot};

use crate::attach::grab::Grab;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{BodyParts, Particles, Sticks};
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::build::rigid_tetrahedron::RigidPlace;
use crate::detail::change::parts_at;
use crate::detail::level::CurrentDetail;
use crate::rig::components::Rig;
use crate::snapshot::attachments::{self, AttachmentSnapshot};
use crate::snapshot::key::{Key, Keys, SnapshotError, entity, out_of_order};
use crate::snapshot::motions::{self, MotionSnapshot};
use crate::snapshot::world::{Placed, put_component, put_disabled};

/// The state of one body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct BodySnapshot {
    order: u64,
    placed: Placed,
    activity: Activity,
    particles: ParticlesSnapshot,
    stick_count: u64,
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

    /// Builds the particles and sticks of the snapshot, if the body has another level of detail now.
    fn other_parts(&self, entity: EntityRef) -> Option<BodyParts> {
        let wanted = self.detail?.coarseness;
        let is_other = wanted != entity.get::<CurrentDetail>()?.coarseness;
        if is_other { parts_at(entity, wanted) } else { None }
    }
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
            stick_count: sticks.stick_count() as u64,
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

pub(super) fn check(bodies: &[BodySnapshot], world: &World, keys: &Keys) -> Result<(), SnapshotError> {
    out_of_order(bodies.iter().map(BodySnapshot::key))?;
    for body in bodies {
        let key = body.key();
        let entity = entity(keys, key).ok_or(SnapshotError::Missing(key))?;
        let (particles, sticks) = (world.get::<Particles>(entity), world.get::<Sticks>(entity));
        let (Some(particles), Some(sticks)) = (particles, sticks) else {
            return Err(SnapshotError::Missing(key));
        };
        let others = body.other_parts(world.entity(entity));
        let found = others.as_ref().map_or(sticks.stick_count(), |(_, sticks)| sticks.stick_count());
        if found as u64 != body.stick_count {
            return Err(SnapshotError::AnotherBody { key, found, wanted: body.stick_count as usize });
        }
        let count = others.as_ref().map_or(particles.len(), |(particles, _)| particles.len());
        let validated = body.particles.validate(count);
        validated.map_err(|source| SnapshotError::BadState { key, source })?;
    }
    Ok(())
}

/// Restores bodies that have been [checked](check).
pub(super) fn restore(bodies: &[BodySnapshot], world: &mut World, keys: &Keys) -> Result<(), SnapshotError> {
    for &(key, body) in keys {
        let is_known = bodies.binary_search_by_key(&key, BodySnapshot::key).is_ok();
        if matches!(key, Key::Body(_)) && !is_known {
            world.despawn(body);
        }
    }
    for body in bodies {
        let key = body.key();
        let found = entity(keys, key).and_then(|entity| world.get_entity_mut(entity).ok());
        let mut entity = found.ok_or(SnapshotError::Missing(key))?;
        if let Some((particles, topology)) = body.other_parts(entity.as_readonly()) {
            entity.insert((Particles(particles), Sticks(topology)));
        }
        put_component(&mut entity, body.detail.as_ref());
        if let Some(mut particles) = entity.get_mut::<Particles>() {
            let restored = particles.restore(&body.particles);
            restored.map_err(|source| SnapshotError::BadState { key, source })?;
        }
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
        attachments::restore(body.attachment.as_ref(), body.order, &mut entity);
    }
    Ok(())
}
