//! Numbers that are painted on the vertices of a mesh.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A channel of the vertex colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum PaintChannel {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Alpha.
    Alpha,
}

impl From<PaintChannel> for drape::render::PaintChannel {
    fn from(channel: PaintChannel) -> Self {
        match channel {
            PaintChannel::Red => Self::Red,
            PaintChannel::Green => Self::Green,
            PaintChannel::Blue => Self::Blue,
            PaintChannel::Alpha => Self::Alpha,
        }
    }
}
