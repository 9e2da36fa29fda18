//! The scene: a curtain, the ground, and a cannon twelve metres away.
//!
//! `assets/scenes/cannon.scene.ron` describes the same scene for the scene runner; a test compares the two.

use bevy::prelude::*;
use bevy_drape::prelude::*;

/// Length of a step in seconds.
pub const STEP: f64 = 1.0 / 60.0;

/// Width and height of the curtain in metres.
pub const CURTAIN_SIZE: Vec2 = Vec2::new(4.0, 3.0);
/// Height of the curtain's centre above the ground in metres. The curtain hangs in the plane z = 0.
const CURTAIN_HEIGHT: f32 = 1.8;
/// Drag of the curtain in 1/s: it hangs quietly again between two shots.
pub const CURTAIN_DRAG: f32 = 2.0;
/// Position of the muzzle in metres.
pub const MUZZLE: Vec3 = Vec3::new(0.0, 1.0, 12.0);

/// The options of the scene.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct CannonScene {
    /// Particles of the curtain in a row and in a column.
    pub particles: UVec2,
    /// Substeps of the curtain in a step.
    pub substeps: u32,
    /// Relaxation iterations in a substep.
    pub iterations: u32,
    /// Contact of the curtain with itself.
    pub self_contact: SelfContact,
    /// Number of shots; 0 leaves the cannon to the player.
    pub shots: u32,
}

impl Default for CannonScene {
    fn default() -> Self {
        Self {
            particles: UVec2::new(64, 48),
            substeps: 16,
            iterations: 2,
            self_contact: SelfContact::Off,
            shots: 5,
        }
    }
}

impl CannonScene {
    /// The curtain as it is spawned.
    pub fn curtain(&self) -> impl Bundle {
        (
            Curtain,
            self.cloth(),
            self.fabric(),
            self.settings(),
            Transform::from_xyz(0.0, CURTAIN_HEIGHT, 0.0),
            Name::new("curtain"),
        )
    }

    /// The cloth of the curtain.
    pub fn cloth(&self) -> Cloth {
        Cloth { size: CURTAIN_SIZE, particles: self.particles, ..default() }
    }

    /// The fabric of the curtain.
    pub fn fabric(&self) -> Fabric {
        Fabric { shear_stiffness: 0.3, drag: CURTAIN_DRAG, ..default() }
    }

    /// The settings that the curtain is solved with.
    pub fn settings(&self) -> SolverSettings {
        let Self { substeps, iterations, self_contact, .. } = *self;
        SolverSettings { substeps, iterations, self_contact, ..default() }
    }
}

/// Height of the curtain's lower edge above the ground in metres.
pub fn curtain_clearance() -> f32 {
    CURTAIN_HEIGHT - 0.5 * CURTAIN_SIZE.y
}

/// The cannon ball. The ground is a lawn, on which it comes to rest in some ten seconds.
pub fn cannon_ball() -> Projectile {
    Projectile { radius: 0.15, mass: 2.0, rolling_resistance: 0.1, ..default() }
}

/// Marks the curtain.
#[derive(Component)]
pub struct Curtain;

/// Marks the ground.
#[derive(Component)]
pub struct Ground;
