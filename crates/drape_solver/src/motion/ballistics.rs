//! Closed forms of flight without drag, for aiming and for checking the solver.
//!
//! Design: `docs/design/integration.md`.

use glam::DVec3;

/// Position after `time` seconds of free flight from `start` (m) with `velocity` (m/s) under `gravity` (m/s^2).
pub fn position_at(start: DVec3, velocity: DVec3, gravity: DVec3, time: f64) -> DVec3 {
    start + velocity * time + gravity * (0.5 * time * time)
}

/// The flatter elevation (radians above the horizon) at which a shot of `speed` (m/s) meets a point `distance`
/// metres away and `height` metres up, in gravity of `g` (m/s^2, above 0). `None` if it is out of range.
///
/// The trajectory `height = distance tan(a) - g distance^2 (1 + tan(a)^2) / (2 speed^2)`, solved for `tan(a)`.
pub fn elevation_for(distance: f64, height: f64, speed: f64, g: f64) -> Option<f64> {
    let v2 = speed * speed;
    let discriminant = v2 * v2 - g * (g * distance * distance + 2.0 * height * v2);
    if !(distance > 0.0 && discriminant >= 0.0) {
        return None;
    }
    Some(libm::atan((v2 - discriminant.sqrt()) / (g * distance)))
}

/// Unit vector of a shot at `elevation` above the horizon and `azimuth` about +Y (radians); azimuth 0 points
/// along -Z, as Bevy's `forward` does, and grows to the left.
pub fn direction(elevation: f64, azimuth: f64) -> DVec3 {
    let level = libm::cos(elevation);
    DVec3::new(-level * libm::sin(azimuth), libm::sin(elevation), -level * libm::cos(azimuth))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solved_elevation_meets_the_target() {
        let (distance, height, speed, g) = (12.0, 1.3, 18.0, 9.81);
        let elevation = elevation_for(distance, height, speed, g).expect("in range");
        let velocity = direction(elevation, 0.0) * speed;
        let time = distance / -velocity.z;
        let end = position_at(DVec3::ZERO, velocity, DVec3::NEG_Y * g, time);
        assert!((end - DVec3::new(0.0, height, -distance)).length() < 1e-9);
        assert_eq!(elevation_for(100.0, 0.0, 10.0, g), None);
    }
}
