//! Cameras and lights that look: what none of them sees is not written.
//!
//! A mesh is written before Bevy finds what is visible, so it is asked here whether a camera may see it. Who casts a shadow into a picture may
//! itself be outside: so whatever was visible to any view in the last frame is written, too.

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
