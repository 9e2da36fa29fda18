//! The rest data of a body: sticks with their lengths, tethers, faces and rest positions.

use std::sync::OnceLock;

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;
use glam::Vec3;

use crate::error::{BuildError, in_range};
use crate::state::bends::Bends;
use crate::state::embedded_point::EmbeddingReach;
use crate::state::face_part::FacePart;
use crate::state::grid::{GridBatch, GridRuns};
use crate::state::layout::{Grid, Layout};
use crate::state::membrane::Membrane;
use crate::state::stick_list::{ListedBatch, ListedSticks};
use crate::state::surface::Surface;
use crate::state::tethers::TetherPlan;
use crate::state::volume::RestVolume;

pub use crate::state::embedded_point::EmbeddedPoint;

/// The purpose of a stick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
pub enum StickKind {
    /// Joins neighbours: keeps the cloth from stretching.
    #[default]
    Structural,
    /// Joins diagonals: keeps squares from becoming rhombs.
    Shear,
    /// Skips one particle: keeps the cloth from folding flat.
    Bend,
}

/// The lengths that a stick allows. The rest length is always allowed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "bevy", derive(bevy_reflect::Reflect), reflect(Default, Debug, Clone, PartialEq))]
pub enum StickBound {
    /// The rest length alone: a rod.
    #[default]
    Exact,
    /// The rest length and more: a stick that acts only when it is shorter. Between two limbs it keeps a joint from
    /// closing (Jakobsen 2001, section 6, "angular limits").
    AtLeast,
    /// The rest length and less: a cord, that acts only when it is longer.
    AtMost,
}

impl StickBound {
    /// The part of a strain, or of a length beyond the rest length, that a stick corrects.
    pub fn violation(self, strain: f64) -> f64 {
        match self {
            Self::Exact => strain,
            Self::AtLeast => strain.min(0.0),
            Self::AtMost => strain.max(0.0),
        }
    }
}

/// Purpose, stiffness, damping and bound of a stick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StickMaterial {
    /// The purpose of the stick.
    pub kind: StickKind,
    /// From 0 (slack) to 1 (rigid): the part of its strain that an isolated stick loses in one reference step
    /// of 1/60 s. See [`crate::constraint::stick::iteration_stiffness`] for how this is kept independent of the step.
    pub stiffness: f32,
    /// Damping along the stick in 1/s, 0 or more: the relative speed of the ends decays as `exp(-damping t)`. A stick
    /// with a bound is damped within a thousandth of it, or beyond.
    pub damping: f32,
    /// The lengths that it allows.
    pub bound: StickBound,
}

impl StickMaterial {
    /// A rigid, undamped stick of `kind`.
    pub fn rigid(kind: StickKind) -> Self {
        Self { kind, stiffness: 1.0, damping: 0.0, bound: StickBound::Exact }
    }

    pub(crate) fn validate(&self) -> Result<(), BuildError> {
        in_range("stiffness", self.stiffness, 0.0, 1.0)?;
        in_range("damping", self.damping, 0.0, 1e6)?;
        Ok(())
    }
}

/// Sticks of one material that share no particle, so that they may be relaxed in any order, or at once.
#[derive(Clone, Debug, PartialEq)]
pub struct StickBatch {
    /// The material of the sticks.
    pub material: StickMaterial,
    /// Index of the first stick.
    pub first: usize,
    /// Number of sticks.
    pub count: usize,
    pub(crate) sticks: BatchSticks,
}

/// Equal sticks of a grid: from each particle at (column, row) to the one at (column + right, row + down). A family is split in two, by
/// columns if its sticks lie along the rows, and else by rows: into sticks that begin at even places and at odd ones. Places of
/// skip-one sticks count in pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridFamily {
    /// Columns to the right from one end to the other; negative to the left.
    pub right: i32,
    /// Rows down from one end to the other.
    pub down: u32,
    /// 0 for sticks that begin at even places, 1 for the others.
    pub phase: u32,
    /// Metres.
    pub rest_length: f32,
}

/// The storage of a batch's sticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BatchSticks {
    /// Equal sticks of a grid, all of this length in metres; their ends are computed, not stored. The ascending list
    /// `severed` names those that are gone.
    Grid { batch: GridBatch, runs: GridRuns, rest_length: f32, severed: Box<[u32]> },
    /// Sticks in the topology's list.
    Listed(ListedBatch),
    /// The few sticks of a torn grid that no longer fit its families.
    Loose(Box<[LooseStick]>),
}

/// A stick of a torn grid that is in none of its families.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LooseStick {
    pub slots: [u32; 2],
    /// Metres.
    pub rest_length: f32,
}

