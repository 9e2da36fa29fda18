//! The boxes of what is at rest, so that what moves finds what is in its way.

use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhWorkspace};

use crate::world::bounds::Bounds;

/// The name of a body or ball.
pub trait Key: Copy + Eq {
    /// A small number that no two living bodies share, nor two living balls: a table is indexed by it.
    fn index(self) -> usize;
}

/// Boxes of what is at rest, in a tree of boxes. A search takes time by what it finds, not by what is there.
#[derive(Clone)]
pub struct RestingTree<K> {
    tree: Bvh,
    /// The key of each leaf of the tree, and its box.
    leaves: Vec<(K, Bounds)>,
    /// The leaf of each key, by its index.
    leaf_of: Vec<u32>,
    /// Leaves that are not in use.
    free: Vec<u32>,
    /// Leaves taken out since the tree was last refitted, which leave their branches behind.
    removals: usize,
    workspace: BvhWorkspace,
}

/// The leaf of what is not here.
const NO_LEAF: u32 = u32::MAX;

impl<K> Default for RestingTree<K> {
    fn default() -> Self {
        Self {
            tree: Bvh::default(),
            leaves: Vec::new(),
            leaf_of: Vec::new(),
            free: Vec::new(),
            removals: 0,
            workspace: BvhWorkspace::default(),
        }
    }
}

impl<K: Key> RestingTree<K> {
    /// Puts `key` to rest at `bounds`, or moves it there. A box that is not finite is never in the way.
    pub fn insert(&mut self, key: K, bounds: Bounds) {
        if !bounds.is_finite() {
            self.remove(key);
            return;
        }
        let index = key.index();
        if index >= self.leaf_of.len() {
            self.leaf_of.resize(index + 1, NO_LEAF);
        }
        let Self { leaves, free, .. } = self;
        let leaf = &mut self.leaf_of[index];
        // Another key of this index is one that is gone: its leaf is taken over.
        if *leaf == NO_LEAF {
            *leaf = free.pop().unwrap_or_else(|| {
                leaves.push((key, bounds));
                (leaves.len() - 1) as u32
            });
        }
        leaves[*leaf as usize] = (key, bounds);
        self.tree.insert(Aabb::new(bounds.low, bounds.high), *leaf);
    }

    /// Takes `key` out and returns where it was, if it is here.
    pub fn remove(&mut self, key: K) -> Option<Bounds> {
        let leaf = *self.leaf_of.get(key.index())?;
        let &(owner, bounds) = self.leaves.get(leaf as usize)?;
        if owner != key {
            return None;
        }
        self.leaf_of[key.index()] = NO_LEAF;
        self.tree.remove(leaf);
        self.free.push(leaf);
        self.removals += 1;
        // Refitting looks at all leaves once, after as many removals as there are leaves: a removal stays cheap.
        if self.removals > self.leaves.len() {
            self.tree.refit(&mut self.workspace);
            self.removals = 0;
        }
        Some(bounds)
    }

    /// True if nothing is at rest.
    pub fn is_empty(&self) -> bool {
        self.free.len() == self.leaves.len()
    }

    /// Appends to `found` what may rest within `bounds`.
    pub fn find(&self, bounds: Bounds, found: &mut Vec<K>) {
        let within = Aabb::new(bounds.low, bounds.high);
        found.extend(self.tree.intersect_aabb(&within).map(|leaf| self.leaves[leaf as usize].0));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    struct Name {
        index: usize,
        generation: u32,
    }

    impl Key for Name {
        fn index(self) -> usize {
            self.index
        }
    }

    fn name(index: usize) -> Name {
        Name { index, generation: 0 }
    }

    fn cube(x: f32) -> Bounds {
        Bounds::new(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 0.5, 0.5, 0.5))
    }

    /// Indices of those found in a part of the row.
    fn found(tree: &RestingTree<Name>, from: f32, to: f32) -> Vec<usize> {
        let mut found = Vec::new();
        tree.find(Bounds::new(Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 1.0)), &mut found);
        let mut indices: Vec<usize> = found.into_iter().map(Key::index).collect();
        indices.sort_unstable();
        indices
    }

    #[test]
    fn those_in_the_way_are_found() {
        let mut tree = RestingTree::default();
        assert!(found(&tree, -1e9, 1e9).is_empty());
        (0..100).for_each(|i| tree.insert(name(i), cube(i as f32)));
        assert_eq!(found(&tree, 10.6, 12.2), [11, 12]);
        assert_eq!(found(&tree, -1.0, 0.2), [0]);
        assert!(found(&tree, 0.6, 0.9).is_empty());
    }

    #[test]
    fn who_moves_is_found_at_its_new_place_only_and_who_left_nowhere() {
        let mut tree = RestingTree::default();
        (0..100).for_each(|i| tree.insert(name(i), cube(i as f32)));
        tree.insert(name(3), cube(200.0));
        assert!(found(&tree, 2.9, 3.9).is_empty());
        assert_eq!(found(&tree, 199.0, 300.0), [3]);
        (0..100).filter(|i| i % 7 != 0).for_each(|i| _ = tree.remove(name(i)));
        assert_eq!(found(&tree, 0.0, 30.0), [0, 7, 14, 21, 28]);
        // Again and again, so that the tree is refitted in between.
        for _ in 0..5 {
            (0..100).for_each(|i| tree.insert(name(i), cube(i as f32 + 0.25)));
            (0..100).filter(|i| i % 7 != 0).for_each(|i| _ = tree.remove(name(i)));
            assert_eq!(found(&tree, 0.0, 30.0), [0, 7, 14, 21, 28]);
        }
        (0..100).for_each(|i| _ = tree.remove(name(i)));
        assert!(found(&tree, -1e9, 1e9).is_empty());
    }

    #[test]
    fn what_is_nowhere_is_never_in_the_way() {
        let mut tree = RestingTree::default();
        tree.insert(name(0), cube(0.0));
        tree.insert(name(0), Bounds::new(Vec3::NAN, Vec3::NAN));
        tree.insert(name(1), Bounds::new(Vec3::INFINITY, Vec3::NEG_INFINITY));
        assert!(found(&tree, f32::NEG_INFINITY, f32::INFINITY).is_empty());
        tree.insert(name(1), cube(0.0));
        assert_eq!(found(&tree, f32::NEG_INFINITY, f32::INFINITY), [1]);
    }

    #[test]
    fn a_new_key_takes_the_place_of_the_gone_one_that_had_its_index() {
        let mut tree = RestingTree::default();
        let reborn = Name { index: 0, generation: 1 };
        tree.insert(name(0), cube(0.0));
        assert_eq!(tree.remove(reborn), None);
        tree.insert(reborn, cube(5.0));
        assert!(found(&tree, 0.0, 1.0).is_empty());
        assert_eq!(tree.remove(name(0)), None);
        assert_eq!(tree.remove(reborn), Some(cube(5.0)));
    }
}
