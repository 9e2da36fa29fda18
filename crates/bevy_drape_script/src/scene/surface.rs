//! The outside of bodies.

use bevy_drape::prelude::BodySurface;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::NonNegative;

/// Friction, thickness and drag of a body. Fields that a body leaves out come from the scene's settings, and those that
/// these leave out from the plugin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Surface {
    /// Coulomb friction coefficient. Two surfaces in contact use the mean of theirs.
    pub friction: Option<NonNegative>,
    /// Coefficient of static friction; below `friction` it counts as `friction`.
    pub static_friction: Option<NonNegative>,
    /// Distance in metres between the middle of the cloth and the surfaces that it touches.
    pub thickness: Option<NonNegative>,
    /// Drag of still air in 1/s: velocity decays as exp(-drag t).
    pub drag: Option<NonNegative>,
}

impl Surface {
    /// The plugin's surface: this, with `base` for fields that are left out.
    pub fn over(&self, base: BodySurface) -> BodySurface {
        BodySurface {
            friction: self.friction.map_or(base.friction, NonNegative::get),
            static_friction: self.static_friction.map_or(base.static_friction, NonNegative::get),
            thickness: self.thickness.map_or(base.thickness, NonNegative::get),
            drag: self.drag.map_or(base.drag, NonNegative::get),
        }
    }
}
