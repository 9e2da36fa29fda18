//! The rest data of a body: which particles are joined, and how long the sticks are.

use std::sync::OnceLock;

#[cfg(feature = "bevy")]
use bevy_reflect::std_traits::ReflectDefault;
use glam::{DMat3, Vec3};

use crate::error::{BuildError, in_range};
use crate::state::grid::{GridBatch, GridRuns};
use crate::state::layout::Layout;
use crate::state::stick_list::{ListedBatch, ListedSticks};
use crate::state::surface_tree::SurfaceTree;
use crate::state::tethers::TetherPlan;
use crate::state::volume::RestVolume;

/// What a stick is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
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

/// Which lengths a stick allows: all three act at the rest length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
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
    /// The part of a strain, or of any length beyond the rest length, that a stick acts against.
    pub fn violation(self, strain: f64) -> f64 {
        match self {
            Self::Exact => strain,
            Self::AtLeast => strain.min(0.0),
            Self::AtMost => strain.max(0.0),
        }
    }
}

/// How a stick reacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickMaterial {
    /// What the stick is for.
    pub kind: StickKind,
    /// From 0 (slack) to 1 (rigid): the part of its strain that an isolated stick loses in one reference step
    /// of 1/60 s. See [`crate::constraint::stick::iteration_stiffness`] for how this is kept independent of the step.
    pub stiffness: f32,
    /// Damping along the stick in 1/s, 0 or more: the speed at which the ends part decays as `exp(-damping t)`. One with a
    /// bound is damped while it is within a thousandth of it, or beyond.
    pub damping: f32,
    /// Which lengths it allows.
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
    /// How the sticks react.
    pub material: StickMaterial,
    /// Index of the first stick.
    pub first: usize,
    /// Number of sticks.
    pub count: usize,
    pub(crate) sticks: BatchSticks,
}

/// Where the ends of a batch's sticks are found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BatchSticks {
    /// Equal sticks of a grid, all of this length in metres: worked out, not stored. Those that are severed, in ascending
    /// order, do not count.
    Grid { batch: GridBatch, runs: GridRuns, rest_length: f32, severed: Box<[u32]> },
    /// In the topology's list.
    Listed(ListedBatch),
    /// The few of a torn grid that are no longer of its families.
    Loose(Box<[LooseStick]>),
}

/// A stick that is relaxed by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LooseStick {
    pub slots: [u32; 2],
    /// Metres.
    pub rest_length: f32,
}

impl StickBatch {
    /// Which of a grid family's sticks stick `i` is, if these are `severed`.
    pub(crate) fn place_in_family(&self, i: usize, severed: &[u32]) -> usize {
        kept(i - self.first, severed)
    }

    /// The indices of the batch's sticks.
    pub fn range(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// A point that four particles carry, at the sum of their positions times these weights: a corner of the collision mesh of
/// a rigid body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EmbeddedPoint {
    /// By index.
    pub particles: [u32; 4],
    /// They sum to 1. Outside the tetrahedron of the four, some are negative.
    pub weights: [f32; 4],
}

impl EmbeddedPoint {
    /// The `point` that these `particles` carry when they are at `places`: its barycentric coordinates there. None where
    /// the four lie in a plane.
    pub fn new(particles: [u32; 4], places: [Vec3; 4], point: Vec3) -> Option<Self> {
        let [origin, a, b, c] = places.map(Vec3::as_dvec3);
        let axes = DMat3::from_cols(a - origin, b - origin, c - origin);
        let longest = axes.x_axis.length().max(axes.y_axis.length()).max(axes.z_axis.length());
        if axes.determinant().abs() <= FLAT * longest * longest * longest {
            return None;
        }
        let along = (axes.inverse() * (point.as_dvec3() - origin)).as_vec3();
        let weights = [1.0 - along.x - along.y - along.z, along.x, along.y, along.z];
        weights.iter().all(|weight| weight.is_finite()).then_some(Self { particles, weights })
    }

    /// Where it is when its carriers are at `places`.
    pub fn position(&self, [a, b, c, d]: [Vec3; 4]) -> Vec3 {
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2] + d * self.weights[3]
    }
}

/// Six times the volume of four points that count as lying in a plane, in parts of the cube of their greatest distance.
const FLAT: f64 = 1e-6;

/// How far embedded points are out of the box around the particles, and how much faster they may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EmbeddingReach {
    /// Greatest distance from a point to the nearest of its carriers at rest, in metres.
    pub overhang: f32,
    /// Greatest sum of the sizes of a point's weights: 1 where there are no points.
    pub spread: f32,
}

impl Default for EmbeddingReach {
    fn default() -> Self {
        Self { overhang: 0.0, spread: 1.0 }
    }
}

