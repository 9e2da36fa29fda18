//! Cameras and lights that look: what is outside of all their views is not written.
//!
//! A mesh is written before Bevy finds what is visible, so the cameras' frusta are asked here. A shadow falls into a picture
//! from outside of it. Hence what was visible to any view in the last frame, that of a light too, is written as well.

use bevy::camera::primitives::{Aabb, Frustum};
use bevy::camera::visibility::{NoCpuCulling, NoFrustumCulling};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// The views of all cameras.
#[derive(SystemParam)]
pub(crate) struct Views<'w, 's> {
    cameras: Query<'w, 's, (&'static Camera, &'static Frustum, Has<NoCpuCulling>)>,
    drawn: Query<'w, 's, (&'static ViewVisibility, Has<NoFrustumCulling>, Has<NoCpuCulling>)>,
}

impl Views<'_, '_> {
    /// True if a view may see an entity within these bounds. In an app without active cameras everything counts as seen.
    pub fn may_see(&self, entity: Entity, bounds: &Aabb, transform: &GlobalTransform) -> bool {
        if self.drawn.get(entity).is_ok_and(|(seen, everywhere, always)| seen.get() || everywhere || always) {
            return true;
        }
        let mut cameras = self.cameras.iter().filter(|(camera, ..)| camera.is_active).peekable();
        let to_world = transform.affine();
        cameras.peek().is_none()
            || cameras.any(|(_, frustum, sees_all)| {
                sees_all || frustum.intersects_obb(bounds, &to_world, true, false)
            })
    }
}
