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

/// Returns the motion from a place as shown at `fraction` between the last two steps to where it is now: steps see an older pose than the
/// one that is drawn. None if both are the same.
pub(crate) fn ahead([before, after]: [Affine3A; 2], fraction: f32, now: Affine3A) -> Option<Affine3A> {
    let [from, to] = [before, after].map(|pose| GlobalTransform::from(pose).compute_transform());
    let shown = if before == after { after } else { between(&from, &to, fraction).compute_affine() };
    let ahead = now * shown.inverse();
    (now != shown && ahead.is_finite()).then_some(ahead)
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
