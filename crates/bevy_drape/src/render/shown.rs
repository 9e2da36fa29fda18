//! Descriptions of bodies that have one vertex for each particle.

use std::borrow::Cow;

use bevy::prelude::*;

use crate::build::cloth::Cloth;
use crate::build::soft_ball::SoftBall;
use crate::detail::level::CurrentDetail;

/// A description of a body that has one vertex for each particle.
pub(crate) trait Shown: Component + Clone {
    /// Layout of the vertices: columns and rows, or rings.
    fn layout(&self) -> [u32; 2];

    /// The number of vertices.
    fn vertex_count(&self) -> u64;

    /// Texture coordinates from (0, 0) at the top left to (1, 1).
    fn texture_coordinates(&self) -> Vec<[f32; 2]>;

    /// Returns the description at a level of detail.
    fn at(&self, _detail: Option<&CurrentDetail>) -> Cow<'_, Self> {
        Cow::Borrowed(self)
    }
}

impl Shown for Cloth {
    fn layout(&self) -> [u32; 2] {
        self.particles.to_array()
    }

    fn vertex_count(&self) -> u64 {
        u64::from(self.particles.x) * u64::from(self.particles.y)
    }

    fn texture_coordinates(&self) -> Vec<[f32; 2]> {
        let [columns, rows] = self.layout();
        let part = |i: u32, n: u32| i as f32 / (n.max(2) - 1) as f32;
        let row = |r: u32| (0..columns).map(move |c| [part(c, columns), part(r, rows)]);
        (0..rows).flat_map(row).collect()
    }

    fn at(&self, detail: Option<&CurrentDetail>) -> Cow<'_, Self> {
        let coarseness = detail.map_or(1, CurrentDetail::coarseness);
        if coarseness == 1 { Cow::Borrowed(self) } else { Cow::Owned(self.coarsened(coarseness)) }
    }
}

impl Shown for SoftBall {
    fn layout(&self) -> [u32; 2] {
        [self.rings, 0]
    }

    fn vertex_count(&self) -> u64 {
        5 * u64::from(self.rings) * (u64::from(self.rings) + 1)
    }

    fn texture_coordinates(&self) -> Vec<[f32; 2]> {
        let ring = |ring: u32| {
            let (count, radius) = (10 * (ring + 1), (ring + 1) as f32 / self.rings as f32);
            (0..count).map(move |i| {
                let around = Vec2::from_angle(core::f32::consts::TAU * i as f32 / count as f32) * radius;
                [0.5 + 0.5 * around.x, 0.5 - 0.5 * around.y]
            })
        };
        (0..self.rings).flat_map(ring).collect()
    }
}
