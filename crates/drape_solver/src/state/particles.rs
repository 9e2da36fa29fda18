//! The state of a body: positions, displacements and masses of its particles.
//!
//! Design: `docs/design/integration.md`.

use glam::Vec3;

use crate::constants::INITIAL_SUBSTEP;
use crate::error::{BuildError, finite_vector};
use crate::simd::columns::{Columns, LANES};
use crate::state::bending_friction::PlasticBends;
use crate::state::frame_motion::FrameMotion;
use crate::state::joint::Joint;
use crate::state::layout::Layout;
use crate::state::particle_stats::{MassStats, ParticleStats};
use crate::state::pose_constraints::PoseConstraints;
use crate::state::substep::Substep;

/// Positions, displacements and inverse masses of a body's particles, as columns.
///
/// Positions are kept relative to [`origin`](Self::origin), a point near the body, so that single precision
/// is as fine a kilometre away as at the centre of the world. The accessors take and give world coordinates.
///
/// The textbook Verlet state is the position and the previous position. Here the *displacement*
/// `d = x - x*` of the last substep takes the previous position's place: the step `d += a dt^2; x += d` is
/// algebraically the same, but does not lose `a dt^2` in the rounding of `2x - x*` (after two seconds of free
/// fall from 100 m at 960 Hz: 0.2 mm of error against 5.6 m). As there is no second copy of the positions,
/// there is also nothing to swap at the end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Particles {
    pub(crate) origin: Vec3,
    /// The substep, in seconds, that displacements refer to.
    pub(crate) substep: f32,
    /// The map between particles and slots of the columns.
    pub(crate) layout: Layout,
    pub(crate) position: Columns,
    pub(crate) displacement: Columns,
    /// Inverse mass of each slot in 1/kg; 0 for pins and ghosts.
    pub(crate) inverse_mass: Vec<f32>,
    /// Forces of this step in newtons; empty if there are none.
    pub(crate) force: Columns,
    /// Slots of pinned particles with their targets at the end of the next step (world, metres).
    pub(crate) pin_targets: Vec<(u32, Vec3)>,
    /// Joints of pinned particles with obstacles in the next step, sorted by slot.
    pub(crate) joints: Vec<Joint>,
    /// Limits on motion, backstops and drives, by an animated pose.
    pub(crate) pose: PoseConstraints,
    /// The plastic sums that friction keeps of the bends.
    pub(crate) plastic: PlasticBends,
    /// Motion of the frame of reference in the next step.
    pub(crate) frame: Option<FrameMotion>,
    /// By how much, in parts of themselves, rest lengths are longer at the beginning of the next step.
    pub(crate) excess_length: f32,
    /// True after any event that should wake a sleeping body.
    pub(crate) disturbed: bool,
    /// Statistics of the particles; none if one has moved since they were gathered.
    pub(crate) stats: Option<ParticleStats>,
    /// Statistics of the masses.
    pub(crate) masses: MassStats,
}

impl Default for Particles {
    fn default() -> Self {
        Self {
            origin: Vec3::ZERO,
            substep: INITIAL_SUBSTEP,
            layout: Layout::default(),
            position: Columns::default(),
            displacement: Columns::default(),
            inverse_mass: Vec::new(),
            force: Columns::default(),
            pin_targets: Vec::new(),
            joints: Vec::new(),
            pose: PoseConstraints::default(),
            plastic: PlasticBends::default(),
            frame: None,
            excess_length: 0.0,
            disturbed: false,
            stats: None,
            masses: MassStats::default(),
        }
    }
}

impl Particles {
    /// Particles at rest at `positions` (world, metres), with `inverse_masses` (1/kg; 0 pins a particle), kept
    /// relative to `origin`.
    ///
    /// # Errors
    /// [`BuildError`] if a position is not finite, or an inverse mass is negative or not finite, or the two
    /// slices differ in length.
    pub fn new(origin: Vec3, positions: &[Vec3], inverse_masses: &[f32]) -> Result<Self, BuildError> {
        if positions.len() != inverse_masses.len() {
            return Err(BuildError::NoSuchParticle {
                what: "a mass",
                index: inverse_masses.len() as u32,
                count: positions.len() as u32,
            });
        }
        finite_vector("origin", origin)?;
        let layout = Layout::Linear { count: positions.len() };
        let cells = layout.cells();
        let mut particles = Self { origin, layout, ..Self::default() };
        particles.position.reset(cells);
        particles.displacement.reset(cells);
        particles.inverse_mass.resize(cells * LANES, 0.0);
        for (i, (&position, &inverse_mass)) in positions.iter().zip(inverse_masses).enumerate() {
            finite_vector("position", position)?;
            if !(inverse_mass >= 0.0 && inverse_mass.is_finite()) {
                return Err(BuildError::OutOfRange {
                    field: "inverse mass",
                    value: inverse_mass,
                    min: 0.0,
                    max: f32::MAX,
                });
            }
            particles.position.set(i, position - origin);
            particles.inverse_mass[i] = inverse_mass;
        }
        Ok(particles)
    }

