//! The rules by which bodies and balls fall asleep and are culled.
//!
//! `motion/rest.rs` counts the time at rest: below 2 cm/s, root mean square. `World::finish` (`world_step.rs`) puts to sleep and
//! `Members::cull` (`members.rs`) culls; in the plugin, `sleep/fall_asleep.rs` and `sleep/cull.rs`.

use glam::Vec3;

use crate::world::activity::Activity;
use crate::world::bounds::Bounds;

/// When bodies and balls fall asleep, and when they are culled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActivityRules {
    /// True if what is at rest falls asleep.
    pub sleeping: bool,
    /// Time in seconds that a body, and all that it touches, must stay below the threshold of rest (2 cm/s, root mean
    /// square) before it falls asleep. Shorter than that, a swing may be at its turning point.
    pub sleep_time: f32,
    /// Least corner of the play area in metres. What is wholly outside is culled.
    pub play_area_min: Vec3,
    /// Greatest corner of the play area in metres.
    pub play_area_max: Vec3,
    /// Distance in metres from every viewer beyond which sleepers are culled, until a viewer comes near. Without viewers
    /// nothing is culled for distance.
    pub viewer_distance: f32,
}

impl Default for ActivityRules {
    fn default() -> Self {
        Self {
            sleeping: true,
            sleep_time: 1.0,
            play_area_min: Vec3::splat(-1000.0),
            play_area_max: Vec3::splat(1000.0),
            viewer_distance: 200.0,
        }
    }
}

impl ActivityRules {
    /// True if an island whose slowest member has been still for `still_for` seconds falls asleep.
    pub fn falls_asleep(&self, still_for: f32) -> bool {
        self.sleeping && still_for >= self.sleep_time
    }

    /// True if the box is wholly outside of the play area. False for one that is empty or not finite: such a body is not
    /// lost but refused.
    pub fn is_lost(&self, Bounds { low, high }: Bounds) -> bool {
        let outside = low.cmpgt(self.play_area_max) | high.cmplt(self.play_area_min);
        outside.any() && low.cmple(high).all()
    }

    /// True if the box is too far from every viewer to be kept.
    pub fn is_far(&self, bounds: Bounds, viewers: &[Vec3]) -> bool {
        let is_beyond = |&viewer: &Vec3| bounds.distance_to(viewer) > self.viewer_distance;
        !viewers.is_empty() && viewers.iter().all(is_beyond)
    }

    /// The activity of something at `bounds` that has been still for `still_for` seconds: culled if it cannot be simulated,
    /// left the play area or sleeps far from every viewer; back again if none of these holds any longer.
    pub fn after_culling(
        &self,
        activity: Activity,
        bounds: Bounds,
        is_refused: bool,
        still_for: f32,
        viewers: &[Vec3],
    ) -> Activity {
        match activity {
            _ if is_refused || self.is_lost(bounds) => Activity::Culled,
            Activity::Resting if self.is_far(bounds, viewers) => Activity::Culled,
            Activity::Culled if self.falls_asleep(still_for) => {
                if self.is_far(bounds, viewers) {
                    Activity::Culled
                } else {
                    Activity::Resting
                }
            }
            // It left while it moved, and goes on from there.
            Activity::Culled => Activity::Active,
            same => same,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube_at(x: f32) -> Bounds {
        Bounds::new(Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 1.0, 1.0))
    }

    fn after(activity: Activity, x: f32, still_for: f32, viewers: &[Vec3]) -> Activity {
        ActivityRules::default().after_culling(activity, cube_at(x), false, still_for, viewers)
    }

    #[test]
    fn what_has_left_the_play_area_is_culled_and_comes_back_with_it() {
        assert_eq!(after(Activity::Active, 1001.0, 0.0, &[]), Activity::Culled);
        assert_eq!(after(Activity::Active, 999.5, 0.0, &[]), Activity::Active);
        assert_eq!(after(Activity::Culled, 999.5, 0.0, &[]), Activity::Active);
        assert_eq!(after(Activity::Culled, 999.5, 1.0, &[]), Activity::Resting);
    }

    #[test]
    fn only_sleepers_are_culled_for_distance_and_only_if_every_viewer_is_far() {
        let viewers = [Vec3::X * 300.0, Vec3::X * -300.0];
        assert_eq!(after(Activity::Resting, 0.0, 2.0, &viewers), Activity::Culled);
        assert_eq!(after(Activity::Active, 0.0, 0.0, &viewers), Activity::Active);
        assert_eq!(after(Activity::Resting, 99.5, 2.0, &viewers), Activity::Resting);
        assert_eq!(after(Activity::Resting, 0.0, 2.0, &[]), Activity::Resting);
        assert_eq!(after(Activity::Culled, 0.0, 2.0, &viewers), Activity::Culled);
        assert_eq!(after(Activity::Culled, 0.0, 2.0, &[]), Activity::Resting);
    }

    #[test]
    fn what_is_refused_is_culled_wherever_it_is_and_what_is_held_still_stays() {
        let rules = ActivityRules::default();
        let refused = rules.after_culling(Activity::Frozen, cube_at(0.0), true, 0.0, &[]);
        assert_eq!(refused, Activity::Culled);
        assert_eq!(after(Activity::Frozen, 0.0, 5.0, &[Vec3::X * 1e4]), Activity::Frozen);
        let nowhere = Bounds::new(Vec3::INFINITY, Vec3::NEG_INFINITY);
        assert!(!rules.is_lost(nowhere) && !rules.is_lost(Bounds::new(Vec3::NAN, Vec3::NAN)));
    }

    #[test]
    fn nothing_falls_asleep_before_its_time_or_with_sleeping_off() {
        let rules = ActivityRules::default();
        assert!(rules.falls_asleep(1.0) && !rules.falls_asleep(0.99));
        assert!(!ActivityRules { sleeping: false, ..rules }.falls_asleep(1e9));
    }
}
