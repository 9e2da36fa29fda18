//! A bounding volume hierarchy of resting bodies and balls.

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use drape_solver::parry3d::bounding_volume::Aabb;
use drape_solver::parry3d::partitioning::{Bvh, BvhWorkspace};

use crate::bounds::Bounds;

/// Boxes of resting entities in a tree. The time of a query grows with the number of hits, not with the number of
/// resting entities.
#[derive(Default)]
pub(crate) struct RestingBvh {
    tree: Bvh,
    /// The entity of each leaf of the tree, and its box.
    leaves: Vec<(Entity, Bounds)>,
    leaf_of: EntityHashMap<u32>,
    /// Unused leaves.
    free: Vec<u32>,
    /// Leaves removed since the tree was last refitted; their branches remain.
    removals: usize,
    workspace: BvhWorkspace,
}

impl RestingBvh {
    /// Inserts `entity` at `bounds`, or moves it there. An entity without finite bounds is never found.
    pub fn insert(&mut self, entity: Entity, bounds: Bounds) {
        let (low, high) = bounds;
        if !(low.is_finite() && high.is_finite()) {
            self.remove(entity);
            return;
        }
        let Self { leaves, free, .. } = self;
        let leaf = *self.leaf_of.entry(entity).or_insert_with(|| match free.pop() {
            Some(leaf) => leaf,
            None => {
                leaves.push((entity, bounds));
                (leaves.len() - 1) as u32
            }
        });
        leaves[leaf as usize] = (entity, bounds);
        self.tree.insert(Aabb::new(low, high), leaf);
    }

    /// Removes `entity`, and returns its box if it was in the tree.
    pub fn remove(&mut self, entity: Entity) -> Option<Bounds> {
        let leaf = self.leaf_of.remove(&entity)?;
        self.tree.remove(leaf);
        self.free.push(leaf);
        self.removals += 1;
        // Refits after as many removals as there are leaves: constant work per removal.
        if self.removals > self.leaves.len() {
            self.tree.refit(&mut self.workspace);
            self.removals = 0;
        }
        Some(self.leaves[leaf as usize].1)
    }

    /// Appends to `found` the entities whose boxes overlap `bounds`.
    pub fn find(&self, (low, high): Bounds, found: &mut Vec<Entity>) {
        let within = Aabb::new(low, high);
        found.extend(self.tree.intersect_aabb(&within).map(|leaf| self.leaves[leaf as usize].0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(x: f32) -> Bounds {
        (Vec3::new(x, 0.0, 0.0), Vec3::new(x + 0.5, 0.5, 0.5))
    }

    fn entity(i: u32) -> Entity {
        Entity::from_raw_u32(i).expect("an entity")
    }

    /// Indices of the entities found in a part of the row.
    fn found(resting: &RestingBvh, from: f32, to: f32) -> Vec<u32> {
        let mut found = Vec::new();
        resting.find((Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 1.0)), &mut found);
        let mut indices: Vec<u32> = found.into_iter().map(Entity::index_u32).collect();
        indices.sort_unstable();
        indices
    }

    #[test]
    fn those_in_the_way_are_found() {
        let mut resting = RestingBvh::default();
        assert!(found(&resting, -1e9, 1e9).is_empty());
        (0..100).for_each(|i| resting.insert(entity(i), cube(i as f32)));
        assert_eq!(found(&resting, 10.6, 12.2), [11, 12]);
        assert_eq!(found(&resting, -1.0, 0.2), [0]);
        assert!(found(&resting, 0.6, 0.9).is_empty());
    }

    #[test]
    fn who_moves_is_found_at_its_new_place_only_and_who_left_nowhere() {
        let mut resting = RestingBvh::default();
        (0..100).for_each(|i| resting.insert(entity(i), cube(i as f32)));
        resting.insert(entity(3), cube(200.0));
        assert!(found(&resting, 2.9, 3.9).is_empty());
        assert_eq!(found(&resting, 199.0, 300.0), [3]);
        (0..100).filter(|i| i % 7 != 0).for_each(|i| _ = resting.remove(entity(i)));
        assert_eq!(found(&resting, 0.0, 30.0), [0, 7, 14, 21, 28]);
        // Again and again, so that the tree is tidied up in between.
        for _ in 0..5 {
            (0..100).for_each(|i| resting.insert(entity(i), cube(i as f32 + 0.25)));
            (0..100).filter(|i| i % 7 != 0).for_each(|i| _ = resting.remove(entity(i)));
            assert_eq!(found(&resting, 0.0, 30.0), [0, 7, 14, 21, 28]);
        }
        (0..100).for_each(|i| _ = resting.remove(entity(i)));
        assert!(found(&resting, -1e9, 1e9).is_empty());
    }

    #[test]
    fn what_is_nowhere_is_never_in_the_way() {
        let mut resting = RestingBvh::default();
        resting.insert(entity(0), cube(0.0));
        resting.insert(entity(0), (Vec3::NAN, Vec3::NAN));
        resting.insert(entity(1), (Vec3::INFINITY, Vec3::NEG_INFINITY));
        assert!(found(&resting, f32::NEG_INFINITY, f32::INFINITY).is_empty());
        resting.insert(entity(1), cube(0.0));
        assert_eq!(found(&resting, f32::NEG_INFINITY, f32::INFINITY), [1]);
    }
}
