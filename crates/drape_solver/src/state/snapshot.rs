//! Snapshots: the state of bodies and balls as plain numbers, which decides all their next steps.
//!
//! Nothing else of a body outlives a step but its settings, its topology and its time at rest
//! ([`BodyContext::still_for`]).
//!
//! Design: `docs/design/snapshots.md`.

use glam::{Quat, Vec3};

use crate::error::{BuildError, in_range, positive};
use crate::simd::columns::{Columns, LANES};
use crate::state::backstops::Backstop;
use crate::state::ball::{Ball, BallMaterial};
use crate::state::bending_friction::PlasticBends;
use crate::state::body::BodyContext;
use crate::state::frame_motion::FrameMotion;
use crate::state::layers::Layers;
use crate::state::particle_stats::MassStats;
use crate::state::particles::Particles;
use crate::state::pose_constraints::PoseConstraints;
use crate::state::pose_drives::PoseDrive;
use crate::state::topology::Topology;

/// The state of a body's [`Particles`], by index.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParticlesSnapshot {
    origin: [f32; 3],
    substep: f32,
    positions: Vec<[f32; 3]>,
    displacements: Vec<[f32; 3]>,
    inverse_masses: Vec<f32>,
    forces: Vec<[f32; 3]>,
    pin_targets: Vec<(u32, [f32; 3])>,
    /// Index, centre, target and distance of each limit on motion.
    limits: Vec<(u32, [f32; 3], [f32; 3], f32)>,
    /// Index, place and normal, each now and after the step, distance and radius of each backstop.
    backstops: Vec<(u32, [[f32; 3]; 4], [f32; 2])>,
    /// Index, place now and after the step, angular frequency and damping ratio of each drive.
    drives: Vec<(u32, [[f32; 3]; 2], [f32; 2])>,
    /// Plastic sums of the bends along rows and along columns of each particle, or none; and those of a mesh, which are begun anew
    /// if their number is not that of its bends.
    threads: Vec<[f32; 2]>,
    edges: Vec<f32>,
    /// Pivot, turn and translation of the frame in the next step.
    frame: Option<[[f32; 3]; 3]>,
    is_disturbed: bool,
}

impl ParticlesSnapshot {
    /// The number of particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Checks that [`Particles::restore`] can apply it to a body of `count` particles.
    ///
    /// # Errors
    /// [`BuildError`] if the number of particles differs, or a value is out of range.
    pub fn validate(&self, count: usize) -> Result<(), BuildError> {
        let Self { substep, displacements, inverse_masses, forces, pin_targets, .. } = self;
        let lengths = [self.len(), displacements.len(), inverse_masses.len()];
        let optional = [forces.len(), self.threads.len()].into_iter().filter(|&length| length > 0);
        for length in lengths.into_iter().chain(optional) {
            if length != count {
                return Err(no_such_particle(length, count));
            }
        }
        positive("substep", *substep)?;
        for &sum in self.threads.iter().flatten().chain(&self.edges) {
            in_range("plastic sum of a bend", sum, f32::MIN, f32::MAX)?;
        }
        for &inverse_mass in inverse_masses {
            in_range("inverse mass", inverse_mass, 0.0, f32::MAX)?;
        }
        let limited = self.limits.iter().map(|&(index, ..)| index);
        let stopped = self.backstops.iter().map(|&(index, ..)| index);
        let driven = self.drives.iter().map(|&(index, ..)| index);
        let pinned = pin_targets.iter().map(|&(index, _)| index);
        for &(_, _, measures) in &self.backstops {
            backstop_of(measures).validate()?;
        }
        for &(_, _, measures) in &self.drives {
            drive_of(measures).validate()?;
        }
        for index in pinned.chain(limited).chain(stopped).chain(driven) {
            if index as usize >= count {
                return Err(no_such_particle(index as usize, count));
            }
        }
        Ok(())
    }
}

fn no_such_particle(index: usize, count: usize) -> BuildError {
    BuildError::NoSuchParticle { what: "the snapshot", index: index as u32, count: count as u32 }
}

fn backstop_of([distance, radius]: [f32; 2]) -> Backstop {
    Backstop { distance, radius }
}