    /// Moves every particle to the slot that `layout` has for it.
    pub(crate) fn arrange(&mut self, layout: &Layout) {
        if *layout == self.layout || layout.count() != self.len() {
            return;
        }
        let cells = layout.cells();
        let old = core::mem::replace(self, Self { layout: layout.clone(), ..self.clone() });
        self.position.reset(cells);
        self.displacement.reset(cells);
        self.inverse_mass.clear();
        self.inverse_mass.resize(cells * LANES, 0.0);
        self.force.reset(if old.force.is_empty() { 0 } else { cells });
        for (from, to) in old.layout.slots().zip(layout.slots()) {
            self.position.set(to, old.position.get(from));
            self.displacement.set(to, old.displacement.get(from));
            self.inverse_mass[to] = old.inverse_mass[from];
            if !old.force.is_empty() {
                self.force.set(to, old.force.get(from));
            }
        }
        let slot_of = |&(slot, target): &(u32, Vec3)| {
            let index = old.layout.index(slot as usize)?;
            Some((layout.slot(index) as u32, target))
        };
        self.pin_targets = old.pin_targets.iter().filter_map(slot_of).collect();
        self.pin_targets.sort_unstable_by_key(|&(slot, _)| slot);
        for joint in &mut self.joints {
            let index = old.layout.index(joint.slot as usize);
            joint.slot = index.map_or(joint.slot, |index| layout.slot(index) as u32);
        }
        self.joints.sort_unstable_by_key(|joint| joint.slot);
        self.pose = old.pose.arranged(&old.layout, layout);
        let slots = old.layout.slots().zip(layout.slots());
        self.plastic = old.plastic.picked(layout, slots.map(|(from, to)| [from, to]));
        self.plastic.edges = old.plastic.edges;
        self.masses = MassStats::default();
    }

    /// The slot of particle `i`.
    ///
    /// # Panics
    /// If there is no such particle: a ghost's slot must not be written.
    pub(crate) fn slot(&self, i: usize) -> usize {
        assert!(i < self.len(), "particle {i} of {}", self.len());
        self.layout.slot(i)
    }

    /// Notes that a particle has been moved or pushed.
    pub(crate) fn disturb(&mut self) {
        self.disturbed = true;
        self.stats = None;
    }

    /// The number of particles.
    pub fn len(&self) -> usize {
        self.layout.count()
    }

    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The world position that stored positions are relative to.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Position of particle `i` in the world, in metres.
    ///
    /// # Panics
    /// If `i` is out of range, as for a slice; so do all methods here that take an index.
    pub fn position(&self, i: usize) -> Vec3 {
        self.origin + self.local_position(i)
    }

