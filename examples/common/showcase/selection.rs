//! The examples, and the one that is shown.

use bevy::prelude::*;

use crate::feature::example::Feature;

/// The examples, and which of them is shown.
#[derive(Resource)]
pub struct Showcase {
    /// With their names.
    pub features: &'static [(&'static str, Feature)],
    /// Index of the one that is shown.
    pub current: usize,
    /// True if that is to begin with the next frame.
    pub is_due: bool,
}

impl Showcase {
    /// The one that is shown.
    pub fn feature(&self) -> &Feature {
        &self.features[self.current].1
    }
}
