//! A camera that circles about a point: right mouse button and wheel.

use core::f32::consts::FRAC_PI_2;

use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll, MouseScrollUnit};
use bevy::prelude::*;

/// Turn in radians for a pointer's move of one pixel.
const TURN: f32 = 0.005;
/// The factor by which a notch of the wheel changes the distance.
const ZOOM: f32 = 0.9;
/// A notch of the wheel in pixels, where the wheel counts in those.
const NOTCH: f32 = 40.0;

/// A camera that looks at a point from a direction and a distance.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// The point that the camera looks at.
    pub target: Vec3,
    /// Angle about the vertical in radians: 0 looks along -Z, and grows as the camera goes to the right.
    pub yaw: f32,
    /// Angle above the target's horizon in radians.
    pub pitch: f32,
    /// Distance from the target in metres.
    pub distance: f32,
}

impl Orbit {
    /// The place of the camera.
    pub fn transform(&self) -> Transform {
        let turn = Quat::from_rotation_y(self.yaw) * Quat::from_rotation_x(-self.pitch);
        let eye = self.target + turn * Vec3::Z * self.distance;
        // Not below the ground.
        Transform::from_translation(eye.with_y(eye.y.max(0.1))).looking_at(self.target, Vec3::Y)
    }

    /// Turns with a pointer that moves so many pixels.
    pub fn turn(&mut self, pixels: Vec2) {
        self.yaw -= pixels.x * TURN;
        self.pitch = (self.pitch + pixels.y * TURN).clamp(-0.3, FRAC_PI_2 - 0.05);
    }

    /// Changes the distance by a factor.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(1.5, 40.0);
    }
}

/// Moves [`Orbit`] cameras.
pub struct OrbitPlugin;

impl Plugin for OrbitPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, orbit);
    }
}

fn orbit(
    mut cameras: Query<(&mut Orbit, &mut Transform)>,
    buttons: Res<ButtonInput<MouseButton>>,
    motion: Res<AccumulatedMouseMotion>,
    scroll: Res<AccumulatedMouseScroll>,
) {
    let turn = if buttons.pressed(MouseButton::Right) { motion.delta } else { Vec2::ZERO };
    let notches = match scroll.unit {
        MouseScrollUnit::Line => scroll.delta.y,
        MouseScrollUnit::Pixel => scroll.delta.y / NOTCH,
    };
    if turn == Vec2::ZERO && notches == 0.0 {
        return;
    }
    for (mut orbit, mut transform) in &mut cameras {
        orbit.turn(turn);
        orbit.zoom(ZOOM.powf(notches));
        *transform = orbit.transform();
    }
}
