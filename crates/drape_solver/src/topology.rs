//! The rest data of a body: which particles are joined, and how long the sticks are.

use glam::Vec3;

use crate::constants::MAX_COLOURS;
use crate::error::{BuildError, in_range};
use crate::tether::Tethers;

/// What a stick is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum StickKind {
    /// Joins neighbours: keeps the cloth from stretching.
    #[default]
    Structural,
    /// Joins diagonals: keeps squares from becoming rhombs.
    Shear,
    /// Skips one particle: keeps the cloth from folding flat.
    Bend,
}

/// How a stick reacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickMaterial {
    /// What the stick is for.
    pub kind: StickKind,
    /// From 0 (slack) to 1 (rigid): the part of its strain that an isolated stick loses in one reference step
    /// of 1/60 s. See [`crate::stick::iteration_stiffness`] for how this is kept independent of the step.
    pub stiffness: f32,
    /// Damping along the stick in 1/s, 0 or more: the speed at which the ends part decays as `exp(-damping t)`.
    pub damping: f32,
}

impl StickMaterial {
    /// A rigid, undamped stick of `kind`.
    pub fn rigid(kind: StickKind) -> Self {
        Self { kind, stiffness: 1.0, damping: 0.0 }
    }

    fn validate(&self) -> Result<(), BuildError> {
        in_range("stiffness", self.stiffness, 0.0, 1.0)?;
        in_range("damping", self.damping, 0.0, 1e6)?;
        Ok(())
    }
}

/// Sticks of one material that share no particle, so that they may be relaxed in any order, or at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickBatch {
    /// How the sticks react.
    pub material: StickMaterial,
    /// Index of the first stick.
    pub first: usize,
    /// Number of sticks.
    pub count: usize,
    /// The batch's part of the topology's runs.
    runs: (usize, usize),
}

/// Consecutive sticks whose ends are consecutive too: stick `first + k` joins particles `a + k` and `b + k`, and
/// `a + count <= b`. On a grid most sticks lie in runs, which are relaxed as whole slices, without gathers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StickRun {
    pub first: usize,
    pub count: usize,
    pub a: usize,
    pub b: usize,
}

impl StickBatch {
    /// The indices of the batch's sticks.
    pub fn range(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// The rest data of a body. Immutable while the body lives, so that equal bodies can share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    pub(crate) particle_count: usize,
    pub(crate) a: Vec<u32>,
    pub(crate) b: Vec<u32>,
    pub(crate) rest_length: Vec<f32>,
    pub(crate) batches: Vec<StickBatch>,
    runs: Vec<StickRun>,
    pub(crate) tethers: Tethers,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) segments: Vec<[u32; 2]>,
    /// Longest side of a face or segment at rest, in metres: how far a contact can be from the nearest corner.
    pub(crate) longest_edge: f32,
}

impl Topology {
    /// The number of particles that the topology is made for.
    pub fn particle_count(&self) -> usize {
        self.particle_count
    }

    /// The number of sticks.
    pub fn stick_count(&self) -> usize {
        self.rest_length.len()
    }

    /// The two particles that stick `i` joins.
    pub fn stick(&self, i: usize) -> [u32; 2] {
        [self.a[i], self.b[i]]
    }

    /// The rest length of stick `i` in metres.
    pub fn rest_length(&self, i: usize) -> f32 {
        self.rest_length[i]
    }

    /// The batches in the order in which they are relaxed.
    pub fn batches(&self) -> &[StickBatch] {
        &self.batches
    }

    /// The runs of a batch, one after another.
    pub(crate) fn runs(&self, batch: &StickBatch) -> &[StickRun] {
        &self.runs[batch.runs.0..batch.runs.1]
    }

    /// The tethers.
    pub fn tethers(&self) -> &Tethers {
        &self.tethers
    }

    /// Triangles of the surface, as particle indices, counter-clockwise seen from the front.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Segments that a body without faces touches others with: the links of a rope.
    pub fn segments(&self) -> &[[u32; 2]] {
        &self.segments
    }
}

/// Puts a [`Topology`] together, one family of sticks after another.
///
/// The order of the families is the order of relaxation, which decides stability: all horizontals, all
/// verticals, the diagonals, the bends does not gain energy; row by row with all families interleaved does.
#[derive(Clone, Debug)]
pub struct TopologyBuilder {
    rest: Vec<Vec3>,
    topology: Topology,
    joined: Vec<(u32, u32)>,
}

impl TopologyBuilder {
    /// Starts with particles at `rest` positions (metres), which give the rest lengths.
    pub fn new(rest: &[Vec3]) -> Self {
        Self {
            rest: rest.to_vec(),
            topology: Topology { particle_count: rest.len(), ..Topology::default() },
            joined: Vec::new(),
        }
    }

