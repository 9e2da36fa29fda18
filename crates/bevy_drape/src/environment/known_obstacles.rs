//! Entities behind the solver's obstacles.

use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// The obstacles in the solver: entities by slot, and slots by entity.
#[derive(Default)]
pub(crate) struct KnownObstacles {
    entities: Vec<Entity>,
    /// Scales that the obstacles were built at.
    scales: Vec<Vec3>,
    /// Numbers in the order of creation.
    orders: Vec<u64>,
    last_order: u64,
    slots: EntityHashMap<usize>,
    /// Obstacles that are disabled and not in the solver, with the numbers that they have again once they are enabled.
    disabled: EntityHashMap<u64>,
}

impl KnownObstacles {
    /// Returns the entity behind an obstacle of the solver.
    pub fn entity(&self, slot: usize) -> Entity {
        self.entities[slot]
    }

    pub fn slot(&self, entity: Entity) -> Option<usize> {
        self.slots.get(&entity).copied()
    }

    /// Numbers and entities of all obstacles, by slot.
    pub fn orders_and_entities(&self) -> impl Iterator<Item = (u64, Entity)> + Clone + '_ {
        self.orders.iter().copied().zip(self.entities.iter().copied())
    }

    /// Notes that an obstacle was rebuilt at another scale.
    pub fn set_scale(&mut self, slot: usize, scale: Vec3) {
        self.scales[slot] = scale;
    }

    /// Returns the scale that an obstacle was built at.
    pub fn scale(&self, slot: usize) -> Vec3 {
        self.scales[slot]
    }

    /// Numbers and entities of the obstacles that are disabled, in the order of the numbers.
    pub fn disabled(&self) -> Vec<(u64, Entity)> {
        let mut disabled: Vec<_> = self.disabled.iter().map(|(&entity, &order)| (order, entity)).collect();
        disabled.sort_unstable();
        disabled
    }

    /// The number of an obstacle that is disabled.
    pub fn order_of_disabled(&self, entity: Entity) -> Option<u64> {
        self.disabled.get(&entity).copied()
    }

    /// The number that was given out last.
    pub fn last_order(&self) -> u64 {
        self.last_order
    }

    /// Continues with the number after `last`.
    pub fn go_on_from(&mut self, last: u64) {
        self.last_order = last;
    }

    /// Replaces those of the members that are disabled, each with its number.
    pub fn replace_disabled(&mut self, members: &EntityHashSet, disabled: Vec<(u64, Entity)>) {
        self.disabled.retain(|obstacle, _| !members.contains(obstacle));
        self.disabled.extend(disabled.into_iter().map(|(order, obstacle)| (obstacle, order)));
    }

    /// Puts the obstacles into the order of these numbers, and all others behind them. Returns the slots that they had; none if
    /// that is the order that they have already.
    pub fn order_by(&mut self, numbers: &[u64]) -> Option<Vec<usize>> {
        if self.orders.starts_with(numbers) {
            return None;
        }
        let rank: HashMap<u64, usize> =
            numbers.iter().enumerate().map(|(rank, &order)| (order, rank)).collect();
        let mut slots: Vec<usize> = (0..self.orders.len()).collect();
        slots.sort_by_key(|&slot| rank.get(&self.orders[slot]).copied().unwrap_or(usize::MAX));
        if slots.is_sorted() {
            return None;
        }
        self.entities = slots.iter().map(|&slot| self.entities[slot]).collect();
        self.scales = slots.iter().map(|&slot| self.scales[slot]).collect();
        self.orders = slots.iter().map(|&slot| self.orders[slot]).collect();
        self.slots = self.entities.iter().enumerate().map(|(slot, &entity)| (entity, slot)).collect();
        Some(slots)
    }

    /// Adds an obstacle, with the number that it had if it was disabled.
    pub fn push(&mut self, entity: Entity, scale: Vec3) {
        let order = self.forget_disabled(entity).unwrap_or(self.last_order + 1);
        self.push_with(order, entity, scale);
    }

    /// Adds an obstacle with its number and scale.
    pub fn push_with(&mut self, order: u64, entity: Entity, scale: Vec3) {
        self.last_order = self.last_order.max(order);
        self.slots.insert(entity, self.entities.len());
        self.entities.push(entity);
        self.scales.push(scale);
        self.orders.push(order);
    }

    /// Removes one that was disabled, and keeps its number. The last one takes its slot.
    pub fn disable(&mut self, slot: usize) {
        self.disabled.insert(self.entities[slot], self.orders[slot]);
        self.swap_remove(slot);
    }

    /// Forgets an obstacle that was disabled; gives its number.
    pub fn forget_disabled(&mut self, entity: Entity) -> Option<u64> {
        self.disabled.remove(&entity)
    }

    /// Removes one; the last one takes its slot.
    pub fn swap_remove(&mut self, slot: usize) {
        let removed = self.entities.swap_remove(slot);
        if self.slots.get(&removed) == Some(&slot) {
            self.slots.remove(&removed);
        }
        self.scales.swap_remove(slot);
        self.orders.swap_remove(slot);
        if let Some(moved) = self.entities.get(slot) {
            self.slots.insert(*moved, slot);
        }
    }

    /// True if the obstacle was built at about this scale. Rotation changes the last digits of a scale that is read
    /// from a matrix; that does not count.
    pub fn has_scale(&self, slot: usize, scale: Vec3) -> bool {
        let known = self.scales[slot];
        (scale - known).abs().cmple(1e-4 * known.abs()).all()
    }
}
