//! The state of obstacles.

use bevy::prelude::*;
use drape_solver::{BuildError, Placement};

use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction};
use crate::environment::obstacle::{CombineRule, Obstacle, built};
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::environment::solver_environment::SolverEnvironment;
use crate::snapshot::key::{Key, Keys, SnapshotError, entity, out_of_order};
use crate::snapshot::world::{Placed, put_component};

/// The state of one obstacle. A snapshot keeps the order of the solver's list, by which contacts are sorted.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ObstacleSnapshot {
    order: u64,
    placed: Placed,
    scale: [f32; 3],
    /// Placements in the solver, now and one step ago.
    now: ([f32; 3], [f32; 4]),
    before: ([f32; 3], [f32; 4]),
    friction: f32,
    static_friction: f32,
    friction_rule: CombineRule,
    restitution: f32,
    restitution_rule: CombineRule,
    is_sensor: bool,
    own_layers: Option<DrapeLayers>,
    dynamic: Option<DynamicObstacle>,
    reaction: Option<ObstacleReaction>,
}

impl ObstacleSnapshot {
    fn key(&self) -> Key {
        Key::Obstacle(self.order)
    }

    /// Builds the solver's obstacle for its present entity.
    fn built(&self, entity: EntityRef) -> Result<drape_solver::Obstacle, SnapshotError> {
        let key = self.key();
        let obstacle = entity.get::<Obstacle>().ok_or(SnapshotError::Missing(key))?;
        let obstacle = self.on(obstacle.clone());
        let [now, before] = [self.now, self.before].map(|(translation, rotation)| Placement {
            translation: translation.into(),
            rotation: Quat::from_array(rotation),
        });
        let layers = DrapeLayers::of(self.own_layers.as_ref());
        let asks = [entity.contains::<ContactEvents>(), self.reaction.is_some()];
        let bad = |source| SnapshotError::BadState { key, source };
        let shape = obstacle.shape.solid(entity.get()).map_err(bad)?;
        let shape = shape.ok_or(bad(BuildError::BadShape { reason: "its mesh has not loaded" }))?;
        let mut built = built(&obstacle, &shape, self.scale.into(), before, layers, asks).map_err(bad)?;
        if now != before {
            // A move, not a teleport, as it was then.
            built.move_to(now, f32::INFINITY);
        }
        Ok(built)
    }

    /// Returns an obstacle with the surface of the snapshot.
    fn on(&self, obstacle: Obstacle) -> Obstacle {
        let Self {
            friction, static_friction, friction_rule, restitution, restitution_rule, is_sensor, ..
        } = *self;
        Obstacle {
            friction,
            static_friction,
            friction_rule,
            restitution,
            restitution_rule,
            is_sensor,
            ..obstacle
        }
    }
}

pub(super) fn take(world: &World, keys: &Keys) -> Vec<ObstacleSnapshot> {
    let solver = world.resource::<SolverEnvironment>();
    let mut obstacles = Vec::with_capacity(keys.len());
    for (slot, (order, entity)) in solver.obstacles.orders_and_entities().enumerate() {
        let Ok(entity) = world.get_entity(entity) else { continue };
        let Some(obstacle) = entity.get::<Obstacle>() else { continue };
        let built = &solver.environment.obstacles[slot];
        let [now, before] = [built.placement(), built.previous_placement()]
            .map(|Placement { translation, rotation }| (translation.to_array(), rotation.to_array()));
        obstacles.push(ObstacleSnapshot {
            order,
            placed: Placed::take(entity),
            scale: solver.obstacles.scale(slot).to_array(),
            now,
            before,
            friction: obstacle.friction,
            static_friction: obstacle.static_friction,
            friction_rule: obstacle.friction_rule,
            restitution: obstacle.restitution,
            restitution_rule: obstacle.restitution_rule,
            is_sensor: obstacle.is_sensor,
            own_layers: entity.get().copied(),
            dynamic: entity.get().copied(),
            reaction: entity.get().copied(),
        });
    }
    obstacles
}

pub(super) fn check(obstacles: &[ObstacleSnapshot], world: &World, keys: &Keys) -> Result<(), SnapshotError> {
    let mut orders: Vec<Key> = obstacles.iter().map(ObstacleSnapshot::key).collect();
    orders.sort_unstable();
    out_of_order(orders.into_iter())?;
    for obstacle in obstacles {
        let key = obstacle.key();
        let entity = entity(keys, key).and_then(|entity| world.get_entity(entity).ok());
        obstacle.built(entity.ok_or(SnapshotError::Missing(key))?)?;
    }
    Ok(())
}

/// Restores obstacles that have been [checked](check).
pub(super) fn restore(
    obstacles: &[ObstacleSnapshot],
    world: &mut World,
    keys: &Keys,
) -> Result<(), SnapshotError> {
    let mut known: Vec<Key> = obstacles.iter().map(ObstacleSnapshot::key).collect();
    known.sort_unstable();
    for &(key, obstacle) in keys {
        if matches!(key, Key::Obstacle(_)) && known.binary_search(&key).is_err() {
            world.despawn(obstacle);
        }
    }
    let mut solver_obstacles = drape_solver::Obstacles::new();
    let mut places = Vec::with_capacity(obstacles.len());
    let mut moving = Vec::new();
    for snapshot in obstacles {
        let key = snapshot.key();
        let found = entity(keys, key).and_then(|entity| world.get_entity_mut(entity).ok());
        let mut entity = found.ok_or(SnapshotError::Missing(key))?;
        let built = snapshot.built(entity.as_readonly())?;
        if built.is_moving() {
            moving.push(entity.id());
        }
        solver_obstacles.push(built);
        places.push((snapshot.order, entity.id(), snapshot.scale.into()));
        if let Some(mut obstacle) = entity.get_mut::<Obstacle>() {
            // A marked change would rebuild the obstacle, which the solver has already.
            let obstacle = obstacle.bypass_change_detection();
            *obstacle = snapshot.on(obstacle.clone());
        }
        snapshot.placed.restore(&mut entity);
        put_component(&mut entity, snapshot.own_layers.as_ref());
        put_component(&mut entity, snapshot.dynamic.as_ref());
        put_component(&mut entity, snapshot.reaction.as_ref());
    }
    let mut solver = world.resource_mut::<SolverEnvironment>();
    solver.environment.obstacles = solver_obstacles;
    solver.obstacles.replace(places);
    world.resource_mut::<ObstacleChanges>().set_moving(moving);
    Ok(())
}
