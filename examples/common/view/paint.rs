//! The colour of a body or obstacle.

use bevy::prelude::*;

/// The colour of a body, ball or obstacle, in a window and in pictures. Those without have the usual one. Black by default.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Paint {
    /// Red, green and blue in sRGB, from 0 to 1. Not a `Color`: an example that draws nothing compiles no colours.
    rgb: [f32; 3],
}

impl Paint {
    /// A colour of this much red, green and blue in sRGB, from 0 to 1.
    pub const fn rgb(red: f32, green: f32, blue: f32) -> Self {
        Self { rgb: [red, green, blue] }
    }

    /// Bevy's colour.
    #[cfg(feature = "render")]
    pub fn color(&self) -> Color {
        Color::srgb_from_array(self.rgb)
    }
}
