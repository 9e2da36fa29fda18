//! The plan of shots, by closed forms.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::cannon::Cannon;
use bevy_drape::prelude::*;
use drape_solver::motion::ballistics;

use crate::cannon_demo::scene::{MUZZLE, cannon_ball};

/// Time of the first shot in seconds.
pub const FIRST_SHOT: f64 = 1.0;
/// Time between shots in seconds.
pub const SHOT_INTERVAL: f64 = 3.0;

/// Targets in metres and muzzle speeds in m/s of the plan, which starts over after the last.
const PLAN: [(Vec3, f32); 5] = [
    (Vec3::new(0.0, 1.5, 0.0), 15.0),
    (Vec3::new(-1.0, 1.2, 0.0), 18.0),
    (Vec3::new(0.9, 1.8, 0.0), 12.0),
    (Vec3::new(0.3, 1.3, 0.0), 25.0),
    (Vec3::new(-0.5, 1.0, 0.0), 21.0),
];

/// One shot of the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Simulated time in seconds.
    pub time: f64,
    /// Angle above the horizon in radians.
    pub elevation: f32,
    /// Angle to the left in radians.
    pub azimuth: f32,
    /// Speed at the muzzle in m/s.
    pub speed: f32,
}

impl Shot {
    /// Shot number `index`, from 0.
    pub fn planned(index: u32) -> Self {
        let (target, speed) = PLAN[index as usize % PLAN.len()];
        let time = FIRST_SHOT + SHOT_INTERVAL * f64::from(index);
        let way = target.as_dvec3() - MUZZLE.as_dvec3();
        let distance = (way.x * way.x + way.z * way.z).sqrt();
        let gravity = f64::from(-DrapeGravity::default().y);
        // All targets are in range.
        let elevation =
            ballistics::elevation_for(distance, way.y, f64::from(speed), gravity).unwrap_or_default();
        let azimuth = libm::atan2(-way.x, -way.z);
        Self { time, elevation: elevation as f32, azimuth: azimuth as f32, speed }
    }

    /// Points `cannon` for this shot.
    pub fn aim(&self, cannon: &mut Cannon) {
        cannon.elevation = self.elevation;
        cannon.azimuth = self.azimuth;
        cannon.muzzle_speed = self.speed;
    }

    /// Velocity at the muzzle in m/s.
    pub fn velocity(&self) -> DVec3 {
        ballistics::direction(f64::from(self.elevation), f64::from(self.azimuth)) * f64::from(self.speed)
    }

    /// Seconds from the shot to the touch of the resting curtain's plane, ball radius included.
    pub fn predicted_hit_time(&self) -> f64 {
        f64::from(MUZZLE.z - cannon_ball().radius) / -self.velocity().z
    }

    /// The ball's centre in metres, `time` seconds after the shot.
    pub fn position_at(&self, time: f64) -> DVec3 {
        let gravity = DrapeGravity::default().as_dvec3();
        ballistics::position_at(MUZZLE.as_dvec3(), self.velocity(), gravity, time)
    }
}
