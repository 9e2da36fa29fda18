//! From the world into the coordinates in which an entity's mesh is written.

use bevy::camera::primitives::Aabb;
use bevy::math::{Affine3A, Mat3A, Vec3A};
use bevy::prelude::*;

/// The transform from the world into an entity's coordinates.
#[derive(Clone, Debug)]
pub(crate) struct EntitySpace {
    pub to_world: Affine3A,
    pub translation: Vec3,
    /// Inverse of rotation and scale; none for the identity, so that numbers are copied exactly.
    to_local: Option<Mat3A>,
    /// -1 for a mirroring transform, which reverses faces, else 1.
    pub orientation: f32,
}

impl EntitySpace {
    /// None if the transform cannot be inverted: a scale of zero, or values that are not finite.
    pub fn new(transform: &GlobalTransform) -> Option<Self> {
        let to_world = transform.affine();
        let matrix = to_world.matrix3;
        let to_local = (matrix != Mat3A::IDENTITY).then(|| matrix.inverse());
        let is_usable = to_world.is_finite() && to_local.is_none_or(|inverse| inverse.is_finite());
        is_usable.then(|| Self {
            to_world,
            translation: to_world.translation.into(),
            to_local,
            orientation: matrix.determinant().signum(),
        })
    }

    /// The inverse of rotation and scale.
    #[cfg(feature = "gpu")]
    pub fn to_local(&self) -> Mat3 {
        self.to_local.map_or(Mat3::IDENTITY, Mat3::from)
    }

    /// Transforms a world offset from the entity into its coordinates.
    pub fn direction(&self, offset: Vec3) -> Vec3 {
        self.to_local.map_or(offset, |to_local| to_local * offset)
    }

    /// Returns the box in the entity's coordinates around a box between two world offsets.
    pub fn bounds(&self, low: Vec3, high: Vec3) -> Aabb {
        let (centre, half) = (Vec3A::from(low + high) * 0.5, Vec3A::from(high - low) * 0.5);
        let largest = centre.abs() + half;
        let (center, half_extents, largest) = match self.to_local {
            None => (centre, half, largest),
            Some(to_local) => {
                let size = to_local.abs();
                (to_local * centre, size * half, size * largest)
            }
        };
        // A margin for the rounding of vertices.
        Aabb { center, half_extents: half_extents + largest * (8.0 * f32::EPSILON) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_does_not_leave_a_corner_outside_the_bounds() {
        let turned = Transform::from_rotation(Quat::from_euler(EulerRot::XYZ, 0.3, 1.0, -0.4));
        for transform in [Transform::IDENTITY, turned.with_scale(Vec3::new(0.3, 2.0, 1.7))] {
            let space = EntitySpace::new(&transform.into()).expect("a place of its own");
            for i in 1..1000 {
                let i = i as f32;
                let low = Vec3::new(0.1 * i, -0.7 / i, 1.3 - i);
                let high = low + Vec3::new(1.0 / i, 0.3 * i, 0.01);
                let bounds = space.bounds(low, high);
                for corner in 0..8 {
                    let pick =
                        |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 0 { low } else { high };
                    let corner =
                        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
                    let seen = Vec3A::from(space.direction(corner));
                    assert!(seen.cmpge(bounds.min()).all() && seen.cmple(bounds.max()).all(), "{corner}");
                }
            }
        }
    }

    #[test]
    fn an_entity_without_extent_or_place_has_no_space() {
        assert!(EntitySpace::new(&Transform::from_scale(Vec3::new(1.0, 0.0, 1.0)).into()).is_none());
        assert!(EntitySpace::new(&Transform::from_xyz(f32::NAN, 0.0, 0.0).into()).is_none());
    }
}
