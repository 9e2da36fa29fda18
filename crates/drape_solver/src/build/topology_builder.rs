//! Builds a topology from families of sticks, faces and tethers.
//!
//! Design: `docs/design/memory_layout.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::broad_phase::ball_search::are_by_square;
use crate::build::cloth::MAX_PARTICLES;
use crate::build::membrane::SpringConstants;
use crate::constants::{LEAST_RENUMBERED, MAX_COLOURS};
use crate::error::{BuildError, in_range};
use crate::state::bending_friction::BendingFriction;
use crate::state::bends::{BendingRigidity, Bends};
use crate::state::grid::GridBatch;
use crate::state::layout::{Grid, Layout};
use crate::state::membrane::Membrane;
use crate::state::renumbering::Renumbering;
use crate::state::stick_list::ListedBatch;
use crate::state::tethers::{TetherPlan, Tethers};
use crate::state::topology::{
    BatchSticks, EmbeddedPoint, StickBatch, StickBound, StickKind, StickMaterial, Topology,
};
use crate::union_find::Groups;

/// Builds a [`Topology`], one family of sticks after another.
///
/// Sticks are relaxed in the order of their families, and this order decides stability. All horizontals, all verticals,
/// the diagonals, then the bends gain no energy; row by row, with all families interleaved, they do.
#[derive(Clone, Debug)]
pub struct TopologyBuilder {
    rest: Vec<Vec3>,
    topology: Topology,
    /// Ends of the listed sticks, lower index first, and their bounds.
    joined: Vec<(u32, u32, StickBound)>,
    tethers: Tethers,
    rigidity: BendingRigidity,
    friction: BendingFriction,
    springs: SpringConstants,
    /// The numbers of columns and rows; one row if the particles form no grid.
    size: [u32; 2],
}

impl TopologyBuilder {
    /// Starts with particles at `rest` positions (metres). Rest lengths follow from them.
    pub fn new(rest: &[Vec3]) -> Self {
        Self {
            rest: rest.to_vec(),
            topology: Topology { layout: Layout::Linear { count: rest.len() }, ..Topology::default() },
            joined: Vec::new(),
            tethers: Tethers::none(),
            rigidity: BendingRigidity::default(),
            friction: BendingFriction::default(),
            springs: SpringConstants::default(),
            size: [rest.len() as u32, 1],
        }
    }

    /// Starts with a grid of `columns` x `rows` particles, row after row, at `rest` positions (metres).
    ///
    /// # Errors
    /// [`BuildError::NoSuchParticle`] if `rest` has another number of particles.
    pub fn grid(rest: &[Vec3], columns: u32, rows: u32) -> Result<Self, BuildError> {
        let (columns, rows) = (columns as usize, rows as usize);
        if columns.checked_mul(rows) != Some(rest.len()) {
            let (index, count) = (rest.len() as u32, columns.saturating_mul(rows) as u32);
            return Err(BuildError::NoSuchParticle { what: "a grid", index, count });
        }
        let mut builder = Self { size: [columns as u32, rows as u32], ..Self::new(rest) };
        if let Some(grid) = Grid::new(columns, rows) {
            builder.topology.layout = Layout::Grid(grid);
        }
        Ok(builder)
    }

    /// Adds a family of equal sticks of a [grid](Self::grid): from every particle to the one `right` columns to the right (to
    /// the left if negative) and `down` rows down. All get the rest length of the first. If `down` is not 0, `right` is at
    /// most one column.
    ///
    /// # Errors
    /// As [`family`](Self::family).
    pub fn grid_family(
        &mut self,
        material: StickMaterial,
        [right, down]: [i32; 2],
    ) -> Result<&mut Self, BuildError> {
        let [columns, rows] = self.size;
        let starts = |row: u32| (0..columns).map(move |column| (column, row));
        let cells = (0..rows.saturating_sub(down.unsigned_abs())).flat_map(starts);
        let ends = cells.filter_map(|(column, row)| {
            let to = column.checked_add_signed(right).filter(|&to| to < columns)?;
            Some([row * columns + column, (row + down.unsigned_abs()) * columns + to])
        });
        let grid = match self.topology.layout {
            Layout::Grid(grid) if material.bound == StickBound::Exact => grid,
            _ => return self.family(material, ends),
        };
        material.validate()?;
        let Some([a, b]) = ends.clone().next() else {
            return Ok(self);
        };
        let rest_length = self.rest[a as usize].distance(self.rest[b as usize]);
        if !(rest_length > 0.0 && rest_length.is_finite()) {
            return Err(BuildError::ZeroRestLength { a, b });
        }
        for batch in GridBatch::halves(grid, right as isize, down.unsigned_abs() as usize) {
            let sticks =
                BatchSticks::Grid { batch, runs: batch.runs(&[]), rest_length, severed: Box::default() };
            self.push_batch(material, batch.count(), sticks);
        }
        Ok(self)
    }