impl StickBatch {
    /// The index of stick `i` in its whole family, if these sticks of the family are `severed`.
    pub(crate) fn place_in_family(&self, i: usize, severed: &[u32]) -> usize {
        index_in_family(i - self.first, severed)
    }

    /// The number of stick `place` of its whole family, if these are `severed`; none if it is one of them.
    pub(crate) fn number_of(&self, place: usize, severed: &[u32]) -> Option<usize> {
        let before = severed.binary_search(&(place as u32)).err()?;
        Some(self.first + place - before)
    }

    /// The family of a grid to which the sticks belong, unless they are listed one by one. It does not tell which of its sticks are severed:
    /// see [`Topology::grid_size`].
    pub fn family(&self) -> Option<GridFamily> {
        let BatchSticks::Grid { batch, rest_length, .. } = &self.sticks else { return None };
        let (right, down) = batch.offset();
        Some(GridFamily {
            right: right as i32,
            down: down as u32,
            phase: batch.phase() as u32,
            rest_length: *rest_length,
        })
    }

    /// The indices of the batch's sticks.
    pub fn range(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// The part of a face's area that is a whole face, but for rounding.
const WHOLE: f32 = 0.9999;

/// The rest data of a body. Immutable while the body lives, so that equal bodies can share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    pub(crate) layout: Layout,
    pub(crate) listed: ListedSticks,
    pub(crate) batches: Vec<StickBatch>,
    pub(crate) stick_count: usize,
    pub(crate) bends: Bends,
    pub(crate) membrane: Option<Membrane>,
    pub(crate) tethers: TetherPlan,
    pub(crate) faces: Vec<[u32; 3]>,
    /// In order of their faces.
    pub(crate) parts: Vec<FacePart>,
    /// True if the faces are those of a grid's squares, two for each, row by row.
    pub(crate) has_faces_by_square: bool,
    pub(crate) segments: Vec<[u32; 2]>,
    pub(crate) embedded: Vec<EmbeddedPoint>,
    pub(crate) embedding_reach: EmbeddingReach,
    /// Longest side of a face or segment at rest, in metres: the greatest distance of a contact from the nearest
    /// corner.
    pub(crate) longest_edge: f32,
    /// Rest positions by index, in metres; self-contact finds neighbours by them.
    pub(crate) rest: Vec<Vec3>,
    pub(crate) surface: LazySurface,
    pub(crate) rest_volume: RestVolume,
}

/// The surface for contacts, built at its first use. It follows from the rest data, so any two are equal.
#[derive(Clone, Debug, Default)]
pub(crate) struct LazySurface(OnceLock<Surface>);

impl PartialEq for LazySurface {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Topology {
    /// The number of particles that the topology is made for.
    pub fn particle_count(&self) -> usize {
        self.layout.count()
    }

    /// The number of sticks.
    pub fn stick_count(&self) -> usize {
        self.stick_count
    }

    /// The two particles that stick `i` joins.
    ///
    /// # Panics
    /// If `i` is out of range; so does [`rest_length`](Self::rest_length).
    pub fn stick(&self, i: usize) -> [u32; 2] {
        self.stick_of(self.batch_of(i), i)
    }

    /// The particles that stick `i` of a batch joins.
    fn stick_of(&self, batch: &StickBatch, i: usize) -> [u32; 2] {
        match &batch.sticks {
            BatchSticks::Grid { batch: grid, severed, .. }
                if severed.is_empty() && !self.layout.is_torn() =>
            {
                grid.particles(i - batch.first).map(|end| end as u32)
            }
            _ => {
                let index = |slot| self.layout.index(slot).map_or(u32::MAX, |index| index as u32);
                self.slots_of(batch, i).map(index)
            }
        }
    }

    /// The sticks of a batch: particles and rest length in metres.
    pub(crate) fn sticks_of<'a>(
        &'a self,
        batch: &'a StickBatch,
    ) -> impl ExactSizeIterator<Item = ([u32; 2], f32)> + 'a {
        batch.range().map(|i| (self.stick_of(batch, i), self.rest_length_of(batch, i)))
    }

    /// The slots of the two particles that stick `i` joins.
    pub(crate) fn stick_slots(&self, i: usize) -> [usize; 2] {
        self.slots_of(self.batch_of(i), i)
    }

    fn slots_of(&self, batch: &StickBatch, i: usize) -> [usize; 2] {
        match &batch.sticks {
            BatchSticks::Grid { batch: grid, severed, .. } => {
                grid.slots(index_in_family(i - batch.first, severed))
            }
            BatchSticks::Listed(listed) => {
                self.listed.slots(listed.first + i - batch.first).map(|slot| slot as usize)
            }
            BatchSticks::Loose(loose) => loose[i - batch.first].slots.map(|slot| slot as usize),
        }
    }

