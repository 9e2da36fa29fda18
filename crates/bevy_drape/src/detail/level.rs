//! Level of detail: less work for distant bodies.

use bevy::prelude::*;
use thiserror::Error;

/// A body falls back to a level only beyond the distance of the level times one plus this, so that it does not change
/// to and fro at the border.
const HYSTERESIS: f32 = 0.1;

/// Spends less on a body with growing distance from the nearest [`Viewer`](crate::viewer::Viewer): fewer substeps, then
/// fewer particles, then no simulation. Without viewers every body is simulated in full.
///
/// The default levels are for a window 1080 pixels high: a change from one to the next moves the picture of a flag by
/// less than two pixels, less than its own motion from frame to frame. Coarse cloth weighs, hangs and stretches like
/// the fine one.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::detail::LevelOfDetail;
/// use bevy_drape::viewer::Viewer;
///
/// fn setup(mut commands: Commands) {
///     commands.spawn((Camera3d::default(), Viewer));
///     commands.spawn((Cloth::new(1.5, 1.0).with_pins(ClothPins::Left), LevelOfDetail::default()));
/// }
/// # #[derive(Component, Default)] struct Camera3d;
/// ```
///
/// [Coarseness](DetailLevel::coarseness) is for [`Cloth`](crate::build::cloth::Cloth). A cloth keeps its particles
/// while something refers to them by index: an [`Attachment`](crate::attach::attachment::Attachment), a
/// [`Grab`](crate::attach::grab::Grab), a follower
/// ([`FollowParticle`](crate::attach::follow_particle::FollowParticle)), motion limits, backstops, drives, pins set by
/// hand, [`Tearable`](crate::body::tearable::Tearable), or a cut. On the GPU it keeps them too. A resting cloth costs
/// nothing and is not made coarser.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(CurrentDetail)]
pub struct LevelOfDetail {
    /// Levels by growing distance. Nearer than the first, the body is simulated in full.
    pub levels: Vec<DetailLevel>,
    /// Factor on the distances of all levels, above 0; 1 by default. Use more for large bodies, and for those that
    /// players look at.
    pub importance: f32,
}

/// Work spent on a body from a distance on.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct DetailLevel {
    /// Distance from the nearest viewer to the body's box in metres, 0 or more.
    pub distance: f32,
    /// The most substeps, at least 1.
    pub most_substeps: u32,
    /// Keeps about one in this many particles of each row and column of a cloth, at least 1. The edges stay.
    pub coarseness: u32,
    /// True to stop the body: [`Activity::Frozen`](crate::body::activity::Activity::Frozen).
    pub frozen: bool,
}

impl Default for DetailLevel {
    /// Full detail.
    fn default() -> Self {
        Self { distance: 0.0, most_substeps: u32::MAX, coarseness: 1, frozen: false }
    }
}

impl Default for LevelOfDetail {
    /// Half the particles per side from 25 m on, a quarter and half the substeps from 60 m on, frozen from 150 m on.
    fn default() -> Self {
        let level = |distance, most_substeps, coarseness, frozen| DetailLevel {
            distance,
            most_substeps,
            coarseness,
            frozen,
        };
        Self {
            levels: vec![level(25.0, 8, 2, false), level(60.0, 4, 4, false), level(150.0, 4, 4, true)],
            importance: 1.0,
        }
    }
}