    /// Adds a family of sticks of one material, at the length that the rest positions give. The family is
    /// split into batches that share no particle.
    ///
    /// # Errors
    /// [`BuildError`] if an end does not exist, both ends are the same, the ends coincide, or the material is
    /// out of range. Two sticks between the same particles are found by [`build`](Self::build).
    pub fn family(
        &mut self,
        material: StickMaterial,
        sticks: impl IntoIterator<Item = [u32; 2]>,
    ) -> Result<&mut Self, BuildError> {
        let mut measured = Vec::new();
        for [a, b] in sticks {
            self.check_index("a stick", a)?;
            self.check_index("a stick", b)?;
            let length = self.rest[a as usize].distance(self.rest[b as usize]);
            measured.push(([a, b], length));
        }
        self.family_with_lengths(material, measured)
    }

    /// Adds a family of sticks of one material, each with its rest length in metres.
    ///
    /// # Errors
    /// As [`family`](Self::family); a rest length that is zero, negative or not finite counts as coinciding ends.
    pub fn family_with_lengths(
        &mut self,
        material: StickMaterial,
        sticks: impl IntoIterator<Item = ([u32; 2], f32)>,
    ) -> Result<&mut Self, BuildError> {
        material.validate()?;
        let mut colours: Vec<Vec<([u32; 2], f32)>> = Vec::new();
        let mut used = vec![0u64; self.rest.len()];
        for ([a, b], length) in sticks {
            self.check_index("a stick", a)?;
            self.check_index("a stick", b)?;
            if a == b {
                return Err(BuildError::SameEnds { particle: a });
            }
            if !(length > 0.0 && length.is_finite()) {
                return Err(BuildError::ZeroRestLength { a, b });
            }
            let taken = used[a as usize] | used[b as usize];
            let colour = (taken.trailing_ones() as usize).min(MAX_COLOURS - 1);
            used[a as usize] |= 1 << colour;
            used[b as usize] |= 1 << colour;
            if colours.len() <= colour {
                colours.resize_with(colour + 1, Vec::new);
            }
            colours[colour].push(([a, b], length));
            self.joined.push((a.min(b), a.max(b)));
        }
        for sticks in colours {
            self.push_batch(material, &sticks);
        }
        Ok(self)
    }

    fn push_batch(&mut self, material: StickMaterial, sticks: &[([u32; 2], f32)]) {
        let Topology { a: starts, b: ends, rest_length, batches, runs, .. } = &mut self.topology;
        let (first, first_run) = (rest_length.len(), runs.len());
        for &([a, b], length) in sticks {
            let (place_a, place_b) = (a as usize, b as usize);
            match runs[first_run..].last_mut() {
                // The next stick goes on where the run ends, and the two slices still do not overlap.
                Some(run)
                    if place_a == run.a + run.count && place_b == run.b + run.count && place_a < run.b =>
                {
                    run.count += 1;
                }
                _ => runs.push(StickRun { first: rest_length.len(), count: 1, a: place_a, b: place_b }),
            }
            starts.push(a);
            ends.push(b);
            rest_length.push(length);
        }
        batches.push(StickBatch { material, first, count: sticks.len(), runs: (first_run, runs.len()) });
    }

    /// Adds the triangles of the surface.
    ///
    /// # Errors
    /// [`BuildError::NoSuchParticle`] if a corner does not exist.
    pub fn faces(&mut self, faces: impl IntoIterator<Item = [u32; 3]>) -> Result<&mut Self, BuildError> {
        for face in faces {
            for corner in face {
                self.check_index("a face", corner)?;
            }
            let [p, q, r] = face.map(|i| self.rest[i as usize]);
            self.note_edge(p.distance(q).max(q.distance(r)).max(r.distance(p)));
            self.topology.faces.push(face);
        }
        Ok(self)
    }

    /// Adds the segments that a body without faces touches others with.
    ///
    /// # Errors
    /// [`BuildError::NoSuchParticle`] if an end does not exist.
    pub fn segments(
        &mut self,
        segments: impl IntoIterator<Item = [u32; 2]>,
    ) -> Result<&mut Self, BuildError> {
        for segment in segments {
            for end in segment {
                self.check_index("a segment", end)?;
            }
            let [p, q] = segment.map(|i| self.rest[i as usize]);
            self.note_edge(p.distance(q));
            self.topology.segments.push(segment);
        }
        Ok(self)
    }

    /// Adds the tethers.
    ///
    /// # Errors
    /// [`BuildError::NoSuchParticle`] if they were made for another number of particles.
    pub fn tethers(&mut self, tethers: Tethers) -> Result<&mut Self, BuildError> {
        if let Some(index) = tethers.highest_index() {
            self.check_index("a tether", index)?;
        }
        self.topology.tethers = tethers;
        Ok(self)
    }

