//! The description of a cloth of bones.

use core::f32::consts::PI;

use bevy::prelude::*;
use drape_solver::error::{in_range, positive};
use drape_solver::{BuildError, PoseDrive};

/// Lets chains of joints of a skinned mesh hang and swing, as ropes or as a cloth: hair, tails, ears, skirts. Spawn it as an entity of its
/// own; it needs no mesh.
///
/// ```text
///   head o            the first joint of a chain stays where the animation has it,
///        |\           each turns so that its bone points at the next particle,
///   root x-o-o-o-+    and the last has a tip
///          particles
/// ```
///
/// Each chain goes from one of the [`roots`](Self::roots) down to its first child, and so on; children with an
/// [`Obstacle`](crate::environment::obstacle::Obstacle) or a [`SpringCollider`](crate::bones::spring_bones::SpringCollider) do not count,
/// nor do those at the joint's own place, such as meshes. A joint is in one chain only, and a chain hangs on no other.
///
/// Lengths are those of the joints as they stand when it is built: in the first step after it was inserted or changed. It touches
/// obstacles, balls and, with self-contact, other bodies, as far as its [`BodySurface`](crate::body::surface::BodySurface) is thick, and
/// the wind blows at it. It does not tear.
///
/// Joints show the result from `PostUpdate` on; until then, in each frame, they have their animated transforms. They and all that
/// they hang on get a [`MovedByFrame`](crate::transform::moved_by_frame::MovedByFrame). Only rotations are written, so that bones keep
/// their lengths.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct BoneCloth {
    /// The first joint of each chain; those of a sheet or tube side by side.
    #[entities]
    pub roots: Vec<Entity>,
    /// The ties between chains.
    pub weave: BoneWeave,
    /// Mass per length of each chain in kg/m, above 0.
    pub linear_density: f32,
    /// Length in metres of the bone of the last joint, which has no child that says it. `None`: that of the bone before it.
    pub tip: Option<f32>,
    /// Angular frequency in rad/s, 0 to 10 000, of the spring that draws the bones towards the animated pose. 0 (the default) is limp,
    /// 6 soft hair, 20 an ear.
    pub drive_frequency: f32,
    /// Damping ratio of that spring, 0 to 1000: 0 swings for ever, 1 (the default) does not swing over.
    pub drive_damping: f32,
    /// Greatest angle in radians, 0 to pi, by which a chain may swing out of its animated pose, seen from its root. Pi (the default) is
    /// no limit.
    pub max_swing: f32,
    /// Greatest angle in radians, 0 to pi, between one bone and the next. Pi (the default) is no limit. A chain that is bent more when it is
    /// built may stay so.
    pub max_bend: f32,
}

/// The ties between the chains of a [`BoneCloth`].
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum BoneWeave {
    /// None: hair, tails.
    #[default]
    Strands,
    /// Each chain to the next: a coat-tail, a curtain of beads.
    Sheet,
    /// The same, and the last to the first: a skirt. Two chains are a sheet.
    Tube,
}

impl Default for BoneCloth {
    fn default() -> Self {
        Self {
            roots: Vec::new(),
            weave: BoneWeave::Strands,
            linear_density: 0.1,
            tip: None,
            drive_frequency: 0.0,
            drive_damping: 1.0,
            max_swing: PI,
            max_bend: PI,
        }
    }
}

impl BoneCloth {
    /// Limp chains from these joints down.
    pub fn new(roots: impl IntoIterator<Item = Entity>) -> Self {
        Self { roots: roots.into_iter().collect(), ..Self::default() }
    }

    /// Ties the chains to each other.
    pub fn with_weave(self, weave: BoneWeave) -> Self {
        Self { weave, ..self }
    }

    /// The drive of each free particle.
    pub(crate) fn drive(&self) -> PoseDrive {
        PoseDrive { angular_frequency: self.drive_frequency, damping_ratio: self.drive_damping }
    }

    /// Checks every number.
    pub(crate) fn validate(&self) -> Result<(), BuildError> {
        positive("linear_density", self.linear_density)?;
        if let Some(tip) = self.tip {
            positive("tip", tip)?;
        }
        in_range("max_swing", self.max_swing, 0.0, PI)?;
        in_range("max_bend", self.max_bend, 0.0, PI)?;
        self.drive().validate()
    }
}