    /// The rest length of stick `i` in metres.
    pub fn rest_length(&self, i: usize) -> f32 {
        self.rest_length_of(self.batch_of(i), i)
    }

    fn rest_length_of(&self, batch: &StickBatch, i: usize) -> f32 {
        match &batch.sticks {
            BatchSticks::Grid { rest_length, .. } => *rest_length,
            BatchSticks::Listed(listed) => self.listed.rest_length(listed.first + i - batch.first),
            BatchSticks::Loose(loose) => loose[i - batch.first].rest_length,
        }
    }

    fn batch_of(&self, stick: usize) -> &StickBatch {
        &self.batches[self.batches.partition_point(|batch| batch.first + batch.count <= stick)]
    }

    /// Rest position of particle `i`, in metres.
    ///
    /// # Panics
    /// If `i` is out of range.
    pub fn rest_position(&self, i: usize) -> Vec3 {
        self.rest[i]
    }

    /// The batches in the order in which they are relaxed.
    pub fn batches(&self) -> &[StickBatch] {
        &self.batches
    }

    /// The tethers, each as (particle, pin, length in metres).
    pub fn tethers(&self) -> Vec<(u32, u32, f32)> {
        self.tethers.list(&self.layout)
    }

    /// Columns and rows of a grid; none if it is no grid, if it is torn, or if it has sticks of no family.
    pub fn grid_size(&self) -> Option<[usize; 2]> {
        let Layout::Grid(Grid { columns, rows, .. }) = self.layout else { return None };
        let is_whole = |batch: &StickBatch| matches!(&batch.sticks, BatchSticks::Grid { severed, .. } if severed.is_empty());
        self.batches.iter().all(is_whole).then_some([columns, rows])
    }

    /// True if the air pushes on the squares of a grid, false if on each of the [faces](Self::faces) and
    /// [segments](Self::segments).
    pub fn has_squares(&self) -> bool {
        self.has_faces_by_square && self.grid_size().is_some_and(|[columns, rows]| columns > 1 && rows > 1)
    }

    /// True if it resists bending by a [rigidity](crate::BendingRigidity).
    pub fn has_bending_rigidity(&self) -> bool {
        !self.bends.rigidity.is_zero()
    }

    /// True if it resists stretch or shear by a [stiffness in N/m](crate::MembraneStiffness).
    pub fn has_membrane(&self) -> bool {
        self.membrane.is_some()
    }

    /// True if it is a part of a grid that has torn.
    pub(crate) fn is_torn_grid(&self) -> bool {
        self.layout.is_torn() || self.membrane.is_some_and(|membrane| membrane.size.is_none())
    }

    /// Column and row of particle `index` in a torn grid, or of the one it was split from.
    pub(crate) fn place_in_grid(&self, index: usize) -> Option<[isize; 2]> {
        match (&self.layout, self.membrane) {
            (Layout::Torn(torn), _) => {
                Some(torn.grid.place(torn.home(index) as usize).map(|place| place as isize))
            }
            (_, Some(membrane)) => Some(membrane.place(self.rest[index])),
            _ => None,
        }
    }

    /// True if rows or columns are solved directly in any case, as their bends or sticks have compliances.
    pub(crate) fn has_elastic_lines(&self) -> bool {
        self.bends.lines.is_some() || self.membrane.is_some()
    }

    /// True if the particles are in one line.
    pub(crate) fn is_rope(&self) -> bool {
        matches!(self.layout.grid(), Some(Grid { rows: 1, .. } | Grid { columns: 1, .. }))
    }

    /// Greatest length in metres of a rope between two of its particles: none if the body is no rope, is torn, or may
    /// stretch.
    pub(crate) fn rope_length(&self, [from, to]: [usize; 2]) -> Option<f32> {
        if !self.is_rope() || self.layout.is_torn() {
            return None;
        }
        let link = self.batches.iter().find(|batch| batch.material.kind == StickKind::Structural)?;
        match link.sticks {
            BatchSticks::Grid { rest_length, .. } if link.material.stiffness >= 1.0 => {
                Some(rest_length * from.abs_diff(to) as f32)
            }
            _ => None,
        }
    }

    /// Memory of rest positions, sticks and tethers on the heap, in bytes.
    pub fn bytes(&self) -> usize {
        let runs = |batch: &StickBatch| match &batch.sticks {
            BatchSticks::Grid { runs, severed, .. } => runs.bytes() + size_of_val(&**severed),
            BatchSticks::Listed(listed) => listed.bytes(),
            BatchSticks::Loose(loose) => size_of_val(&**loose),
        };
        let numbers = match &self.layout {
            Layout::Renumbered(renumbering) => renumbering.bytes(),
            Layout::Torn(torn) => torn.bytes(),
            Layout::Linear { .. } | Layout::Grid(_) => 0,
        };
        let runs = self.batches.iter().map(runs).sum::<usize>();
        size_of_val(&*self.rest)
            + numbers
            + self.listed.bytes()
            + runs
            + self.bends.bytes()
            + self.tethers.bytes()
    }

