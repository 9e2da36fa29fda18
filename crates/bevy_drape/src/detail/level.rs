//! Less work for what is far away.

use bevy::prelude::*;
use thiserror::Error;

/// How much farther than a level begins a body must be to fall back to it, so that it does not change to and fro at the border.
const HYSTERESIS: f32 = 0.1;

/// Spends the less on a body the farther it is from the nearest [`Viewer`](crate::viewer::Viewer): fewer substeps, then
/// fewer particles, then none. Without viewers all is done in full.
///
/// The default levels are for a window 1080 pixels high: a change from one to the next moves what is seen of a flag by less than two
/// pixels, which is less than it moves itself from frame to frame. Coarser cloth weighs, hangs and stretches as the fine one does.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands.spawn((Camera3d::default(), Viewer));
///     commands.spawn((Cloth::new(1.5, 1.0).with_pins(ClothPins::Left), LevelOfDetail::default()));
/// }
/// # #[derive(Component, Default)] struct Camera3d;
/// ```
///
/// [Coarseness](DetailLevel::coarseness) is for [`Cloth`](crate::build::cloth::Cloth). A cloth keeps its particles while somebody knows them by
/// their index or their pins: while it has an [`Attachment`](crate::attach::attachment::Attachment), a [`Grab`](crate::attach::grab::Grab), a follower
/// ([`FollowParticle`](crate::attach::follow_particle::FollowParticle)), limits of motion, pins that were set by hand, or may tear
/// ([`Tearable`](crate::body::tearable::Tearable)) or has been cut. What rests is not made coarser, as it costs nothing.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(CurrentDetail)]
pub struct LevelOfDetail {
    /// From near to far, by growing distance. Nearer than the first, the body is simulated in full.
    pub levels: Vec<DetailLevel>,
    /// How many times as far the body may be for the same level, above 0; 1 by default. More for what is large, or what a player
    /// looks at.
    pub importance: f32,
}

/// What is spent on a body from a distance on.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub struct DetailLevel {
    /// Distance from the nearest viewer to the body's box in metres, 0 or more.
    pub distance: f32,
    /// Substeps at most, from 1 on.
    pub most_substeps: u32,
    /// Of the particles of a row and of a column of a cloth, about one in this many is left, from 1 on. Its edges stay.
    pub coarseness: u32,
    /// Whether the body stands still: [`Activity::Frozen`](crate::body::activity::Activity::Frozen).
    pub frozen: bool,
}

impl Default for DetailLevel {
    /// In full.
    fn default() -> Self {
        Self { distance: 0.0, most_substeps: u32::MAX, coarseness: 1, frozen: false }
    }
}

impl Default for LevelOfDetail {
    /// Half the particles a side from 25 m on, a quarter with half the substeps from 60 m on, frozen from 150 m on.
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

/// What is wrong with a [`LevelOfDetail`].
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum DetailError {
    /// The importance is no number above 0.
    #[error("importance must be above 0 and finite, but is {0}")]
    BadImportance(f32),
    /// A distance is less than that of the level before, or 0, or no number.
    #[error("levels[{0}].distance is {1}: distances must be finite, 0 or more, and grow from level to level")]
    BadDistance(usize, f32),
    /// Nothing would be left.
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

    /// The number of levels that have begun at `distance` (metres), coming from `current`.
    pub(crate) fn level_at(&self, distance: f32, current: usize) -> usize {
        let begun =
            |distance: f32| self.levels.partition_point(|level| level.distance * self.importance <= distance);
        current.clamp(begun(distance / (1.0 + HYSTERESIS)), begun(distance))
    }

    /// What is spent at a level: 0 is full, and `n` the `n`-th of [`levels`](Self::levels).
    pub(crate) fn spent_at(&self, level: usize) -> DetailLevel {
        level.checked_sub(1).and_then(|i| self.levels.get(i).copied()).unwrap_or_default()
    }
}

/// What is spent on a body now. Comes with [`LevelOfDetail`], and is written by the plugin.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CurrentDetail {
    pub(crate) level: usize,
    pub(crate) coarseness: u32,
    pub(crate) most_substeps: u32,
}

impl Default for CurrentDetail {
    /// In full.
    fn default() -> Self {
        Self { level: 0, coarseness: 1, most_substeps: u32::MAX }
    }
}

impl CurrentDetail {
    /// 0 where the body is simulated in full, `n` for the `n`-th of [`LevelOfDetail::levels`].
    pub fn level(&self) -> usize {
        self.level
    }

    /// About how many particles of a row there would be in place of each. Lags behind the level: only some bodies change in a step.
    pub fn coarseness(&self) -> u32 {
        self.coarseness
    }

    /// These settings, with no more substeps than the level allows.
    pub(crate) fn limit(self, settings: drape_solver::SolverSettings) -> drape_solver::SolverSettings {
        drape_solver::SolverSettings { substeps: settings.substeps.min(self.most_substeps), ..settings }
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
