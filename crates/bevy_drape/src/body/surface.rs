//! The outside of a body.
//!
//! Design: `docs/design/presets.md`.

use bevy::prelude::*;
use drape_solver::BodySettings;

/// Friction, thickness and drag of any body: a rope, a soft body, a rig. On a cloth it counts in place of the same numbers of its
/// [`Fabric`](crate::body::Fabric).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn setup(mut commands: Commands) {
/// let rough = BodySurface { friction: 0.9, ..default() };
/// commands.spawn((Rope::new(Vec3::ZERO, Vec3::NEG_Y, 20), rough));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodySurface {
    /// Coefficient of Coulomb friction, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, for surfaces that do not slide yet. A value below `friction` counts as `friction`.
    pub static_friction: f32,
    /// Distance in metres that the middle of the body keeps from the surfaces that it touches: half its thickness.
    pub thickness: f32,
    /// Drag of still air in 1/s, 0 or more: velocity decays as `exp(-drag t)`, whatever the step.
    pub drag: f32,
}

impl Default for BodySurface {
    fn default() -> Self {
        Self::from(BodySettings::default())
    }
}

/// The [`BodySurface`] of all bodies that have none of their own and are of no fabric: ropes, soft bodies, rigs.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Deref, DerefMut)]
#[reflect(Resource, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DefaultBodySurface(pub BodySurface);

impl BodySurface {
    /// True if it has a field of this name.
    pub(crate) fn has_field(name: &str) -> bool {
        matches!(name, "friction" | "static_friction" | "thickness" | "drag")
    }
}

impl From<BodySettings> for BodySurface {
    fn from(settings: BodySettings) -> Self {
        let BodySettings { friction, static_friction, thickness, drag, .. } = settings;
        Self { friction, static_friction, thickness, drag }
    }
}
