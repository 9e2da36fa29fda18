//! Bodies and colliders in Rapier's sets, by entity.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_drape::drape_solver::Placement;
use bevy_rapier3d::plugin::RapierConfiguration;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextEntityLink, RapierRigidBodySet};
use bevy_rapier3d::prelude::{RapierColliderHandle, RapierRigidBodyHandle};
use bevy_rapier3d::rapier;
use bevy_rapier3d::rapier::math::Pose;

/// Rapier's worlds, to be read.
#[derive(SystemParam)]
pub(crate) struct RapierWorld<'w, 's> {
    sets: Query<'w, 's, (&'static RapierRigidBodySet, &'static RapierContextColliders)>,
    configurations: Query<'w, 's, &'static RapierConfiguration>,
    bodies: Query<'w, 's, (&'static RapierRigidBodyHandle, &'static RapierContextEntityLink)>,
    colliders: Query<'w, 's, (&'static RapierColliderHandle, &'static RapierContextEntityLink)>,
}

impl RapierWorld<'_, '_> {
    /// The body of an entity.
    pub fn body(&self, entity: Entity) -> Option<&rapier::dynamics::RigidBody> {
        let (handle, link) = self.bodies.get(entity).ok()?;
        let (set, _) = self.sets.get(link.0).ok()?;
        // Proxies of Rapier's soft bodies follow their particles.
        set.bodies.get(handle.0).filter(|body| !body.is_soft_frame())
    }

    /// True if the world of a body takes no steps.
    pub fn is_paused(&self, body: Entity) -> bool {
        let configuration = self.bodies.get(body).and_then(|(_, link)| self.configurations.get(link.0));
        configuration.is_ok_and(|configuration| !configuration.physics_pipeline_active)
    }

    /// The collider of an entity.
    pub fn collider(&self, entity: Entity) -> Option<&rapier::geometry::Collider> {
        let (handle, link) = self.colliders.get(entity).ok()?;
        self.sets.get(link.0).ok()?.1.colliders.get(handle.0)
    }

    /// The entity of the body that a collider belongs to.
    pub fn body_of(&self, collider: Entity) -> Option<Entity> {
        let (_, link) = self.colliders.get(collider).ok()?;
        let (bodies, colliders) = self.sets.get(link.0).ok()?;
        colliders.collider_parent(bodies, collider)
    }

    /// The colliders of a body, each with its entity.
    pub fn colliders_of(&self, body: Entity) -> impl Iterator<Item = (Entity, &rapier::geometry::Collider)> {
        let set = self.bodies.get(body).and_then(|(_, link)| self.sets.get(link.0)).ok();
        let handles = self.body(body).map_or(&[][..], |body| body.colliders());
        handles.iter().filter_map(move |&handle| {
            let (_, colliders) = set?;
            Some((colliders.collider_entity(handle)?, colliders.colliders.get(handle)?))
        })
    }
}

/// A place in cloth's terms.
pub(crate) fn placement(pose: &Pose) -> Placement {
    Placement { translation: pose.translation, rotation: pose.rotation }
}

/// The place of a collider in its body.
pub(crate) fn place_in_body(collider: &rapier::geometry::Collider) -> Placement {
    collider.position_wrt_parent().map(placement).unwrap_or_default()
}
