//! The colour of a body or obstacle.

use bevy::prelude::*;

/// The colour of a body or obstacle, where something is drawn. Those without have the usual one.
#[derive(Component, Clone, Copy, Debug)]
pub struct Paint(pub Color);

impl Paint {
    /// Of these parts of red, green and blue, from 0 to 1.
    pub const fn rgb(red: f32, green: f32, blue: f32) -> Self {
        Self(Color::srgb(red, green, blue))
    }
}
