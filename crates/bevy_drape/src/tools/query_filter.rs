//! The bodies that a query is about.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;

use crate::body::layers::DrapeLayers;

/// The bodies that a [`DrapeSpatialQuery`](crate::spatial_query::DrapeSpatialQuery) is about: all by default.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::spatial_query::{DrapeQueryFilter, DrapeSpatialQuery};
///
/// const CURTAINS: u32 = 1 << 3;
///
/// #[derive(Component)]
/// struct Armoured;
///
/// fn aim(bodies: DrapeSpatialQuery, mine: Single<Entity, With<Cloth>>, armour: Query<(), With<Armoured>>) {
///     let is_soft = |body| !armour.contains(body);
///     let filter = DrapeQueryFilter::from_mask(CURTAINS).with_excluded_entities([*mine]).with_predicate(&is_soft);
///     let target = bodies.cast_ray(Ray3d::new(Vec3::Y, Dir3::NEG_Z), 50.0, &filter);
/// #   assert!(target.is_none());
/// }
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, DrapePlugins::default()));
/// # app.world_mut().spawn(Cloth::new(1.0, 1.0));
/// # app.add_systems(Update, aim).update();
/// ```
#[derive(Clone)]
pub struct DrapeQueryFilter<'a> {
    /// Layers, one bit each: bodies that belong to any of these ([`DrapeLayers::memberships`]). Bodies without
    /// [`DrapeLayers`] belong to all.
    pub mask: u32,
    /// Bodies that are left out.
    pub excluded_entities: EntityHashSet,
    /// Only bodies for which this is true.
    pub predicate: Option<&'a (dyn Fn(Entity) -> bool + Sync)>,
}

impl Default for DrapeQueryFilter<'_> {
    fn default() -> Self {
        Self::from_mask(DrapeLayers::ALL_LAYERS)
    }
}

impl<'a> DrapeQueryFilter<'a> {
    /// Bodies that belong to any of these layers.
    pub fn from_mask(mask: u32) -> Self {
        Self { mask, excluded_entities: EntityHashSet::new(), predicate: None }
    }

    /// All bodies but these.
    pub fn from_excluded_entities(entities: impl IntoIterator<Item = Entity>) -> Self {
        Self::default().with_excluded_entities(entities)
    }

    /// The same, for bodies that belong to any of these layers.
    #[must_use]
    pub fn with_mask(self, mask: u32) -> Self {
        Self { mask, ..self }
    }

    /// The same, without these bodies.
    #[must_use]
    pub fn with_excluded_entities(self, entities: impl IntoIterator<Item = Entity>) -> Self {
        Self { excluded_entities: entities.into_iter().collect(), ..self }
    }

    /// The same, for bodies of which `predicate` is true.
    #[must_use]
    pub fn with_predicate(self, predicate: &'a (dyn Fn(Entity) -> bool + Sync)) -> Self {
        Self { predicate: Some(predicate), ..self }
    }

    /// True if the filter lets a body with these layers through.
    pub(crate) fn admits(&self, body: Entity, layers: DrapeLayers) -> bool {
        layers.memberships & self.mask != 0
            && !self.excluded_entities.contains(&body)
            && self.predicate.is_none_or(|predicate| predicate(body))
    }
}
