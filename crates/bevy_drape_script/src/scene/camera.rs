//! Cameras of scenes.

use bevy::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Positive, Vector};

/// A camera, for pictures and for the window. It does not affect the simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Camera {
    /// Position in metres; (0, 2, 8) by default.
    pub at: Vector,
    /// The point that it looks at, in metres; (0, 1, 0) by default.
    pub look_at: Vector,
    /// Vertical angle of view in degrees; 45 by default.
    pub field_of_view: Positive,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            at: Vector::known(Vec3::new(0.0, 2.0, 8.0)),
            look_at: Vector::known(Vec3::Y),
            field_of_view: Positive::known(45.0),
        }
    }
}
