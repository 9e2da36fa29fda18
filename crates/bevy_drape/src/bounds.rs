//! Boxes along the axes of the world.

use bevy::prelude::*;

/// A box in the world, as (least, greatest) corner.
pub(crate) type Bounds = (Vec3, Vec3);

pub(crate) fn overlap(a: Bounds, b: Bounds) -> bool {
    a.0.cmple(b.1).all() && a.1.cmpge(b.0).all()
}

pub(crate) fn grown((low, high): Bounds, by: f32) -> Bounds {
    (low - by, high + by)
}

/// Distance from `eye` to the nearest point of a box, in metres.
pub(crate) fn distance_to(eye: Vec3, (low, high): Bounds) -> f32 {
    eye.distance(eye.max(low).min(high))
}