fn drive_of([angular_frequency, damping_ratio]: [f32; 2]) -> PoseDrive {
    PoseDrive { angular_frequency, damping_ratio }
}

impl Particles {
    /// The state that decides their next steps.
    pub fn snapshot(&self) -> ParticlesSnapshot {
        let column = |columns: &Columns| {
            if columns.is_empty() {
                return Vec::new();
            }
            self.layout.slots().map(|slot| columns.get(slot).to_array()).collect()
        };
        let target = |&(slot, target): &(u32, Vec3)| {
            Some((self.layout.index(slot as usize)? as u32, target.to_array()))
        };
        let limit = |(index, slot): (usize, usize)| {
            let ([centre, target], reach) = self.pose.limits.get(slot)?;
            Some((index as u32, centre.to_array(), target.to_array(), reach))
        };
        let backstop = |(index, slot): (usize, usize)| {
            let Backstop { distance, radius } = self.pose.backstops.get(slot)?;
            let [a, b] = self.pose.backstops.place.get(slot);
            let [c, d] = self.pose.backstops.normal.get(slot);
            Some((index as u32, [a, b, c, d].map(|v| v.to_array()), [distance, radius]))
        };
        let drive = |(index, slot): (usize, usize)| {
            let PoseDrive { angular_frequency, damping_ratio } = self.pose.drives.get(slot)?;
            let place = self.pose.drives.place.get(slot).map(|v| v.to_array());
            Some((index as u32, place, [angular_frequency, damping_ratio]))
        };
        let PlasticBends { threads: [rows, columns], edges } = &self.plastic;
        let has_threads = !rows.is_empty();
        // Most bodies have none of these.
        let constrained = |any: bool| any.then(|| self.layout.slots().enumerate()).into_iter().flatten();
        ParticlesSnapshot {
            origin: self.origin.to_array(),
            substep: self.substep,
            positions: column(&self.position),
            displacements: column(&self.displacement),
            inverse_masses: self.layout.slots().map(|slot| self.inverse_mass[slot]).collect(),
            forces: column(&self.force),
            pin_targets: self.pin_targets.iter().filter_map(target).collect(),
            limits: constrained(!self.pose.limits.is_empty()).filter_map(limit).collect(),
            backstops: constrained(!self.pose.backstops.is_empty()).filter_map(backstop).collect(),
            drives: constrained(!self.pose.drives.is_empty()).filter_map(drive).collect(),
            threads: constrained(has_threads).map(|(_, slot)| [rows[slot], columns[slot]]).collect(),
            edges: edges.clone(),
            frame: self.frame.map(|m| [m.pivot, m.turn, m.translation].map(|v| v.to_array())),
            is_disturbed: self.disturbed,
        }
    }

    /// Restores positions, motion, masses, limits, backstops, drives and requests, to the last bit.
    ///
    /// # Errors
    /// [`BuildError`] as [`ParticlesSnapshot::validate`]; nothing has changed then.
    pub fn restore(&mut self, snapshot: &ParticlesSnapshot) -> Result<(), BuildError> {
        snapshot.validate(self.len())?;
        let cells = self.layout.cells();
        self.origin = Vec3::from_array(snapshot.origin);
        self.substep = snapshot.substep;
        self.position.reset(cells);
        self.displacement.reset(cells);
        self.force.reset(if snapshot.forces.is_empty() { 0 } else { cells });
        self.inverse_mass.clear();
        self.inverse_mass.resize(cells * LANES, 0.0);
        for (i, slot) in self.layout.slots().enumerate() {
            self.position.set(slot, Vec3::from_array(snapshot.positions[i]));
            self.displacement.set(slot, Vec3::from_array(snapshot.displacements[i]));
            self.inverse_mass[slot] = snapshot.inverse_masses[i];
            if let Some(&force) = snapshot.forces.get(i) {
                self.force.set(slot, Vec3::from_array(force));
            }
        }
        let slot_of = |&(index, target): &(u32, [f32; 3])| {
            (self.layout.slot(index as usize) as u32, Vec3::from_array(target))
        };
        self.pin_targets = snapshot.pin_targets.iter().map(slot_of).collect();
        self.pin_targets.sort_unstable_by_key(|&(slot, _)| slot);
        self.restore_pose(snapshot);
        self.plastic = PlasticBends { edges: snapshot.edges.clone(), ..PlasticBends::default() };
        if !snapshot.threads.is_empty() {
            self.plastic.reserve_threads(&self.layout);
        }
        for (slot, &[row, column]) in self.layout.slots().zip(&snapshot.threads) {
            (self.plastic.threads[0][slot], self.plastic.threads[1][slot]) = (row, column);
        }
        self.frame = snapshot.frame.map(|motion| {
            let [pivot, turn, translation] = motion.map(Vec3::from_array);
            FrameMotion { pivot, turn, translation }
        });
        self.excess_length = 0.0;
        self.disturbed = snapshot.is_disturbed;
        self.stats = None;
        self.masses = MassStats::default();
        Ok(())
    }

