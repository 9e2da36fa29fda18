//! The equations of VRM's spring bones (the algorithm of `VRMC_springBone` 1.0), one bone at a time.

use bevy::math::Affine3A;
use bevy::prelude::*;

use crate::bones::spring_bones::{SpringCollider, SpringJoint};

/// A [`SpringCollider`] in the world: the ends of its axis, and its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlacedCollider {
    ends: [Vec3; 2],
    radius: f32,
}

impl PlacedCollider {
    /// Places a collider.
    pub fn new(collider: &SpringCollider, place: &Affine3A) -> Self {
        let ends = [Vec3::ZERO, collider.tail].map(|end| place.transform_point3(end));
        Self { ends, radius: collider.radius.max(0.0) }
    }

    /// The place that a ball of `radius` at `tail` is pushed to; none if it is outside.
    fn push(&self, tail: Vec3, radius: f32) -> Option<Vec3> {
        let [start, end] = self.ends;
        let axis = end - start;
        let part = (tail - start).dot(axis) / axis.length_squared();
        let nearest = if part > 0.0 { start + axis * part.min(1.0) } else { start };
        let way = tail - nearest;
        let depth = self.radius + radius - way.length();
        (depth > 0.0).then(|| tail + way.normalize_or_zero() * depth)
    }
}

/// A bone at the beginning of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bone {
    /// Place of its joint in the world.
    pub head: Vec3,
    /// The way from there to its end in the animated pose, on the joints above as they have swung.
    pub rest: Vec3,
}

impl Bone {
    /// Takes the end of the bone through a step of `dt` seconds. `tails` are its places after the last two steps, in coordinates that one
    /// map takes to the world and the other back. Returns the new place in the world.
    pub fn swing(
        &self,
        tails: &mut [Vec3; 2],
        [to_world, to_center]: [&Affine3A; 2],
        joint: &SpringJoint,
        colliders: &[PlacedCollider],
        dt: f32,
    ) -> Vec3 {
        let [before, now] = *tails;
        let inertia = to_world.transform_vector3(now - before) * (1.0 - joint.drag_force);
        let stiffness = self.rest.normalize_or_zero() * (joint.stiffness * dt);
        let external = joint.gravity_dir * (joint.gravity_power * dt);
        let mut next = self.at_length(to_world.transform_point3(now) + inertia + stiffness + external);
        for collider in colliders {
            if let Some(pushed) = collider.push(next, joint.hit_radius) {
                next = self.at_length(pushed);
            }
        }
        *tails = [now, to_center.transform_point3(next)];
        next
    }

    /// The nearest place to `tail` that is as far from the joint as the bone is long.
    fn at_length(&self, tail: Vec3) -> Vec3 {
        let way = (tail - self.head).try_normalize();
        self.head + way.map_or(self.rest, |way| way * self.rest.length())
    }
}