/// Faults of a [`LevelOfDetail`].
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DetailError {
    /// The importance is not a number above 0.
    #[error("importance must be above 0 and finite, but is {0}")]
    BadImportance(f32),
    /// A distance is negative, not finite, or less than that of the level before.
    #[error("levels[{0}].distance is {1}: distances must be finite, 0 or more, and grow from level to level")]
    BadDistance(usize, f32),
    /// A count is 0.
    #[error("levels[{0}].{1} is 0: it must be 1 or more")]
    Zero(usize, &'static str),
}

impl LevelOfDetail {
    /// Checks the ranges that the fields state.
    ///
    /// # Errors
    /// [`DetailError`] naming the first field that is out of its range.
    pub fn validate(&self) -> Result<(), DetailError> {
        if !(self.importance > 0.0 && self.importance.is_finite()) {
            return Err(DetailError::BadImportance(self.importance));
        }
        let mut least = 0.0;
        for (i, level) in self.levels.iter().enumerate() {
            if !(level.distance >= least && level.distance.is_finite()) {
                return Err(DetailError::BadDistance(i, level.distance));
            }
            least = level.distance;
            for (field, value) in [("most_substeps", level.most_substeps), ("coarseness", level.coarseness)] {
                if value == 0 {
                    return Err(DetailError::Zero(i, field));
                }
            }
        }
        Ok(())
    }

    /// Returns the level at `distance` metres, coming from level `current`.
    pub(crate) fn level_at(&self, distance: f32, current: usize) -> usize {
        let begun =
            |distance: f32| self.levels.partition_point(|level| level.distance * self.importance <= distance);
        current.clamp(begun(distance / (1.0 + HYSTERESIS)), begun(distance))
    }

    /// The level of a body at `distance` metres, coming from level `current`, and what is spent there: 0 is full detail, which a body without the
    /// component has, and `n` the `n`-th of [`levels`](Self::levels).
    pub(crate) fn spent_at(detail: Option<&Self>, distance: f32, current: usize) -> (usize, DetailLevel) {
        let level = detail.map_or(0, |detail| detail.level_at(distance, current));
        let of_level = |detail: &Self| level.checked_sub(1).and_then(|i| detail.levels.get(i).copied());
        (level, detail.and_then(of_level).unwrap_or_default())
    }
}

/// Current level of a body. Comes with [`LevelOfDetail`], and is written by the plugin.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CurrentDetail {
    pub(crate) level: usize,
    pub(crate) coarseness: u32,
    pub(crate) most_substeps: u32,
}

impl Default for CurrentDetail {
    /// Full detail.
    fn default() -> Self {
        Self { level: 0, coarseness: 1, most_substeps: u32::MAX }
    }
}

impl CurrentDetail {
    /// Returns 0 for full detail, `n` for the `n`-th of [`LevelOfDetail::levels`].
    pub fn level(&self) -> usize {
        self.level
    }

    /// Returns the current coarseness. It lags behind the level, since only some cloths change in each step.
    pub fn coarseness(&self) -> u32 {
        self.coarseness
    }

    /// Limits the substeps of `settings` to those of the level.
    pub(crate) fn limit(self, settings: drape_solver::BodySettings) -> drape_solver::BodySettings {
        drape_solver::BodySettings { substeps: settings.substeps.min(self.most_substeps), ..settings }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_begin_at_their_distance_and_end_a_tenth_nearer() {
        let detail = LevelOfDetail::default();
        assert_eq!(detail.level_at(24.9, 0), 0);
        // Just beyond the border it stays what it was.
        assert_eq!([0, 1, 2].map(|current| detail.level_at(26.0, current)), [0, 1, 1]);
        assert_eq!(detail.level_at(27.6, 0), 1);
        assert_eq!(detail.level_at(24.9, 1), 0);
        assert_eq!(detail.level_at(1e9, 0), 3);
        assert_eq!(detail.level_at(0.0, 3), 0);
    }

    #[test]
    fn twice_as_important_is_as_good_from_twice_as_far() {
        let detail = LevelOfDetail { importance: 2.0, ..default() };
        assert_eq!(detail.level_at(49.0, 0), 0);
        assert_eq!(detail.level_at(56.0, 0), 1);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let with = |change: fn(&mut LevelOfDetail)| {
            let mut detail = LevelOfDetail::default();
            change(&mut detail);
            detail.validate().expect_err("out of range").to_string()
        };
        assert!(with(|detail| detail.importance = f32::NAN).contains("importance"));
        assert!(with(|detail| detail.levels[1].distance = 10.0).contains("levels[1].distance is 10"));
        assert!(with(|detail| detail.levels[2].distance = f32::INFINITY).contains("levels[2].distance"));
        assert!(with(|detail| detail.levels[0].coarseness = 0).contains("levels[0].coarseness"));
        assert!(with(|detail| detail.levels[0].most_substeps = 0).contains("levels[0].most_substeps"));
        assert_eq!(LevelOfDetail::default().validate(), Ok(()));
    }
}
