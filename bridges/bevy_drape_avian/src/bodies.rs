//! Stands an obstacle in for each dynamic body: an entity of its own with the shapes of all its colliders, about its
//! centre of mass.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_drape::drape_solver::{BuildError, Placement, Shape};
use bevy_drape::environment::{DynamicObstacle, ObstacleShape};
use bevy_drape::prelude::*;

use crate::frame::InertialFrame;
use crate::marks::{BodyObstacle, NoObstacle, ObstacleOf};
use crate::outdated::{Outdated, Parts};
use crate::surface::Surfaces;

/// A body, and what decides about its obstacle.
type BodyQuery<'w, 's> = Query<
    'w,
    's,
    (
        &'static RigidBody,
        Option<&'static RigidBodyColliders>,
        &'static ComputedMass,
        &'static ComputedAngularInertia,
        &'static ComputedCenterOfMass,
        &'static Position,
        &'static Rotation,
        Option<&'static BodyObstacle>,
        Has<RigidBodyDisabled>,
    ),
>;

/// Colliders that are part of a body's obstacle.
type PartQuery<'w, 's> = Query<
    'w,
    's,
    (&'static Collider, &'static ColliderTransform, Option<&'static CollisionLayers>),
    (Without<Sensor>, Without<ColliderDisabled>, Without<NoObstacle>, Without<Obstacle>),
>;

/// Brings the obstacles of all dynamic bodies that changed up to date. Runs after the obstacles of colliders.
pub(crate) fn update_bodies(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    bodies: BodyQuery,
    parts: PartQuery,
    surfaces: Surfaces,
) {
    outdated.bodies.sort_unstable();
    outdated.bodies.dedup();
    for entity in outdated.bodies.drain(..) {
        let Ok((kind, colliders, mass, inertia, centre, position, rotation, known, is_disabled)) =
            bodies.get(entity)
        else {
            continue;
        };
        let is_dynamic = kind.is_dynamic() && !is_disabled && mass.is_finite();
        let colliders = colliders.into_iter().flatten().filter(|_| is_dynamic);
        let found: Vec<_> = colliders.filter_map(|part| Some((part, parts.get(part).ok()?))).collect();
        let Some(&(first, (.., layers))) = found.first() else {
            if let Some(known) = known {
                commands.entity(known.entity()).try_despawn();
            }
            continue;
        };
        let frame = InertialFrame::new(centre, inertia);
        let shape = shape(&frame, found.iter().map(|&(_, (collider, place, _))| (collider, place)));
        // Cloth sees one surface and one set of layers for a body: those of its first collider.
        let surface = surfaces.of(first);
        let layers = layers.copied().unwrap_or_default();
        let obstacle = (
            surface.obstacle(shape),
            DrapeLayers::new(layers.memberships.0, layers.filters.0),
            DynamicObstacle::new(mass.value(), frame.moments),
            Parts(found.iter().map(|&(part, (_, place, _))| (part, *place)).collect()),
            frame,
        );
        match known {
            Some(known) => _ = commands.entity(known.entity()).try_insert(obstacle),
            None => {
                let place = frame.of_body(position, rotation);
                let there =
                    Transform { translation: place.translation, rotation: place.rotation, ..default() };
                commands.spawn((obstacle, there, ObstacleOf(entity)));
            }
        }
    }
}

/// The shape of colliders together, in the body's inertial frame.
fn shape<'a>(
    frame: &InertialFrame,
    parts: impl Iterator<Item = (&'a Collider, &'a ColliderTransform)>,
) -> ObstacleShape {
    let placed = parts.map(|(collider, place)| {
        let placement = frame.placed(Placement { translation: place.translation, rotation: place.rotation });
        Ok((Shape::from_parry(collider.shape_scaled().clone())?, placement))
    });
    let shape = placed.collect::<Result<Vec<_>, BuildError>>().and_then(Shape::compound);
    // An obstacle that cannot be is refused by the plugin, which names the entity.
    shape.map_or_else(|_| ObstacleShape::Sphere { radius: f32::NAN }, ObstacleShape::from)
}
