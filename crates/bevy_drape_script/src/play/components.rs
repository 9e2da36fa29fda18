//! Components that entities of a scene get when they are spawned, and when the scene changes.

use bevy::prelude::*;
use bevy_drape::body::Pressure;
use bevy_drape::prelude::*;

use crate::scene::{self, Body, Motion};

/// The transform of something at `at`, turned by `turn`.
pub(super) fn place(at: scene::Vector, turn: &scene::Turn) -> Transform {
    Transform { translation: at.get(), rotation: turn.quaternion(), scale: Vec3::ONE }
}

/// Makes an obstacle dynamic, or no longer, as the scene says.
pub(super) fn set_dynamic(world: &mut World, entity: Entity, obstacle: &scene::Obstacle) {
    let mut entity = world.entity_mut(entity);
    match &obstacle.motion {
        Motion::Dynamic(dynamic) => {
            if let Some(dynamic) = dynamic.component(&obstacle.shape) {
                entity.insert(dynamic);
            }
        }
        Motion::Static | Motion::Steady(_) | Motion::Keyframes(_) => {
            entity.remove::<DynamicObstacle>();
        }
    }
}

/// Makes a body tearable, or no longer, as the scene says.
pub(super) fn set_tearable(world: &mut World, entity: Entity, body: &Body) {
    let mut entity = world.entity_mut(entity);
    match body.tearable().map(Tearable::from) {
        Some(tearable) if entity.get() != Some(&tearable) => {
            entity.insert(tearable);
        }
        None if entity.contains::<Tearable>() => {
            entity.remove::<Tearable>();
        }
        _ => {}
    }
}

/// Sets the pressure of a closed body as the scene says, or removes it.
pub(super) fn set_pressure(world: &mut World, entity: Entity, body: &Body) {
    let pressure = match body {
        Body::ClothMesh(cloth) => cloth.pressure,
        Body::SoftBody(solid) => Some(solid.pressure),
        _ => return,
    };
    let pressure = pressure.map(|pressure| Pressure(pressure.get()));
    let mut entity = world.entity_mut(entity);
    match pressure {
        Some(pressure) if entity.get() != Some(&pressure) => {
            entity.insert(pressure);
        }
        None if entity.contains::<Pressure>() => {
            entity.remove::<Pressure>();
        }
        _ => {}
    }
}

/// Gives an entity its name, its layers, and the marker of those that report contacts.
pub(super) fn mark(
    world: &mut World,
    entity: Entity,
    name: &str,
    layers: Option<&scene::Layers>,
    contacts: bool,
) {
    world.entity_mut(entity).insert(Name::new(name.to_string()));
    set_touch(world, entity, layers, contacts);
}

/// Sets or removes the layers of an entity and the marker of those that report contacts.
pub(super) fn set_touch(world: &mut World, entity: Entity, layers: Option<&scene::Layers>, contacts: bool) {
    let mut entity = world.entity_mut(entity);
    match layers.map(DrapeLayers::from) {
        Some(layers) => entity.insert(layers),
        None => entity.remove::<DrapeLayers>(),
    };
    if contacts {
        entity.insert(ContactEvents);
    } else {
        entity.remove::<ContactEvents>();
    }
}
