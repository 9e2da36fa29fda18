//! Ropes.

use bevy_drape as drape;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::{Fraction, Layers, NonNegative, Positive, Solver, Surface, Tearable, Vector, Whole};

/// A rope, cable or chain. It begins straight between two points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Rope {
    /// First end in metres; (0, 0, 0) by default.
    pub start: Vector,
    /// Last end in metres; (0, -1, 0) by default.
    pub end: Vector,
    /// Number of particles, 2 to 65536; 32 by default.
    pub particles: Whole<2, 65536>,
    /// Mass per length in kg/m; 0.1 by default.
    pub linear_density: Positive,
    /// Additional mass of its last end in kg; 0 by default.
    pub end_mass: NonNegative,
    /// Stiffness against stretching, 0 to 1.
    pub stretch_stiffness: Fraction,
    /// Stiffness against bending, 0 (limp, the default) to 1.
    pub bend_stiffness: Fraction,
    /// Damping along the links in 1/s.
    pub damping: NonNegative,
    /// True to fix the first end; true by default.
    pub pin_start: bool,
    /// True to fix the last end; false by default.
    pub pin_end: bool,
    /// Velocity of its free particles at the start in m/s; (0, 0, 0) by default.
    pub velocity: Vector,
    /// Tearing limits; never tears by default.
    pub tearable: Option<Tearable>,
    /// Solver settings; those of the scene by default.
    pub solver: Solver,
    /// Its surface; that of the scene by default.
    pub surface: Surface,
    /// Its collision layers and those that it touches; all by default.
    pub layers: Option<Layers>,
    /// True to report its contacts; false by default.
    pub contacts: bool,
    /// Name of its material, for pictures; none by default.
    pub material: Option<String>,
    /// True to exist from the start, false to wait for `Spawn`; true by default.
    pub present: bool,
}

impl Default for Rope {
    fn default() -> Self {
        let plain = drape::build::Rope::default();
        Self {
            start: Vector::known(plain.start),
            end: Vector::known(plain.end),
            particles: Whole::known(plain.particles),
            linear_density: Positive::known(plain.linear_density),
            end_mass: NonNegative::known(plain.end_mass),
            stretch_stiffness: Fraction::known(plain.stretch_stiffness),
            bend_stiffness: Fraction::known(plain.bend_stiffness),
            damping: NonNegative::known(plain.damping),
            pin_start: plain.pin_start,
            pin_end: plain.pin_end,
            velocity: Vector::default(),
            tearable: None,
            solver: Solver::default(),
            surface: Surface::default(),
            layers: None,
            contacts: false,
            material: None,
            present: true,
        }
    }
}

impl From<&Rope> for drape::build::Rope {
    fn from(rope: &Rope) -> Self {
        Self {
            start: rope.start.get(),
            end: rope.end.get(),
            particles: rope.particles.get(),
            linear_density: rope.linear_density.get(),
            end_mass: rope.end_mass.get(),
            stretch_stiffness: rope.stretch_stiffness.get(),
            bend_stiffness: rope.bend_stiffness.get(),
            damping: rope.damping.get(),
            pin_start: rope.pin_start,
            pin_end: rope.pin_end,
        }
    }
}
