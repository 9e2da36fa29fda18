//! Keeps rig particles and their transforms together.

use bevy::math::Vec3A;
use bevy::prelude::*;

use crate::body::activity::Activity;
use crate::body::particles::Particles;
use crate::refusal::Refusals;
use crate::rig::components::{InRig, Particle, ParticleRecord, Rig};

/// Teleports free particles whose transforms were set by hand, and moves pinned ones with their transforms.
pub(crate) fn follow_rig_transforms(
    mut members: Query<
        (Entity, &Particle, &InRig, &Transform, &GlobalTransform, &mut ParticleRecord),
        Or<(Changed<Transform>, Changed<GlobalTransform>)>,
    >,
    mut bodies: Query<(&Activity, &mut Particles), With<Rig>>,
    mut refusals: ResMut<Refusals>,
) {
    for (entity, particle, in_rig, transform, global, mut record) in &mut members {
        let place = global.translation();
        let has_moved =
            if particle.pinned { place != record.placed } else { transform.translation != record.written };
        if !has_moved {
            continue;
        }
        if !(place.is_finite() && transform.translation.is_finite()) {
            // The body continues from its place.
            refusals.entity(entity, "the new Transform", "its translation must be finite");
            continue;
        }
        let Ok((activity, mut particles)) = bodies.get_mut(in_rig.body) else { continue };
        if in_rig.index >= particles.len() {
            continue;
        }
        record.written = transform.translation;
        record.placed = place;
        if particle.pinned && !activity.is_carried() {
            particles.set_pin_target(in_rig.index, place);
        } else {
            particles.set_position(in_rig.index, place);
        }
    }
}

/// Writes the transforms of the particles of active rigs, and of resting rigs if a parent has moved.
pub(crate) fn write_rig_transforms(
    bodies: Query<(&Particles, &Activity), With<Rig>>,
    mut members: Query<(
        &Particle,
        &InRig,
        Ref<GlobalTransform>,
        &mut Transform,
        &mut ParticleRecord,
        Option<&ChildOf>,
    )>,
    simulated: Query<(&Particle, &InRig)>,
    globals: Query<&GlobalTransform>,
    parents: Query<&ChildOf>,
) {
    let place = |particle: &Particle, in_rig: &InRig| -> Option<(Vec3, Activity)> {
        let (particles, activity) = bodies.get(in_rig.body).ok()?;
        let is_simulated = !particle.pinned && in_rig.index < particles.len();
        is_simulated.then(|| (particles.position(in_rig.index), *activity))
    };
    // Global transforms are from before the step. Ancestors that are particles themselves have moved since.
    let moved_by = |mut entity: Entity| -> Vec3 {
        loop {
            let now = simulated.get(entity).ok().and_then(|(particle, in_rig)| place(particle, in_rig));
            if let (Some((now, _)), Ok(before)) = (now, globals.get(entity)) {
                return now - before.translation();
            }
            match parents.get(entity) {
                Ok(child_of) => entity = child_of.parent(),
                Err(_) => return Vec3::ZERO,
            }
        }
    };
    for (particle, in_rig, global, mut transform, mut record, child_of) in &mut members {
        let Some((place, activity)) = place(particle, in_rig) else { continue };
        if activity != Activity::Active && !global.is_changed() {
            continue;
        }
        let mut translation = place;
        if let Some(parent) = child_of.map(ChildOf::parent)
            && let Ok(of_parent) = globals.get(parent)
        {
            let mut of_parent = of_parent.affine();
            of_parent.translation += Vec3A::from(moved_by(parent));
            translation = of_parent.inverse().transform_point3(place);
        }
        // Not finite for an invalid body, or a parent of scale zero.
        if translation.is_finite() && transform.translation != translation {
            transform.translation = translation;
            record.written = translation;
            record.placed = place;
        }
    }
}
