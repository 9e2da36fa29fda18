//! Object space: a bounding-volume tree of the cloth, parry's.
//!
//! The tree is built once, over bunches of consecutive faces in the cloth's own order, and refitted at the start of
//! each step whose balls come near, with every box widened by the greatest motion of a particle in the step. In a
//! substep a ball descends the tree with its current box, and queries each face whose own box touches it for the
//! closest feature.
//!
//! Rejected: rebuilding the tree at every step, which costs eight times a refit and makes queries no faster; leaves of
//! one face, which take more than twice the time of bunches of sixteen; leaves of four, a sixth more.

use drape_solver::glam::{Vec3, Vec3A};
use drape_solver::parry3d::bounding_volume::Aabb;
use drape_solver::parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode, TraversalAction};

use super::closest_feature::ClosestFeatureQueries;
use super::method::{Contact, Method, Pair};
use super::state::State;

/// Faces per leaf.
const BUNCH: usize = 16;

/// See the [module](self).
#[derive(Default)]
pub struct ObjectSpace {
    tree: Option<Bvh>,
    near: Vec<u32>,
    queries: ClosestFeatureQueries,
}

fn boxes(state: &State) -> impl Iterator<Item = Aabb> {
    state.faces.chunks(BUNCH).map(|bunch| {
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for particle in bunch.iter().flatten() {
            let position = state.positions[*particle as usize];
            (low, high) = (low.min(position), high.max(position));
        }
        Aabb::new(Vec3::from(low - state.motion), Vec3::from(high + state.motion))
    })
}

impl Method for ObjectSpace {
    fn name(&self) -> &'static str {
        "object-space"
    }

    fn begin_step(&mut self, state: &mut State) {
        self.near.clear();
        self.near.extend(state.near_balls().map(|(ball, _)| ball));
        if self.near.is_empty() {
            return;
        }
        if let Some(tree) = &mut self.tree {
            for (leaf, around) in (0..).zip(boxes(state)) {
                tree.insert_or_update_partially(around, leaf, 0.0);
            }
            tree.refit_without_opt();
        } else {
            self.tree = Some(Bvh::from_iter(BvhBuildStrategy::Binned, boxes(state).enumerate()));
        }
    }

    fn find(&mut self, state: &mut State) -> usize {
        let Self { tree, near, queries } = self;
        queries.clear();
        let Some(tree) = tree else { return 0 };
        let count = state.faces.len();
        for &ball in &*near {
            let sphere = &state.balls[ball as usize];
            let around =
                BvhNode::leaf(Aabb::new(sphere.centre - sphere.apart, sphere.centre + sphere.apart), 0);
            tree.traverse(|node| {
                if !node.intersects(&around) {
                    return TraversalAction::Prune;
                }
                if let Some(leaf) = node.leaf_data() {
                    let first = leaf as usize * BUNCH;
                    for face in first..(first + BUNCH).min(count) {
                        queries.query(state, ball, sphere, face as u32);
                    }
                }
                TraversalAction::Continue
            });
        }
        queries.count
    }

    fn pairs(&self, _: &State) -> Vec<Pair> {
        self.queries.contacts.iter().map(|contact: &Contact| contact.pair).collect()
    }
}
