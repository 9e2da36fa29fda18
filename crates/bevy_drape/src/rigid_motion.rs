//! Placements, and rigid motions between them.

use bevy::math::Affine3A;
use bevy::prelude::*;
use drape_solver::Placement;

/// Interpolates between two transforms.
pub(crate) fn between(start: &Transform, end: &Transform, fraction: f32) -> Transform {
    if start == end || fraction >= 1.0 {
        return *end;
    }
    Transform {
        translation: start.translation.lerp(end.translation, fraction),
        rotation: start.rotation.slerp(end.rotation, fraction),
        scale: start.scale.lerp(end.scale, fraction),
    }
}

/// Returns the rotation and translation of an affine map; none if they are not valid.
pub(crate) fn placement(affine: &Affine3A) -> Option<Placement> {
    let (_, rotation, translation) = affine.to_scale_rotation_translation();
    Some(Placement { translation, rotation }).filter(Placement::is_valid)
}

/// Returns the rigid motion from one placement to another.
pub(crate) fn rigid_way(from: &Placement, to: &Placement) -> Affine3A {
    let affine = |place: &Placement| {
        Affine3A::from_rotation_translation(place.rotation.normalize(), place.translation)
    };
    affine(to) * affine(from).inverse()
}
