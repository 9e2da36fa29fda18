//! Colliders and dynamic bodies as obstacles.

use bevy::prelude::*;
use bevy_drape::environment::CombineRule;
use bevy_drape::prelude::*;
use bevy_drape_bridge::{
    BodyObstacle, BodyParts, BodyReach, HasObstacle, InertialFrame, NoObstacle, Outdated, Part,
    obstacle_shape, update_body, update_collider,
};
use bevy_rapier3d::dynamics::DeformableCollider;
use bevy_rapier3d::geometry::{Collider, ColliderScale};
use bevy_rapier3d::rapier;
use bevy_rapier3d::rapier::prelude::CoefficientCombineRule;

use crate::world::{RapierWorld, place_in_body, placement};

/// A collider, and what decides about its obstacle.
type ColliderQuery<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static Collider>,
        Option<&'static ColliderScale>,
        Option<&'static GlobalTransform>,
        Has<NoObstacle>,
        Has<DeformableCollider>,
        HasObstacle,
    ),
>;

/// Colliders that may be part of a body's obstacle.
pub(crate) type PartQuery<'w, 's> =
    Query<'w, 's, (), (With<Collider>, Without<NoObstacle>, Without<Obstacle>)>;

/// Brings the obstacles of all colliders that changed up to date, and lists their bodies. A collider of a dynamic body is
/// part of the obstacle of that; a sensor is one of its own.
pub(crate) fn update_colliders(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    colliders: ColliderQuery,
    world: RapierWorld,
) {
    for entity in outdated.take_colliders() {
        let Ok((collider, scale, transform, is_left_out, is_soft, has)) = colliders.get(entity) else {
            continue;
        };
        let body = world.body_of(entity);
        outdated.bodies.extend(body);
        let is_dynamic =
            body.and_then(|body| world.body(body)).is_some_and(rapier::dynamics::RigidBody::is_dynamic);
        let known = world.collider(entity).filter(|known| {
            let is_part = is_dynamic && !known.is_sensor();
            known.is_enabled() && !is_left_out && !is_soft && !is_part
        });
        let obstacle = collider.zip(known).map(|(collider, known)| {
            let shape = obstacle_shape(&without_scale(collider, scale, transform).raw);
            let obstacle = Obstacle { shape, is_sensor: known.is_sensor(), ..surface(known) };
            (obstacle, drape_layers(known))
        });
        update_collider(&mut commands, entity, has, obstacle);
    }
}

/// The collider without the scale of its transform, by which cloth scales it.
fn without_scale(
    collider: &Collider,
    scale: Option<&ColliderScale>,
    transform: Option<&GlobalTransform>,
) -> Collider {
    let mut collider = collider.clone();
    let scale = match scale {
        None => Vec3::ONE,
        Some(ColliderScale::Relative(scale)) => *scale,
        Some(ColliderScale::Absolute(scale)) => *scale / transform.map_or(Vec3::ONE, GlobalTransform::scale),
    };
    collider.set_scale(scale, SUBDIVISIONS);
    collider
}

/// Subdivisions of a round shape that is stretched, as `RapierConfiguration` has them by default.
const SUBDIVISIONS: u32 = 10;

/// Brings the obstacles of all dynamic bodies that changed up to date. Runs after those of colliders.
pub(crate) fn update_bodies(
    mut outdated: ResMut<Outdated>,
    mut commands: Commands,
    known: Query<(&BodyObstacle, &BodyReach)>,
    parts: PartQuery,
    world: RapierWorld,
) {
    for entity in outdated.take_bodies() {
        let body = world.body(entity).and_then(|body| {
            let found: Vec<_> = parts_of(entity, &world, &parts).collect();
            let &(_, first) = found.first()?;
            Some(BodyParts {
                mass: body.mass(),
                frame: frame(body),
                place: placement(body.position()),
                parts: found.iter().map(|&(entity, collider)| part(entity, collider)).collect(),
                surface: surface(first),
                layers: drape_layers(first),
            })
        });
        update_body(&mut commands, entity, known.get(entity).ok(), body);
    }
}

/// The colliders that are part of the obstacle of a body: none if it is not a dynamic one.
pub(crate) fn parts_of<'a>(
    body: Entity,
    world: &'a RapierWorld,
    parts: &'a PartQuery,
) -> impl Iterator<Item = (Entity, &'a rapier::geometry::Collider)> {
    let is_moved =
        |body: &rapier::dynamics::RigidBody| body.is_dynamic() && body.is_enabled() && body.mass() > 0.0;
    let is_moved = world.body(body).is_some_and(is_moved);
    world.colliders_of(body).filter(move |&(entity, collider)| {
        is_moved && collider.is_enabled() && !collider.is_sensor() && parts.contains(entity)
    })
}

fn part(entity: Entity, collider: &rapier::geometry::Collider) -> Part {
    Part { entity, shape: collider.shared_shape().clone(), place: place_in_body(collider) }
}

/// The principal axes of a body.
pub(crate) fn frame(body: &rapier::dynamics::RigidBody) -> InertialFrame {
    let mass = &body.mass_properties().local_mprops;
    InertialFrame {
        centre: mass.local_com,
        axes: mass.principal_inertia_local_frame,
        moments: mass.principal_inertia(),
    }
}

/// An obstacle with the friction and restitution of a collider.
fn surface(collider: &rapier::geometry::Collider) -> Obstacle {
    Obstacle {
        friction: collider.friction(),
        friction_rule: rule(collider.friction_combine_rule()),
        restitution: collider.restitution(),
        restitution_rule: rule(collider.restitution_combine_rule()),
        ..default()
    }
}

/// The same rule in cloth's terms. Cloth has Rapier's default rule, the average, which yields to all others.
fn rule(rule: CoefficientCombineRule) -> CombineRule {
    match rule {
        CoefficientCombineRule::Average => CombineRule::Average,
        CoefficientCombineRule::Min => CombineRule::Min,
        CoefficientCombineRule::Multiply => CombineRule::Multiply,
        CoefficientCombineRule::Max => CombineRule::Max,
        CoefficientCombineRule::ClampedSum => CombineRule::ClampedSum,
        CoefficientCombineRule::GeometricMean => CombineRule::GeometricMean,
    }
}

fn drape_layers(collider: &rapier::geometry::Collider) -> DrapeLayers {
    let groups = collider.collision_groups();
    DrapeLayers::new(groups.memberships.bits(), groups.filter.bits())
}