    /// The particles of a snapshot, which `topology` joins, to the last bit.
    ///
    /// # Errors
    /// [`BuildError`] as [`ParticlesSnapshot::validate`].
    pub fn from_snapshot(snapshot: &ParticlesSnapshot, topology: &Topology) -> Result<Self, BuildError> {
        let mut particles = Self { layout: topology.layout.clone(), ..Self::default() };
        particles.restore(snapshot)?;
        Ok(particles)
    }

    /// Restores limits, backstops and drives.
    fn restore_pose(&mut self, snapshot: &ParticlesSnapshot) {
        let Self { layout, pose, .. } = self;
        *pose = PoseConstraints::default();
        if !snapshot.limits.is_empty() {
            pose.limits.reset(layout.cells());
        }
        for &(index, centre, target, reach) in &snapshot.limits {
            let centre = [centre, target].map(Vec3::from_array);
            pose.limits.set(layout.slot(index as usize), centre, reach.max(0.0));
        }
        if !snapshot.backstops.is_empty() {
            pose.backstops.reset(layout.cells());
        }
        for &(index, pose_of, measures) in &snapshot.backstops {
            let [a, b, c, d] = pose_of.map(Vec3::from_array);
            pose.backstops.set(layout.slot(index as usize), [a, b], [c, d], backstop_of(measures));
        }
        if !snapshot.drives.is_empty() {
            pose.drives.reset(layout.cells());
        }
        for &(index, place, measures) in &snapshot.drives {
            pose.drives.set(layout.slot(index as usize), place.map(Vec3::from_array), drive_of(measures));
        }
    }
}

/// The state of a [`Ball`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BallSnapshot {
    material: BallMaterial,
    position: [f32; 3],
    displacement: [f32; 3],
    substep: f32,
    rotation: [f32; 4],
    spin: [f32; 3],
    force: [f32; 3],
    layers: Layers,
    reports_contacts: bool,
    is_disturbed: bool,
    still_for: f32,
    hit_substeps: f32,
}

impl Ball {
    /// The state that decides the ball's next steps.
    pub fn snapshot(&self) -> BallSnapshot {
        BallSnapshot {
            material: self.material,
            position: self.position.to_array(),
            displacement: self.displacement.to_array(),
            substep: self.substep,
            rotation: self.rotation.to_array(),
            spin: self.spin.to_array(),
            force: self.force.to_array(),
            layers: self.layers,
            reports_contacts: self.reports_contacts,
            is_disturbed: self.disturbed,
            still_for: self.still_for,
            hit_substeps: self.hit_substeps,
        }
    }

    /// The ball of a snapshot, to the last bit.
    ///
    /// # Errors
    /// [`BuildError`] if the material or the substep is out of range.
    pub fn from_snapshot(snapshot: &BallSnapshot) -> Result<Self, BuildError> {
        positive("substep", snapshot.substep)?;
        Ok(Self {
            position: Vec3::from_array(snapshot.position),
            displacement: Vec3::from_array(snapshot.displacement),
            substep: snapshot.substep,
            rotation: Quat::from_array(snapshot.rotation),
            spin: Vec3::from_array(snapshot.spin),
            force: Vec3::from_array(snapshot.force),
            layers: snapshot.layers,
            reports_contacts: snapshot.reports_contacts,
            disturbed: snapshot.is_disturbed,
            still_for: snapshot.still_for,
            hit_substeps: snapshot.hit_substeps,
            ..Self::new(snapshot.material, Vec3::ZERO, Vec3::ZERO)?
        })
    }
}

