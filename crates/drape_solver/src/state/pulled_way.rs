//! The way that pins, a pose and a frame take particles in the coming step, beyond that of their velocities.

use crate::state::particles::Particles;

impl Particles {
    /// Upper bound in metres on the way that pins, limits on motion, backstops, drives and the frame take a particle in the
    /// coming step of `dt` seconds, beyond the way of its velocity.
    pub fn pulled_way(&self, dt: f32) -> f32 {
        let edited =
            if self.disturbed { self.pin_way().max(self.pose_way()) + self.frame_way() } else { 0.0 };
        edited + self.drive_way(dt)
    }

    /// The part of pins.
    pub(crate) fn pin_way(&self) -> f32 {
        let pins = self.pin_targets.iter();
        let ways = pins.map(|&(i, target)| target.distance(self.origin + self.position.get(i as usize)));
        ways.fold(0.0, f32::max)
    }

    /// The part of limits and backstops.
    pub(crate) fn pose_way(&self) -> f32 {
        let tied = self.layout.slots().filter(|_| !self.pose.is_empty());
        tied.map(|slot| self.pose.pull(slot, self.position.get(slot))).fold(0.0, f32::max)
    }

    /// The part of the frame.
    pub(crate) fn frame_way(&self) -> f32 {
        self.frame.as_ref().map_or(0.0, |motion| motion.reach(self.bounds()))
    }

    /// The part of drives.
    pub(crate) fn drive_way(&self, dt: f32) -> f32 {
        let drives = &self.pose.drives;
        if drives.is_empty() {
            return 0.0;
        }
        let ways = self.layout.slots().filter_map(|slot| {
            let angle = drives.get(slot)?.angular_frequency * dt;
            let [now, next] = drives.place.get(slot);
            // An undamped drive takes the particle as far beyond its place.
            Some(next.distance(self.position.get(slot)) * (angle * angle).min(2.0) + now.distance(next))
        });
        ways.fold(0.0, f32::max)
    }
}