    /// The sticks so far, with their lengths: what geodesic tethers run along.
    pub fn edges(&self) -> impl Iterator<Item = (u32, u32, f32)> + '_ {
        let t = &self.topology;
        (0..t.stick_count()).map(|i| (t.a[i], t.b[i], t.rest_length[i]))
    }

    /// Finishes the topology.
    ///
    /// # Errors
    /// [`BuildError::DuplicateStick`] if two sticks join the same two particles.
    pub fn build(mut self) -> Result<Topology, BuildError> {
        if !self.topology.segments.is_empty() {
            // Sticks that were given their length may be longer at rest than their ends are apart now.
            self.note_edge(self.topology.rest_length.iter().copied().fold(0.0, f32::max));
        }
        self.joined.sort_unstable();
        if let Some(pair) = self.joined.windows(2).find(|pair| pair[0] == pair[1]) {
            let (a, b) = pair[0];
            return Err(BuildError::DuplicateStick { a, b });
        }
        Ok(self.topology)
    }

    fn note_edge(&mut self, length: f32) {
        self.topology.longest_edge = self.topology.longest_edge.max(length);
    }

    fn check_index(&self, what: &'static str, index: u32) -> Result<(), BuildError> {
        if (index as usize) < self.rest.len() {
            Ok(())
        } else {
            Err(BuildError::NoSuchParticle { what, index, count: self.rest.len() as u32 })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(count: usize) -> Vec<Vec3> {
        (0..count).map(|i| Vec3::X * i as f32).collect()
    }

    fn structural() -> StickMaterial {
        StickMaterial::rigid(StickKind::Structural)
    }

    #[test]
    fn sticks_of_a_batch_share_no_particle() {
        let mut builder = TopologyBuilder::new(&row(9));
        builder.family(structural(), (0..8).map(|i| [i, i + 1])).expect("valid");
        builder.family(StickMaterial::rigid(StickKind::Bend), (0..7).map(|i| [i, i + 2])).expect("valid");
        let topology = builder.build().expect("valid");
        assert_eq!(topology.stick_count(), 15);
        assert_eq!(topology.batches().len(), 4);
        for batch in topology.batches() {
            let mut ends: Vec<u32> = batch.range().flat_map(|i| topology.stick(i)).collect();
            let all = ends.len();
            ends.sort_unstable();
            ends.dedup();
            assert_eq!(ends.len(), all);
        }
    }

    #[test]
    fn runs_cover_every_stick_once_and_their_ends_do_not_overlap() {
        // A grid of 7 x 5: verticals and diagonals make runs, horizontals do not.
        let rest: Vec<Vec3> = (0..35).map(|i| Vec3::new((i % 7) as f32, (i / 7) as f32, 0.0)).collect();
        let mut builder = TopologyBuilder::new(&rest);
        builder.family(structural(), (0..35).filter(|i| i % 7 < 6).map(|i| [i, i + 1])).expect("valid");
        builder.family(structural(), (0..28).map(|i| [i, i + 7])).expect("valid");
        builder.family(structural(), (0..28).filter(|i| i % 7 < 6).map(|i| [i, i + 8])).expect("valid");
        let topology = builder.build().expect("valid");
        let mut covered = 0;
        for batch in topology.batches() {
            for run in topology.runs(batch) {
                assert_eq!(run.first, covered);
                covered += run.count;
                for k in 0..run.count {
                    assert_eq!(topology.stick(run.first + k), [(run.a + k) as u32, (run.b + k) as u32]);
                }
                assert!(run.count == 1 || run.a + run.count <= run.b);
            }
        }
        assert_eq!(covered, topology.stick_count());
        assert!(topology.runs.iter().any(|run| run.count >= 6), "whole rows make runs");
    }

    #[test]
    fn sticks_that_cannot_be_are_refused_with_the_particle_named() {
        let try_sticks = |rest: &[Vec3], sticks: &[[u32; 2]]| -> Result<(), BuildError> {
            let mut builder = TopologyBuilder::new(rest);
            builder.family(structural(), sticks.iter().copied())?;
            builder.build().map(|_| ())
        };
        let rest = row(3);
        assert_eq!(
            try_sticks(&rest, &[[0, 3]]),
            Err(BuildError::NoSuchParticle { what: "a stick", index: 3, count: 3 })
        );
        assert_eq!(try_sticks(&rest, &[[1, 1]]), Err(BuildError::SameEnds { particle: 1 }));
        assert_eq!(try_sticks(&rest, &[[0, 1], [1, 0]]), Err(BuildError::DuplicateStick { a: 0, b: 1 }));
        assert_eq!(try_sticks(&[Vec3::ZERO; 2], &[[0, 1]]), Err(BuildError::ZeroRestLength { a: 0, b: 1 }));
    }

    #[test]
    fn stiffness_outside_zero_to_one_is_refused() {
        for stiffness in [-0.1, 1.1, f32::NAN] {
            let material = StickMaterial { stiffness, ..structural() };
            assert!(TopologyBuilder::new(&row(2)).family(material, [[0, 1]]).is_err());
        }
    }
}