impl BodyContext {
    /// Sets the seconds for which a restored body has been slower than the threshold of rest.
    pub fn set_still_for(&mut self, seconds: f32) {
        self.still_for = seconds;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;
    use crate::{BodySettings, ClothBuilder, Edge, Environment, Island, StateHasher, step};

    fn hash(island: &Island) -> u64 {
        let mut hasher = StateHasher::new();
        island.bodies.iter().for_each(|body| _ = hasher.particles(&body.particles));
        island.balls.iter().for_each(|ball| _ = hasher.ball(ball));
        hasher.finish()
    }

    fn run(island: &mut Island, steps: usize) {
        for _ in 0..steps {
            step(island, &Environment::default()).expect("a valid step");
        }
    }

    /// A cloth in patches, a ball on it, a pin on its way and a force.
    fn island() -> Island {
        let cloth = ClothBuilder::new(1.0, 1.0, unless_miri(20, 5), unless_miri(17, 4))
            .pin_edge(Edge::Top)
            .build(BodySettings::default());
        let mut island = Island::of_body(cloth.expect("a cloth"));
        let ball = Ball::new(BallMaterial::default(), Vec3::new(0.1, 0.0, 0.4), Vec3::NEG_Z * 5.0);
        island.balls.push(ball.expect("a ball"));
        island
    }

    #[test]
    fn a_restored_island_goes_on_with_the_same_bits() {
        let mut island = island();
        run(&mut island, unless_miri(20, 1));
        let body = &mut island.bodies[0];
        let pin = (0..body.particles.len()).find(|&i| body.particles.is_pinned(i)).expect("a pin");
        body.particles.set_pin_target(pin, body.particles.position(pin) + Vec3::Y * 0.01);
        body.particles.add_force(7, Vec3::X);
        let particles = body.particles.snapshot();
        let (ball, still_for) = (island.balls[0].snapshot(), body.still_for());
        run(&mut island, unless_miri(20, 1));

        let mut other = self::island();
        run(&mut other, unless_miri(3, 2));
        let body = &mut other.bodies[0];
        body.particles.restore(&particles).expect("of the same cloth");
        body.context = BodyContext::default();
        body.context.set_still_for(still_for);
        other.balls[0] = Ball::from_snapshot(&ball).expect("a ball that was");
        run(&mut other, unless_miri(20, 1));
        assert_eq!(hash(&other), hash(&island));
    }

    #[test]
    fn what_cannot_be_is_refused_and_changes_nothing() {
        let mut particles = Particles::new(Vec3::ZERO, &[Vec3::X, Vec3::Y], &[1.0, 0.0]).expect("valid");
        let (good, before) = (particles.snapshot(), particles.clone());
        let bad = [
            ParticlesSnapshot::default(),
            ParticlesSnapshot { substep: 0.0, ..good.clone() },
            ParticlesSnapshot { substep: f32::NAN, ..good.clone() },
            ParticlesSnapshot { inverse_masses: vec![-1.0, 0.0], ..good.clone() },
            ParticlesSnapshot { displacements: vec![[0.0; 3]], ..good.clone() },
            ParticlesSnapshot { forces: vec![[0.0; 3]], ..good.clone() },
            ParticlesSnapshot { pin_targets: vec![(2, [0.0; 3])], ..good.clone() },
            ParticlesSnapshot { threads: vec![[0.0; 2]], ..good.clone() },
            ParticlesSnapshot { threads: vec![[0.0, f32::NAN]; 2], ..good.clone() },
            ParticlesSnapshot { edges: vec![f32::INFINITY], ..good.clone() },
        ];
        for snapshot in bad {
            assert!(particles.restore(&snapshot).is_err(), "{snapshot:?}");
            assert_eq!(particles, before);
        }
        assert_eq!(particles.restore(&good), Ok(()));
        let ball = Ball::new(BallMaterial::default(), Vec3::ZERO, Vec3::ZERO).expect("a ball").snapshot();
        assert!(Ball::from_snapshot(&BallSnapshot { substep: -1.0, ..ball }).is_err());
    }
}
