//! The state of obstacles, and their order in the solver's list.

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_solver::{BuildError, Placement};

use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction};
use crate::environment::obstacle::{CombineRule, Obstacle, built};
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::environment::solver_environment::SolverEnvironment;
use crate::snapshot::key::{Key, Keys, SnapshotError, entities, entity, out_of_order};
use crate::snapshot::world::{Placed, put_component, put_disabled};

/// The state of the chosen obstacles.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ObstacleSnapshots {
    /// Those in the solver.
    known: Vec<ObstacleSnapshot>,
    /// Numbers of those that were disabled in the last step.
    disabled: Vec<(u64, ObstacleComponents)>,
    /// Numbers of all obstacles in the solver, chosen or not, in the order of its list: contacts come in that order.
    list: Vec<u64>,
    /// The number that was given out last.
    last_order: u64,
}

impl ObstacleSnapshots {
    /// Keys of all obstacles, sorted.
    fn keys(&self) -> Vec<Key> {
        let disabled = self.disabled.iter().map(|(order, _)| Key::Obstacle(*order));
        let mut keys: Vec<Key> = self.known.iter().map(ObstacleSnapshot::key).chain(disabled).collect();
        keys.sort_unstable();
        keys
    }
}

/// The state of one obstacle in the solver.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct ObstacleSnapshot {
    order: u64,
    scale: [f32; 3],
    /// Placements in the solver, now and one step ago.
    now: ([f32; 3], [f32; 4]),
    before: ([f32; 3], [f32; 4]),
    components: ObstacleComponents,
}

/// The components of an obstacle.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct ObstacleComponents {
    placed: Placed,
    friction: f32,
    static_friction: f32,
    friction_rule: CombineRule,
    restitution: f32,
    restitution_rule: CombineRule,
    is_sensor: bool,
    own_layers: Option<DrapeLayers>,
    dynamic: Option<DynamicObstacle>,
    reaction: Option<ObstacleReaction>,
    is_disabled: bool,
}

impl ObstacleSnapshot {
    fn key(&self) -> Key {
        Key::Obstacle(self.order)
    }

    /// Builds the solver's obstacle for its present entity.
    fn built(&self, entity: EntityRef) -> Result<drape_solver::Obstacle, SnapshotError> {
        let key = self.key();
        let obstacle = entity.get::<Obstacle>().ok_or(SnapshotError::Missing(key))?;
        let obstacle = self.components.on(obstacle.clone());
        let [now, before] = [self.now, self.before].map(|(translation, rotation)| Placement {
            translation: translation.into(),
            rotation: Quat::from_array(rotation),
        });
        let layers = DrapeLayers::of(self.components.own_layers.as_ref());
        let asks = [entity.contains::<ContactEvents>(), self.components.reaction.is_some()];
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
}

impl ObstacleComponents {
    /// Reads the components of an entity; none if it is no obstacle any more.
    fn take(entity: EntityRef) -> Option<Self> {
        let obstacle = entity.get::<Obstacle>()?;
        Some(Self {
            placed: Placed::take(entity),
            friction: obstacle.friction,
            static_friction: obstacle.static_friction,
            friction_rule: obstacle.friction_rule,
            restitution: obstacle.restitution,
            restitution_rule: obstacle.restitution_rule,
            is_sensor: obstacle.is_sensor,
            own_layers: entity.get().copied(),
            dynamic: entity.get().copied(),
            reaction: entity.get().copied(),
            is_disabled: entity.contains::<Disabled>(),
        })
    }

