//! Backstops and drives of particles, as callers set them.
//!
//! Design: `docs/design/characters.md`.

use glam::Vec3;

use crate::error::{BuildError, finite_vector};
use crate::state::backstops::{Backstop, Backstops};
use crate::state::particles::Particles;
use crate::state::pose_constraints::PoseConstraints;
use crate::state::pose_drives::{PoseDrive, PoseDrives};

impl Particles {
    /// Puts a backstop behind particle `i`, whose animated place (world, metres) has this outward `normal`, of any
    /// length. Nothing pulls or pushes the particle into the sphere: it overrules obstacles, as
    /// [limits](Self::set_motion_limit) do, and only a limit too short to leave it overrules the sphere; layers that touch
    /// may hold it back for a substep while the sphere moves. The sphere has no friction, and a particle that meets it keeps
    /// its velocity along the surface. A radius of 0 removes the backstop. Pinned particles follow their pins alone.
    ///
    /// [`set_backstop_pose`](Self::set_backstop_pose) moves the sphere.
    ///
    /// # Errors
    /// [`BuildError`] as [`Backstop::validate`], or if the place is not finite, or the normal is zero or not finite.
    pub fn set_backstop(
        &mut self,
        i: usize,
        place: Vec3,
        normal: Vec3,
        backstop: Backstop,
    ) -> Result<(), BuildError> {
        let slot = self.slot(i);
        backstop.validate()?;
        finite_vector("animated place", place)?;
        finite_vector("normal of a backstop", normal)?;
        let length = normal.length();
        let Some(normal) = normal.try_normalize() else {
            return Err(BuildError::NotPositive { field: "length of a backstop's normal", value: length });
        };
        if self.pose.backstops.is_empty() {
            if backstop.radius == 0.0 {
                return Ok(());
            }
            self.pose.backstops.reset(self.layout.cells());
        }
        let place = place - self.origin;
        self.pose.backstops.set(slot, [place; 2], [normal; 2], backstop);
        self.disturb();
        Ok(())
    }

    /// Moves particle `i`'s backstop within the next step, evenly over the substeps, to where the animated place
    /// (world, metres) and its outward `normal` are then. Does nothing without a backstop; a normal of length zero
    /// leaves the direction as it is.
    pub fn set_backstop_pose(&mut self, i: usize, place: Vec3, normal: Vec3) {
        let slot = self.slot(i);
        let place = place - self.origin;
        let backstops = &mut self.pose.backstops;
        if backstops.get(slot).is_some() {
            let normal = normal.normalize_or(backstops.normal.next.get(slot));
            let has_moved = backstops.place.aim(slot, place);
            if backstops.normal.aim(slot, normal) || has_moved {
                self.disturb();
            }
        }
    }

    /// Centre of the sphere of particle `i`'s backstop at the end of the last step (world, metres), and its
    /// measures; none without a backstop.
    pub fn backstop(&self, i: usize) -> Option<(Vec3, Backstop)> {
        let (slot, backstops) = (self.slot(i), &self.pose.backstops);
        backstops.get(slot).map(|backstop| (self.origin + backstops.centres(slot)[0], backstop))
    }

    /// Removes all backstops.
    pub fn clear_backstops(&mut self) {
        if !self.pose.backstops.is_empty() {
            self.pose.backstops = Backstops::default();
            self.disturb();
        }
    }

    /// Draws particle `i` towards its animated place (world, metres). A drive of no frequency removes it. Pinned
    /// particles follow their pins alone.
    ///
    /// [`set_drive_place`](Self::set_drive_place) moves the place.
    ///
    /// # Errors
    /// [`BuildError`] as [`PoseDrive::validate`], or if the place is not finite.
    pub fn set_pose_drive(&mut self, i: usize, place: Vec3, drive: PoseDrive) -> Result<(), BuildError> {
        let slot = self.slot(i);
        drive.validate()?;
        finite_vector("animated place", place)?;
        if self.pose.drives.is_empty() {
            if drive.angular_frequency == 0.0 {
                return Ok(());
            }
            self.pose.drives.reset(self.layout.cells());
        }
        self.pose.drives.set(slot, [place - self.origin; 2], drive);
        self.disturb();
        Ok(())
    }

    /// Moves the place that particle `i` is driven to (world, metres) within the next step, evenly over the substeps.
    /// Does nothing without a drive.
    pub fn set_drive_place(&mut self, i: usize, place: Vec3) {
        let slot = self.slot(i);
        let place = place - self.origin;
        let drives = &mut self.pose.drives;
        if drives.get(slot).is_some() && drives.place.aim(slot, place) {
            self.disturb();
        }
    }

    /// The place that particle `i` was driven to at the end of the last step (world, metres), and its drive; none
    /// without a drive.
    pub fn pose_drive(&self, i: usize) -> Option<(Vec3, PoseDrive)> {
        let (slot, drives) = (self.slot(i), &self.pose.drives);
        drives.get(slot).map(|drive| (self.origin + drives.place.now.get(slot), drive))
    }

    /// Removes all drives.
    pub fn clear_pose_drives(&mut self) {
        if !self.pose.drives.is_empty() {
            self.pose.drives = PoseDrives::default();
            self.disturb();
        }
    }

    /// True if a [limit](Self::set_motion_limit), [backstop](Self::set_backstop) or [drive](Self::set_pose_drive) ties
    /// any particle to an animated pose.
    pub fn follows_pose(&self) -> bool {
        self.layout.slots().any(|slot| {
            let PoseConstraints { limits, backstops, drives } = &self.pose;
            limits.get(slot).is_some() || backstops.get(slot).is_some() || drives.get(slot).is_some()
        })
    }
}
