//! Collision layers.

use bevy::prelude::*;
use drape_solver::Layers;

/// The layers that a body, ball or obstacle belongs to, and those that it touches: one bit each.
///
/// Two touch if each belongs to a layer that the other touches. An entity without this component belongs to all layers
/// and touches all. A sleeping body wakes when its layers change.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// const CLOAK: u32 = 1 << 0;
/// const WORLD: u32 = 1 << 1;
///
/// fn dress(mut commands: Commands) {
///     // Touches the world, but no other cloak, and no ball that is not of the world.
///     commands.spawn((Cloth::new(1.0, 1.5), DrapeLayers::new(CLOAK, WORLD)));
///     commands.spawn((Obstacle::ground(), DrapeLayers::new(WORLD, DrapeLayers::ALL_LAYERS)));
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DrapeLayers {
    /// The layers that it belongs to.
    pub memberships: u32,
    /// The layers that it touches.
    pub filters: u32,
}

impl DrapeLayers {
    /// Every layer there is.
    pub const ALL_LAYERS: u32 = u32::MAX;

    /// Belongs to the layers `memberships` and touches the layers `filters`.
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self { memberships, filters }
    }

    /// Returns the solver's layers of an entity with or without this component.
    pub(crate) fn of(layers: Option<&Self>) -> Layers {
        let Self { memberships, filters } = layers.copied().unwrap_or_default();
        Layers { memberships, filters }
    }
}

impl Default for DrapeLayers {
    /// Belongs to all layers and touches all.
    fn default() -> Self {
        Self::new(Self::ALL_LAYERS, Self::ALL_LAYERS)
    }
}