/// The rest data of a body. Immutable while the body lives, so that equal bodies can share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    pub(crate) layout: Layout,
    pub(crate) listed: ListedSticks,
    pub(crate) batches: Vec<StickBatch>,
    pub(crate) stick_count: usize,
    pub(crate) tethers: TetherPlan,
    pub(crate) faces: Vec<[u32; 3]>,
    /// Whether they are those of a grid's squares, two of each, row by row.
    pub(crate) has_faces_by_square: bool,
    pub(crate) segments: Vec<[u32; 2]>,
    pub(crate) embedded: Vec<EmbeddedPoint>,
    pub(crate) embedding_reach: EmbeddingReach,
    /// Longest side of a face or segment at rest, in metres: how far a contact can be from the nearest corner.
    pub(crate) longest_edge: f32,
    /// Where the particles are at rest, by index, in metres: tells which are neighbours in self-contact.
    pub(crate) rest: Vec<Vec3>,
    pub(crate) surface: LazySurface,
    pub(crate) rest_volume: RestVolume,
}

/// The tree of the surface, made when it is first asked for. As it follows from the rest, any two are equal.
#[derive(Clone, Debug, Default)]
pub(crate) struct LazySurface(OnceLock<SurfaceTree>);

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
        let batch = self.batch_of(i);
        match &batch.sticks {
            BatchSticks::Grid { batch: grid, severed, .. }
                if severed.is_empty() && !self.layout.is_torn() =>
            {
                grid.particles(i - batch.first).map(|end| end as u32)
            }
            _ => {
                self.stick_slots(i).map(|slot| self.layout.index(slot).map_or(u32::MAX, |index| index as u32))
            }
        }
    }

    /// The slots of its ends.
    pub(crate) fn stick_slots(&self, i: usize) -> [usize; 2] {
        let batch = self.batch_of(i);
        match &batch.sticks {
            BatchSticks::Grid { batch: grid, severed, .. } => grid.slots(kept(i - batch.first, severed)),
            BatchSticks::Listed(listed) => {
                self.listed.slots(listed.first + i - batch.first).map(|slot| slot as usize)
            }
            BatchSticks::Loose(loose) => loose[i - batch.first].slots.map(|slot| slot as usize),
        }
    }

    /// The rest length of stick `i` in metres.
    pub fn rest_length(&self, i: usize) -> f32 {
        let batch = self.batch_of(i);
        match &batch.sticks {
            BatchSticks::Grid { rest_length, .. } => *rest_length,
            BatchSticks::Listed(listed) => self.listed.rest_length(listed.first + i - batch.first),
            BatchSticks::Loose(loose) => loose[i - batch.first].rest_length,
        }
    }

    fn batch_of(&self, stick: usize) -> &StickBatch {
        &self.batches[self.batches.partition_point(|batch| batch.first + batch.count <= stick)]
    }

    /// Where particle `i` was at rest, in metres.
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
        size_of_val(&*self.rest) + numbers + self.listed.bytes() + runs + self.tethers.bytes()
    }

    /// The surface as contacts by triangles look at it.
    pub(crate) fn surface_tree(&self) -> &SurfaceTree {
        self.surface.0.get_or_init(|| SurfaceTree::new(self))
    }

    /// How many blocks of particles are in use at once while listed sticks are relaxed.
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

    /// Points that touch obstacles besides the particles: the corners of rigid parts.
    pub fn embedded(&self) -> &[EmbeddedPoint] {
        &self.embedded
    }

    /// How far [embedded points](Self::embedded) can be outside the box around the particles, in metres.
    pub fn overhang(&self) -> f32 {
        self.embedding_reach.overhang
    }

    /// Segments that a body without faces touches others with: the links of a rope.
    pub fn segments(&self) -> &[[u32; 2]] {
        &self.segments
    }
}

/// Which of a family's sticks is number `i` of those that are not `severed`.
fn kept(i: usize, severed: &[u32]) -> usize {
    let mut before = 0;
    let mut end = severed.len();
    // So many are severed before it that the numbers of the others catch up.
    while before < end {
        let middle = before.midpoint(end);
        if severed[middle] as usize - middle <= i { before = middle + 1 } else { end = middle }
    }
    i + before
}

#[cfg(test)]
mod tests {
    use super::kept;

    #[test]
    fn sticks_that_are_kept_are_numbered_in_order() {
        let severed = [0, 3, 4, 7];
        let expected = [1, 2, 5, 6, 8, 9];
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| kept(i, &severed)), expected);
        assert_eq!([0, 1, 2].map(|i| kept(i, &[])), [0, 1, 2]);
    }
}
