//! Collision layers: bit masks that decide which things touch.

/// The layers that something belongs to and those that it touches, one bit for each layer.
///
/// Two things touch if each belongs to a layer that the other touches. By default everything belongs to all layers and
/// touches all.
///
/// ```
/// use drape_solver::Layers;
///
/// const CLOAK: u32 = 1;
/// const WORLD: u32 = 2;
/// let cloak = Layers::new(CLOAK, WORLD);
/// assert!(cloak.interact(Layers::new(WORLD, Layers::ALL_LAYERS)));
/// assert!(!cloak.interact(cloak), "cloaks pass through each other");
/// assert!(!cloak.interact(Layers::new(WORLD, WORLD)), "both sides have a say");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Layers {
    /// The layers that it belongs to.
    pub memberships: u32,
    /// The layers that it touches.
    pub filters: u32,
}

impl Layers {
    /// Every layer there is.
    pub const ALL_LAYERS: u32 = u32::MAX;
    /// Belongs to all layers and touches all.
    pub const ALL: Self = Self { memberships: Self::ALL_LAYERS, filters: Self::ALL_LAYERS };
    /// Belongs to no layer and touches nothing.
    pub const NONE: Self = Self { memberships: 0, filters: 0 };

    /// Belongs to the layers `memberships` and touches the layers `filters`.
    pub const fn new(memberships: u32, filters: u32) -> Self {
        Self { memberships, filters }
    }

    /// True if the two touch each other.
    pub const fn interact(self, other: Self) -> bool {
        self.memberships & other.filters != 0 && other.memberships & self.filters != 0
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self::ALL
    }
}