    /// Adds a family of sticks of one material, as long as their ends are apart at rest. Splits the family into batches in
    /// which no two sticks share a particle.
    ///
    /// # Errors
    /// [`BuildError`] if an end does not exist, both ends are the same, the ends coincide, or the material is out of range.
    /// [`build`](Self::build) rejects two sticks between the same particles.
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
        if self.rest.len() as u64 > MAX_PARTICLES {
            return Err(BuildError::TooManyParticles { found: self.rest.len() as u64, limit: MAX_PARTICLES });
        }
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
            self.joined.push((a.min(b), a.max(b), material.bound));
        }
        for (colour, sticks) in colours.iter().enumerate() {
            let listed = ListedBatch::new(self.topology.listed.begin_batch(), colour < MAX_COLOURS - 1);
            sticks.iter().for_each(|&(ends, length)| self.topology.listed.push(ends, length));
            self.push_batch(material, sticks.len(), BatchSticks::Listed(listed));
        }
        Ok(self)
    }

    fn push_batch(&mut self, material: StickMaterial, count: usize, sticks: BatchSticks) {
        if count > 0 {
            let first = self.topology.stick_count;
            self.topology.batches.push(StickBatch { material, first, count, sticks });
            self.topology.stick_count += count;
        }
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

    /// Adds segments: a body without faces touches others with them.
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

    /// Has the surface resist bending. A flat, even [grid](Self::grid) resists along its rows and columns, other bodies across the edges
    /// between two faces.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] if the rigidity is negative or too large.
    pub fn bending(&mut self, rigidity: BendingRigidity) -> Result<&mut Self, BuildError> {
        rigidity.validate()?;
        self.rigidity = rigidity;
        Ok(self)
    }

    /// Has friction hold the curvatures of a surface that resists [bending](Self::bending).
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] if the friction is negative or too large.
    pub fn bending_friction(&mut self, friction: BendingFriction) -> Result<&mut Self, BuildError> {
        friction.validate()?;
        self.friction = friction;
        Ok(self)
    }

    /// Has the sticks of a flat, even [grid](Self::grid) be springs of these constants.
    pub(crate) fn springs(&mut self, constants: SpringConstants) -> &mut Self {
        self.springs = constants;
        self
    }

    /// Adds points that touch obstacles. Four particles carry each.
    ///
    /// # Errors
    /// [`BuildError::NoSuchParticle`] if a carrier does not exist, [`BuildError::OutOfRange`] if weights do not sum to 1.
    pub fn embedded(
        &mut self,
        points: impl IntoIterator<Item = EmbeddedPoint>,
    ) -> Result<&mut Self, BuildError> {
        for point in points {
            for carrier in point.particles {
                self.check_index("an embedded point", carrier)?;
            }
            let sum: f32 = point.weights.iter().sum();
            in_range("the sum of an embedded point's weights", sum, 1.0 - 1e-3, 1.0 + 1e-3)?;
            let places = point.particles.map(|i| self.rest[i as usize]);
            let place = point.position(places);
            let nearest = places.map(|carrier| carrier.distance(place)).into_iter().fold(f32::MAX, f32::min);
            let spread: f32 = point.weights.iter().map(|weight| weight.abs()).sum();
            let reach = &mut self.topology.embedding_reach;
            reach.overhang = reach.overhang.max(nearest);
            reach.spread = reach.spread.max(spread);
            self.topology.embedded.push(point);
        }
        Ok(self)
    }

    /// Adds the tethers.
    ///
    /// # Errors
    /// [`BuildError::NoSuchParticle`] if a tether names a particle that does not exist.
    pub fn tethers(&mut self, tethers: Tethers) -> Result<&mut Self, BuildError> {
        if let Some(index) = tethers.highest_index() {
            self.check_index("a tether", index)?;
        }
        self.tethers = tethers;
        Ok(self)
    }

    /// Tethers every particle to the nearest of the `pins` of each group, at their distance at rest. Pins that sticks join to
    /// each other form a group. For bodies that are flat and convex.
    ///
    /// # Errors
    /// As [`tethers`](Self::tethers).
    pub fn straight_tethers(&mut self, pins: &[u32]) -> Result<&mut Self, BuildError> {
        let grouped = self.grouped(pins)?;
        let tethers = Tethers::straight_by_groups(&self.rest, &grouped);
        self.tethers(tethers)
    }

    /// The same along the sticks so far, for bodies of any form.
    ///
    /// # Errors
    /// As [`tethers`](Self::tethers).
    pub fn geodesic_tethers(&mut self, pins: &[u32]) -> Result<&mut Self, BuildError> {
        let grouped = self.grouped(pins)?;
        let tethers = Tethers::geodesic_by_groups(self.rest.len(), self.edges(), &grouped);
        self.tethers(tethers)
    }

    /// The pins in order, each with its group: pins that sticks join to each other form one.
    fn grouped(&self, pins: &[u32]) -> Result<Vec<(u32, u32)>, BuildError> {
        for &pin in pins {
            self.check_index("a pin", pin)?;
        }
        let mut groups = Groups::new(self.rest.len());
        let mut is_pin = vec![false; self.rest.len()];
        pins.iter().for_each(|&pin| is_pin[pin as usize] = true);
        for (a, b, _) in self.edges().filter(|&(a, b, _)| is_pin[a as usize] && is_pin[b as usize]) {
            groups.join(a, b);
        }
        let mut grouped: Vec<(u32, u32)> = pins.iter().map(|&pin| (pin, groups.root(pin))).collect();
        grouped.sort_unstable();
        grouped.dedup();
        Ok(grouped)
    }

    /// The sticks so far that limit the distance of their ends, with their rest lengths in metres. Geodesic tethers run along
    /// them.
    pub fn edges(&self) -> impl Iterator<Item = (u32, u32, f32)> + '_ {
        let t = &self.topology;
        let batches = t.batches.iter().filter(|batch| batch.material.bound != StickBound::AtLeast);
        batches.flat_map(StickBatch::range).map(|i| {
            let [a, b] = t.stick(i);
            (a, b, t.rest_length(i))
        })
    }

    /// Finishes the topology.
    ///
    /// # Errors
    /// [`BuildError::DuplicateStick`] if two sticks of the same bound join the same two particles.
    pub fn build(mut self) -> Result<Topology, BuildError> {
        if !self.topology.segments.is_empty() {
            // A stick with a given rest length may be longer than its ends are apart now.
            let lengths = (0..self.topology.stick_count()).map(|i| self.topology.rest_length(i));
            self.note_edge(lengths.fold(0.0, f32::max));
        }
        self.joined.sort_unstable();
        if let Some(pair) = self.joined.windows(2).find(|pair| pair[0] == pair[1]) {
            let (a, b, _) = pair[0];
            return Err(BuildError::DuplicateStick { a, b });
        }
        self.arrange();
        self.topology.tethers = TetherPlan::new(&self.tethers, &self.topology.layout);
        self.topology.rest = self.rest;
        let size = (self.size[1] > 1).then_some(self.size);
        self.topology.bends = Bends::new(&self.topology, size, self.rigidity, self.friction);
        self.topology.membrane = size.and_then(|size| Membrane::new(&self.topology, size, self.springs));
        self.topology.has_faces_by_square =
            self.topology.segments.is_empty() && are_by_square(&self.topology.faces, &self.topology.layout);
        Ok(self.topology)
    }

    /// The structural sticks, which join neighbours; all sticks if there are none. (Bend sticks skip a particle.)
    fn nearest_neighbours(&self) -> Vec<(u32, u32)> {
        let t = &self.topology;
        let structural = t.batches.iter().filter(|batch| batch.material.kind == StickKind::Structural);
        let ends = |i: usize| t.stick(i).into();
        let sticks: Vec<(u32, u32)> = structural.flat_map(StickBatch::range).map(ends).collect();
        if sticks.is_empty() { self.joined.iter().map(|&(a, b, _)| (a, b)).collect() } else { sticks }
    }

    /// Assigns a slot to each particle, and sorts the listed sticks by slots.
    fn arrange(&mut self) {
        let sticks = self.nearest_neighbours();
        let Topology { layout, batches, listed, .. } = &mut self.topology;
        if let Layout::Linear { count } = *layout
            && count >= LEAST_RENUMBERED
            && let Some(renumbering) = Renumbering::new(count, &sticks)
        {
            *layout = Layout::Renumbered(Arc::new(renumbering));
        }
        let slot = |index: u32| layout.slot(index as usize) as u32;
        for StickBatch { sticks, count, .. } in batches {
            if let BatchSticks::Listed(batch) = sticks {
                batch.arrange(listed, *count, layout.cells(), slot);
            }
        }
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
