//! The examples, and the one that is shown.

use bevy::prelude::*;

use crate::feature::example::Feature;

/// The examples, and the index of the one that is shown.
#[derive(Resource)]
pub struct Showcase {
    /// With their names.
    pub features: &'static [(&'static str, Feature)],
    /// Index of the one that is shown.
    pub current: usize,
    /// True if the example is to begin in the next frame.
    pub is_due: bool,
}

impl Showcase {
    /// The example that is shown.
    pub fn feature(&self) -> &Feature {
        &self.features[self.current].1
    }
}