    fn restore(&self, entity: &mut EntityWorldMut) {
        if let Some(mut obstacle) = entity.get_mut::<Obstacle>() {
            // A marked change would rebuild the obstacle, which the solver has already.
            let obstacle = obstacle.bypass_change_detection();
            *obstacle = self.on(obstacle.clone());
        }
        self.placed.restore(entity);
        put_component(entity, self.own_layers.as_ref());
        put_component(entity, self.dynamic.as_ref());
        put_component(entity, self.reaction.as_ref());
        put_disabled(entity, self.is_disabled);
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

pub(super) fn take(world: &World, keys: &Keys) -> ObstacleSnapshots {
    let solver = world.resource::<SolverEnvironment>();
    let components = |entity| ObstacleComponents::take(world.get_entity(entity).ok()?);
    let is_member = |order, obstacle| entity(keys, Key::Obstacle(order)) == Some(obstacle);
    let disabled = solver.obstacles.disabled().into_iter();
    let disabled = disabled.filter(|&(order, obstacle)| is_member(order, obstacle));
    let disabled = disabled.filter_map(|(order, entity)| Some((order, components(entity)?))).collect();
    let all = solver.obstacles.orders_and_entities();
    let list = all.clone().map(|(order, _)| order).collect();
    let known = all.enumerate();
    let known = known.filter(|&(_, (order, obstacle))| is_member(order, obstacle));
    let known = known.filter_map(|(slot, (order, entity))| {
        let built = &solver.environment.obstacles[slot];
        let [now, before] = [built.placement(), built.previous_placement()]
            .map(|Placement { translation, rotation }| (translation.to_array(), rotation.to_array()));
        let scale = solver.obstacles.scale(slot).to_array();
        Some(ObstacleSnapshot { order, scale, now, before, components: components(entity)? })
    });
    ObstacleSnapshots { known: known.collect(), disabled, list, last_order: solver.obstacles.last_order() }
}

pub(super) fn check(obstacles: &ObstacleSnapshots, world: &World, keys: &Keys) -> Result<(), SnapshotError> {
    let wanted = obstacles.keys();
    out_of_order(wanted.iter().copied())?;
    if let Some(&missing) = wanted.iter().find(|&&key| entity(keys, key).is_none()) {
        return Err(SnapshotError::Missing(missing));
    }
    for obstacle in &obstacles.known {
        let key = obstacle.key();
        let entity = entity(keys, key).and_then(|entity| world.get_entity(entity).ok());
        obstacle.built(entity.ok_or(SnapshotError::Missing(key))?)?;
    }
    Ok(())
}

/// Restores obstacles that have been [checked](check).
pub(super) fn restore(
    obstacles: &ObstacleSnapshots,
    world: &mut World,
    keys: &Keys,
) -> Result<(), SnapshotError> {
    let wanted = obstacles.keys();
    for &(key, obstacle) in keys {
        if matches!(key, Key::Obstacle(_)) && wanted.binary_search(&key).is_err() {
            world.despawn(obstacle);
        }
    }
    let mut known = Vec::with_capacity(obstacles.known.len());
    let (mut moving, mut changed) = (Vec::new(), Vec::new());
    for snapshot in &obstacles.known {
        let key = snapshot.key();
        let found = entity(keys, key).and_then(|entity| world.get_entity_mut(entity).ok());
        let mut entity = found.ok_or(SnapshotError::Missing(key))?;
        let built = snapshot.built(entity.as_readonly())?;
        if built.is_moving() {
            moving.push(entity.id());
        }
        known.push((snapshot.order, entity.id(), snapshot.scale.into(), built));
        snapshot.components.restore(&mut entity);
        if snapshot.components.is_disabled {
            changed.push(entity.id());
        }
    }
    let mut disabled = Vec::with_capacity(obstacles.disabled.len());
    for (order, components) in &obstacles.disabled {
        let key = Key::Obstacle(*order);
        let found = entity(keys, key).and_then(|entity| world.get_entity_mut(entity).ok());
        let mut entity = found.ok_or(SnapshotError::Missing(key))?;
        components.restore(&mut entity);
        if !components.is_disabled {
            changed.push(entity.id());
        }
        disabled.push((*order, entity.id()));
    }
    let members = entities(keys);
    world.resource_mut::<ObstacleChanges>().restore(&members, moving, changed);
    let gone = came_and_gone(obstacles, world);
    let mut solver = world.resource_mut::<SolverEnvironment>();
    let SolverEnvironment { environment, obstacles: in_solver, .. } = &mut *solver;
    let built = &mut environment.obstacles;
    for &obstacle in gone.iter().chain(disabled.iter().map(|(_, obstacle)| obstacle)) {
        if let Some(slot) = in_solver.slot(obstacle) {
            built.swap_remove(slot);
            in_solver.swap_remove(slot);
        }
    }
    in_solver.replace_disabled(&members, disabled);
    for (order, entity, scale, obstacle) in known {
        if let Some(slot) = in_solver.slot(entity) {
            built[slot] = obstacle;
            in_solver.set_scale(slot, scale);
        } else {
            built.push(obstacle);
            in_solver.push_with(order, entity, scale);
        }
    }
    if let Some(order) = in_solver.order_by(&obstacles.list) {
        *built = order.iter().map(|&slot| built[slot].clone()).collect();
    }
    let used = in_solver.orders_and_entities().chain(in_solver.disabled()).map(|(order, _)| order);
    let last = used.fold(obstacles.last_order, u64::max);
    in_solver.go_on_from(last);
    Ok(())
}

/// Obstacles in the solver that came since, and are gone. One that was there before is removed by the next step, which wakes what
/// rests on it.
fn came_and_gone(obstacles: &ObstacleSnapshots, world: &World) -> Vec<Entity> {
    let all = world.resource::<SolverEnvironment>().obstacles.orders_and_entities();
    let is_gone = |obstacle| world.get::<Obstacle>(obstacle).is_none();
    let came_since = all.filter(|&(order, obstacle)| order > obstacles.last_order && is_gone(obstacle));
    came_since.map(|(_, obstacle)| obstacle).collect()
}