    /// The surface, for contact between triangles.
    pub(crate) fn surface(&self) -> &Surface {
        self.surface.0.get_or_init(|| Surface::new(self))
    }

    /// The number of blocks of particles that the relaxation of listed sticks uses at once.
    pub(crate) fn window(&self) -> usize {
        let listed = self.batches.iter().filter_map(|batch| match &batch.sticks {
            BatchSticks::Listed(listed) => Some(listed),
            BatchSticks::Grid { .. } | BatchSticks::Loose(_) => None,
        });
        if self.listed.is_empty() { 0 } else { 1 + listed.map(ListedBatch::reach).sum::<usize>() }
    }

    /// Triangles of the surface, as particle indices, counter-clockwise seen from the front.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The parts of the faces that blades have crossed, in order of the faces. The others are whole.
    pub fn face_parts(&self) -> &[FacePart] {
        &self.parts
    }

    /// The triangles of the surface that is left: the particles of a face, and the weights of each of them at the triangle's three
    /// corners. A whole face is one triangle, a [part](Self::face_parts) as many as it needs.
    pub fn triangles(&self) -> impl Iterator<Item = ([u32; 3], [Vec3; 3])> + '_ {
        self.faces_with_parts().flat_map(|(face, parts)| {
            let whole = parts.is_empty().then_some([Vec3::X, Vec3::Y, Vec3::Z]);
            let of_parts = parts
                .iter()
                .flat_map(|part| part.triangles().map(|corners| corners.map(|corner| part.corners[corner])));
            whole.into_iter().chain(of_parts).map(move |weights| (face, weights))
        })
    }

    /// For each particle, true if it is virtual: a copy whose place belongs to none of its faces, which only carries their parts beyond a
    /// cut. Empty if no face was cut.
    pub fn virtual_particles(&self) -> Vec<bool> {
        if self.parts.is_empty() {
            return Vec::new();
        }
        let mut is_virtual = vec![false; self.particle_count()];
        self.faces.iter().flatten().for_each(|&corner| is_virtual[corner as usize] = true);
        for (face, weights) in self.triangles() {
            for (corner, place) in face.into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
                is_virtual[corner as usize] &= !weights.contains(&place);
            }
        }
        is_virtual
    }

    /// The faces by which the body touches itself and other bodies: those that are whole. The two sides of a cut, which both have the
    /// faces of the cut, do not lie across each other.
    pub(crate) fn contact_faces(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let is_whole =
            |parts: &[FacePart]| parts.is_empty() || parts.iter().map(FacePart::share).sum::<f32>() > WHOLE;
        self.faces_with_parts().filter(move |(_, parts)| is_whole(parts)).map(|(face, _)| face)
    }

    /// Each face and its parts, of which a whole one has none.
    fn faces_with_parts(&self) -> impl Iterator<Item = ([u32; 3], &[FacePart])> {
        let mut others = &self.parts[..];
        (0..).zip(&self.faces).map(move |(number, &face)| {
            let own = others.iter().take_while(|part| part.face == number).count();
            let (parts, rest) = others.split_at(own);
            others = rest;
            (face, parts)
        })
    }

    /// Points that touch obstacles besides the particles: the corners of rigid parts.
    pub fn embedded(&self) -> &[EmbeddedPoint] {
        &self.embedded
    }

    /// Greatest distance in metres of [embedded points](Self::embedded) from the box around the particles.
    pub fn overhang(&self) -> f32 {
        self.embedding_reach.overhang
    }

    /// The links of a rope: segments by which a body without faces touches others.
    pub fn segments(&self) -> &[[u32; 2]] {
        &self.segments
    }
}

/// The index in its family of the `i`-th stick that is not `severed`.
fn index_in_family(i: usize, severed: &[u32]) -> usize {
    let mut before = 0;
    let mut end = severed.len();
    // Finds the number of severed sticks before it by bisection.
    while before < end {
        let middle = before.midpoint(end);
        if severed[middle] as usize - middle <= i { before = middle + 1 } else { end = middle }
    }
    i + before
}

#[cfg(test)]
mod tests {
    use super::index_in_family;

    #[test]
    fn sticks_that_are_kept_are_numbered_in_order() {
        let severed = [0, 3, 4, 7];
        let expected = [1, 2, 5, 6, 8, 9];
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| index_in_family(i, &severed)), expected);
        assert_eq!([0, 1, 2].map(|i| index_in_family(i, &[])), [0, 1, 2]);
    }
}
