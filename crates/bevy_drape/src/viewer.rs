//! Viewers, and the distances of bodies from them.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::viewer::Viewer;
//!
//! fn setup(mut commands: Commands) {
//!     // Beside your camera. Level of detail and culling ask how far the nearest viewer is.
//!     commands.spawn((Transform::from_xyz(0.0, 2.0, 6.0), Viewer));
//! }
//! # App::new().add_systems(Startup, setup).update();
//! ```

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

/// Marks an entity, usually the camera, whose distance decides the culling and the level of detail of bodies.
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
#[require(Transform)]
pub struct Viewer;

/// All viewers, and if the view has changed since the last step.
#[derive(SystemParam)]
pub(crate) struct View<'w, 's> {
    viewers: Query<'w, 's, (Ref<'static, GlobalTransform>, Ref<'static, Viewer>)>,
    count: Local<'s, usize>,
}

impl View<'_, '_> {
    /// True if a viewer has come, gone or moved since the last call.
    pub fn is_new(&mut self) -> bool {
        let count = self.viewers.iter().count();
        let known = core::mem::replace(&mut *self.count, count);
        let is_moved =
            |(place, viewer): (Ref<GlobalTransform>, Ref<Viewer>)| place.is_changed() || viewer.is_added();
        count != known || self.viewers.iter().any(is_moved)
    }

    /// Distance from the nearest viewer to a box in metres; 0 without viewers.
    pub fn distance(&self, bounds: Bounds) -> f32 {
        let nearest = self.places().map(|eye| bounds.distance_to(eye)).min_by(f32::total_cmp);
        nearest.unwrap_or(0.0)
    }

    /// Places of all viewers, in metres.
    pub fn places(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.viewers.iter().map(|(viewer, _)| viewer.translation())
    }
}