    /// Positions of all particles in the world, in metres.
    pub fn positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.local_positions().map(|position| self.origin + position)
    }

    /// Positions of all particles relative to [`origin`](Self::origin), in metres: exact where
    /// [`positions`](Self::positions) round.
    pub fn local_positions(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.layout.slots().map(|slot| self.position.get(slot))
    }

    /// Position relative to [`origin`](Self::origin) of particle `i`, in metres: exact where
    /// [`position`](Self::position) rounds.
    pub fn local_position(&self, i: usize) -> Vec3 {
        self.position.get(self.slot(i))
    }

    /// Position of particle `i` one substep ago (world, metres): the `x*` of the textbook form, derived as `x - d`.
    pub fn previous_position(&self, i: usize) -> Vec3 {
        self.origin + (self.local_position(i) - self.displacement.get(self.slot(i)))
    }

    /// Velocity of particle `i` in m/s: its displacement over the substep.
    pub fn velocity(&self, i: usize) -> Vec3 {
        self.displacement.get(self.slot(i)) / self.substep
    }

    /// Velocities of all particles in m/s.
    pub fn velocities(&self) -> impl ExactSizeIterator<Item = Vec3> + '_ {
        self.layout.slots().map(|slot| self.displacement.get(slot) / self.substep)
    }

    /// Inverse mass of particle `i` in 1/kg; 0 for a pinned particle.
    pub fn inverse_mass(&self, i: usize) -> f32 {
        self.inverse_mass[self.slot(i)]
    }

    /// True if particle `i` is pinned: only its pin target moves it.
    pub fn is_pinned(&self, i: usize) -> bool {
        self.inverse_mass(i) == 0.0
    }

    /// Sets the inverse mass of particle `i` in 1/kg; 0 pins it where it is, anything else frees it.
    /// Values that are negative or not finite are taken as 0.
    pub fn set_inverse_mass(&mut self, i: usize, inverse_mass: f32) {
        let slot = self.slot(i);
        self.inverse_mass[slot] = if inverse_mass.is_finite() { inverse_mass.max(0.0) } else { 0.0 };
        if self.is_pinned(i) {
            self.displacement.set(slot, Vec3::ZERO);
        }
        self.masses.forget();
        self.disturb();
    }

    /// Puts particle `i` at `position` (world, metres), keeping its velocity.
    pub fn set_position(&mut self, i: usize, position: Vec3) {
        self.position.set(self.slot(i), position - self.origin);
        self.disturb();
    }

    /// Sets the velocity of particle `i` in m/s.
    pub fn set_velocity(&mut self, i: usize, velocity: Vec3) {
        self.displacement.set(self.slot(i), velocity * self.substep);
        self.disturb();
    }

    /// Puts particle `i` at `position` with the velocity of a motion that was at `previous` `dt` seconds before (world,
    /// metres), such as two frames of an animation. A pinned particle gets no velocity. This is Jakobsen's `x*` taken
    /// from a pose.
    pub fn set_motion(&mut self, i: usize, previous: Vec3, position: Vec3, dt: f32) {
        self.set_position(i, position);
        let velocity = (position - previous) / dt;
        if !self.is_pinned(i) && velocity.is_finite() {
            self.set_velocity(i, velocity);
        }
    }

    /// Changes the momentum of particle `i` by `impulse` (newton seconds). This is Jakobsen's impulse by moving
    /// `x*`: the position stays, the velocity changes by `impulse / mass`. A pinned particle does not react.
    pub fn apply_impulse(&mut self, i: usize, impulse: Vec3) {
        let slot = self.slot(i);
        self.displacement.add(slot, impulse * (self.inverse_mass[slot] * self.substep));
        self.disturb();
    }

    /// Adds a force (newtons) on particle `i`, which acts through the whole of the next step and is then
    /// forgotten.
    pub fn add_force(&mut self, i: usize, force: Vec3) {
        if self.force.is_empty() {
            self.force.reset(self.layout.cells());
        }
        self.force.add(self.slot(i), force);
        self.disturb();
    }

    /// Moves the pinned particle `i` to `target` (world, metres) in the next step, evenly over the substeps, so that
    /// the cloth is not jerked. Does nothing for a particle that is not pinned.
    pub fn set_pin_target(&mut self, i: usize, target: Vec3) {
        if self.is_pinned(i) && target != self.position(i) {
            // Sorted, with one target for each pin: the last one set counts.
            let slot = self.slot(i) as u32;
            match self.pin_targets.binary_search_by_key(&slot, |&(pin, _)| pin) {
                Ok(known) => self.pin_targets[known].1 = target,
                Err(place) => self.pin_targets.insert(place, (slot, target)),
            }
            self.disturb();
        }
    }

    /// In the next step, the rest lengths of sticks and tethers go from `ratio` times those of the topology to them, evenly over the
    /// substeps, so that a rope which is reeled in does not jerk what hangs on it. Call it when the body gets a topology of another
    /// length; `ratio` is the old length over the new one, and those of several calls before a step are multiplied. One that is not above
    /// zero, or not finite, changes nothing. [Snapshots](Self::snapshot) do not hold it.
    pub fn change_lengths_from(&mut self, ratio: f32) {
        let excess = (1.0 + self.excess_length) * ratio - 1.0;
        if ratio > 0.0 && excess.is_finite() {
            self.excess_length = excess;
            self.disturb();
        }
    }

    /// The factor on the rest lengths of the topology in a substep.
    pub(crate) fn length_ratio(&self, Substep { index, count, .. }: Substep) -> f32 {
        let left = 1.0 - (index + 1) as f32 / count.max(1) as f32;
        1.0 + self.excess_length * left
    }

    /// Clears the forces, pin targets, joints, motion of the frame and changes of length that were set for the next step.
    pub fn clear_requests(&mut self) {
        self.force.clear();
        self.pin_targets.clear();
        self.joints.clear();
        self.frame = None;
        self.excess_length = 0.0;
    }

    /// Wakes the body: it counts as edited, and its time at rest restarts.
    pub fn rouse(&mut self) {
        self.disturb();
    }

    /// Moves the whole body by `offset` (metres) without changing its velocity or shape.
    pub fn translate(&mut self, offset: Vec3) {
        self.origin += offset;
        self.disturb();
    }

    /// Makes the place `origin` (metres) the origin of the world: everything is where it was, and rests as before, in other
    /// coordinates. A body that goes far from its old place loses digits of where it is, but none of its shape.
    pub fn shift_origin(&mut self, origin: Vec3) {
        self.origin -= origin;
        for (_, target) in &mut self.pin_targets {
            *target -= origin;
        }
        if let Some(frame) = &mut self.frame {
            frame.pivot -= origin;
        }
    }

    /// True if a force, an impulse, a pin or an edit has touched the body since its last step, which wakes a sleeping
    /// body.
    pub fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// Mean velocity of all particles, each counted alike, in m/s.
    pub(crate) fn mean_velocity(&self) -> Vec3 {
        self.velocities().sum::<Vec3>() / self.len().max(1) as f32
    }

    /// Rescales displacements to a substep of `substep` seconds, so that velocities stay the same when the time step or
    /// the number of substeps changes.
    pub(crate) fn set_substep(&mut self, substep: f32) {
        if substep == self.substep {
            return;
        }
        let factor = substep / self.substep;
        for cell in &mut self.displacement.cells {
            for column in [&mut cell.x, &mut cell.y, &mut cell.z] {
                column.iter_mut().for_each(|d| *d *= factor);
            }
        }
        self.substep = substep;
        self.stats = None;
    }

    /// Moves the origin to `origin`, keeping world positions.
    pub(crate) fn recentre(&mut self, origin: Vec3) {
        let shift = self.origin - origin;
        for cell in &mut self.position.cells {
            for (column, shift) in cell.axes_mut().into_iter().zip(shift.to_array()) {
                column.iter_mut().for_each(|x| *x += shift);
            }
        }
        self.pose.shift(shift);
        self.origin = origin;
        self.stats = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one() -> Particles {
        Particles::new(Vec3::X, &[Vec3::new(1.0, 2.0, 3.0)], &[2.0]).expect("valid")
    }

    #[test]
    fn previous_position_and_velocity_are_views_of_the_displacement() {
        let mut particles = one();
        particles.set_velocity(0, Vec3::new(0.0, 10.24, 0.0));
        assert_eq!(particles.velocity(0), Vec3::new(0.0, 10.24, 0.0));
        let moved = particles.position(0) - particles.previous_position(0);
        assert!((moved.y - 0.01).abs() < 1e-6);
    }

    #[test]
    fn velocity_survives_a_change_of_substep() {
        let mut particles = one();
        particles.set_velocity(0, Vec3::new(1.0, 2.0, 3.0));
        particles.set_substep(1.0 / 60.0);
        assert!((particles.velocity(0) - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
    }

    #[test]
    fn impulse_changes_velocity_by_impulse_over_mass_and_leaves_the_position() {
        let mut particles = one();
        particles.apply_impulse(0, Vec3::X);
        assert_eq!(particles.position(0), Vec3::new(1.0, 2.0, 3.0));
        assert!((particles.velocity(0) - Vec3::new(2.0, 0.0, 0.0)).length() < 1e-6);
    }

    #[test]
    fn recentring_keeps_world_positions() {
        let mut particles = one();
        particles.recentre(Vec3::new(64.0, 0.0, 0.0));
        assert_eq!(particles.position(0), Vec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn non_finite_positions_and_negative_masses_are_refused() {
        assert!(Particles::new(Vec3::ZERO, &[Vec3::NAN], &[1.0]).is_err());
        assert!(Particles::new(Vec3::ZERO, &[Vec3::ZERO], &[-1.0]).is_err());
        assert!(Particles::new(Vec3::ZERO, &[Vec3::ZERO], &[f32::NAN]).is_err());
        assert!(Particles::new(Vec3::ZERO, &[Vec3::ZERO], &[]).is_err());
    }

    #[test]
    fn lengths_go_evenly_to_those_of_the_topology() {
        let mut particles = Particles::new(Vec3::ZERO, &[Vec3::ZERO, Vec3::X], &[0.0, 1.0]).expect("valid");
        let ratios = |particles: &Particles| {
            [0, 1, 2, 3]
                .map(|index| particles.length_ratio(Substep { index, count: 4, ..Substep::default() }))
        };
        assert_eq!(ratios(&particles), [1.0; 4]);
        particles.change_lengths_from(1.25);
        particles.change_lengths_from(1.2);
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            particles.change_lengths_from(bad);
        }
        for (ratio, expected) in ratios(&particles).into_iter().zip([1.375, 1.25, 1.125, 1.0]) {
            assert!((ratio - expected).abs() < 1e-6, "{ratio}, not {expected}");
        }
        assert_eq!(ratios(&particles)[3], 1.0);
        particles.clear_requests();
        assert_eq!(ratios(&particles), [1.0; 4]);
    }
}
