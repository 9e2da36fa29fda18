//! A torn topology as plain numbers, from which it is built again: for files.
//!
//! ```
//! use drape_solver::glam::Vec3;
//! use drape_solver::{BodySettings, ClothBuilder, TornTopology};
//!
//! let mut sheet = ClothBuilder::new(1.0, 1.0, 9, 9)
//!     .placed(Vec3::new(-0.5, 1.0, 0.0), Vec3::X, Vec3::NEG_Y)
//!     .build(BodySettings::default())?;
//! let whole = sheet.topology.clone();
//! sheet.cut(&[[Vec3::new(0.05, -9.0, -9.0), Vec3::new(0.05, 9.0, -9.0), Vec3::new(0.05, 0.0, 9.0)]])?;
//! let numbers = TornTopology::new(&sheet.topology, &whole);
//! assert_eq!(numbers.build(&whole)?, *sheet.topology);
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Design: `docs/design/snapshots.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::build::cloth::MAX_PARTICLES;
use crate::error::{BuildError, in_range};
use crate::state::bending_friction::BendingFriction;
use crate::state::bends::{BendingRigidity, Bends};
use crate::state::face_part::{Entry, FacePart, Marks};
use crate::state::grid::GridBatch;
use crate::state::layout::{Grid, Layout};
use crate::state::membrane::Membrane;
use crate::state::renumbering::Renumbering;
use crate::state::stick_list::ListedBatch;
use crate::state::tethers::{TetherPlan, Tethers};
use crate::state::topology::{BatchSticks, LooseStick, StickBatch, StickMaterial, Topology};
use crate::state::torn_grid::TornGrid;

/// A [`Topology`] that tears and cuts have changed, as plain numbers.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TornTopology {
    parts: Vec<PlainPart>,
    /// None if only faces have been divided.
    opened: Option<Opened>,
}

/// A body whose particles have been split.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Opened {
    arrangement: Arrangement,
    rest: Vec<[f32; 3]>,
    batches: Vec<(StickMaterial, PlainSticks)>,
    faces: Vec<[u32; 3]>,
    segments: Vec<[u32; 2]>,
    tethers: Vec<(u32, u32, f32)>,
    longest_edge: f32,
    rigidity: BendingRigidity,
    friction: BendingFriction,
}

/// The arrangement of particles in memory.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Arrangement {
    /// In order of the index.
    InOrder,
    /// The particle in each slot.
    Renumbered(Vec<u32>),
    /// Columns and rows of a torn grid, and the home of each particle in it.
    Torn([u32; 2], Vec<u32>),
}

/// The sticks of a batch.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum PlainSticks {
    /// Columns to the right, rows down, half, rest length and missing sticks of a family.
    Family([i32; 2], u8, f32, Vec<u32>),
    /// Ends and rest lengths, and true if no two sticks share a particle.
    Listed(Vec<PlainStick>, bool),
    /// Ends and rest lengths of sticks that are relaxed one by one.
    Loose(Vec<PlainStick>),
}

/// The ends of a stick, and its rest length in metres.
type PlainStick = ([u32; 2], f32);

/// Part of a face: face, corners, the ways of blades that have ended inside, open stretches of its edges.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct PlainPart(u32, Vec<[f32; 3]>, Vec<[[f32; 3]; 2]>, Vec<[[f32; 3]; 2]>);

impl TornTopology {
    /// The numbers of a topology that tears and cuts have made of the topology of a `whole` body.
    pub fn new(topology: &Topology, whole: &Topology) -> Self {
        let arrangement = match &topology.layout {
            Layout::Torn(torn) => Some(Arrangement::Torn(
                [torn.grid.columns as u32, torn.grid.rows as u32],
                (0..torn.count()).map(|index| torn.home(index)).collect(),
            )),
            // Even all its faces may be those of the whole: each may be there on both sides of a cut.
            _ if *whole == (Topology { parts: whole.parts.clone(), ..topology.clone() }) => None,
            Layout::Renumbered(renumbering) => Some(Arrangement::Renumbered(
                (0..renumbering.count())
                    .filter_map(|slot| renumbering.index(slot))
                    .map(|i| i as u32)
                    .collect(),
            )),
            Layout::Linear { .. } | Layout::Grid(_) => Some(Arrangement::InOrder),
        };
        let batch = |batch: &StickBatch| {
            let listed = || batch.range().map(|i| (topology.stick(i), topology.rest_length(i))).collect();
            let sticks = match &batch.sticks {
                BatchSticks::Grid { batch, rest_length, severed, .. } => {
                    let (right, down) = batch.offset();
                    let offset = [right as i32, down as i32];
                    PlainSticks::Family(offset, batch.phase() as u8, *rest_length, severed.to_vec())
                }
                BatchSticks::Listed(batch) => PlainSticks::Listed(listed(), batch.is_independent),
                BatchSticks::Loose(_) => PlainSticks::Loose(listed()),
            };
            (batch.material, sticks)
        };
        let opened = arrangement.map(|arrangement| Opened {
            arrangement,
            rest: topology.rest.iter().map(Vec3::to_array).collect(),
            batches: topology.batches.iter().map(batch).collect(),
            faces: topology.faces.clone(),
            segments: topology.segments.clone(),
            tethers: topology.tethers(),
            longest_edge: topology.longest_edge,
            rigidity: topology.bends.rigidity,
            friction: topology.bends.friction,
        });
        Self { parts: topology.parts.iter().map(PlainPart::new).collect(), opened }
    }

    /// Builds the topology again, to the last bit. `whole` is that of the body before its first tear.
    ///
    /// # Errors
    /// [`BuildError`] if a number is out of range.
    pub fn build(&self, whole: &Topology) -> Result<Topology, BuildError> {
        let mut topology =
            self.opened.as_ref().map_or_else(|| Ok(whole.clone()), |opened| opened.build(whole))?;
        let count = topology.faces.len();
        topology.parts = self.parts.iter().map(|part| part.build(count)).collect::<Result<_, _>>()?;
        if topology.parts.is_sorted_by_key(|part| part.face) {
            Ok(topology)
        } else {
            Err(BuildError::BadTopology { reason: "parts of faces are out of order" })
        }
    }
}

impl Opened {
    fn build(&self, whole: &Topology) -> Result<Topology, BuildError> {
        let count = self.rest.len();
        self.validate()?;
        let mut topology = Topology {
            layout: self.arrangement.build(count)?,
            rest: self.rest.iter().copied().map(Vec3::from_array).collect(),
            faces: self.faces.clone(),
            segments: self.segments.clone(),
            longest_edge: self.longest_edge,
            ..Topology::default()
        };
        for (material, sticks) in &self.batches {
            add_batch(&mut topology, *material, sticks)?;
        }
        let tethers = Tethers::from_list(self.tethers.iter().copied());
        topology.tethers = TetherPlan::new(&tethers, &topology.layout);
        topology.bends = Bends::new(&topology, None, self.rigidity, self.friction);
        topology.membrane = whole.membrane.map(Membrane::torn);
        Ok(topology)
    }

    /// Checks all but arrangement and sticks.
    fn validate(&self) -> Result<(), BuildError> {
        let count = self.rest.len();
        if count == 0 {
            return Err(BuildError::BadTopology { reason: "it has no particles" });
        }
        if count as u64 > MAX_PARTICLES {
            return Err(BuildError::TooManyParticles { found: count as u64, limit: MAX_PARTICLES });
        }
        for &coordinate in self.rest.as_flattened() {
            in_range("rest position", coordinate, f32::MIN, f32::MAX)?;
        }
        known("a face", self.faces.as_flattened(), count)?;
        known("a segment", self.segments.as_flattened(), count)?;
        for &(particle, pin, length) in &self.tethers {
            known("a tether", &[particle, pin], count)?;
            in_range("length of a tether", length, 0.0, f32::MAX)?;
        }
        in_range("longest edge", self.longest_edge, 0.0, f32::MAX)?;
        self.rigidity.validate()?;
        self.friction.validate()
    }
}

/// Checks that a body of `count` particles has these.
fn known(what: &'static str, particles: &[u32], count: usize) -> Result<(), BuildError> {
    match particles.iter().find(|&&index| index as usize >= count) {
        Some(&index) => Err(BuildError::NoSuchParticle { what, index, count: count as u32 }),
        None => Ok(()),
    }
}

impl Arrangement {
    fn build(&self, count: usize) -> Result<Layout, BuildError> {
        match self {
            Self::InOrder => Ok(Layout::Linear { count }),
            Self::Renumbered(indices) => Renumbering::of_order(indices)
                .filter(|renumbering| renumbering.count() == count)
                .map(|renumbering| Layout::Renumbered(Arc::new(renumbering)))
                .ok_or(BuildError::BadTopology { reason: "its order lacks a particle" }),
            Self::Torn([columns, rows], homes) => {
                let [columns, rows] = [*columns, *rows].map(|count| count as usize);
                let is_size = (1..=MAX_PARTICLES).contains(&(columns as u64 * rows as u64));
                let grid = if is_size { Grid::new(columns, rows) } else { None };
                let grid = grid.ok_or(BuildError::BadTopology { reason: "no grid has its size" })?;
                let is_place = |&home: &u32| {
                    let [column, row] = grid.place(home as usize);
                    column < columns && row < rows && grid.slot(column, row) == home as usize
                };
                // Pieces that fill less of a grid are lists of sticks.
                let is_filled = 2 * homes.len() >= columns * rows;
                if is_filled && homes.len() == count && homes.iter().all(is_place) {
                    Ok(Layout::Torn(Arc::new(TornGrid::new(grid, homes.clone()))))
                } else {
                    Err(BuildError::BadTopology { reason: "a particle has no place in its torn grid" })
                }
            }
        }
    }
}

/// The most by which weights lie out of their range.
const ROUNDING: f32 = 1e-5;

/// Adds a batch of sticks behind the others.
fn add_batch(
    topology: &mut Topology,
    material: StickMaterial,
    sticks: &PlainSticks,
) -> Result<(), BuildError> {
    material.validate()?;
    let Topology { layout, listed, rest, .. } = &mut *topology;
    let particles = rest.len();
    let slot = |index: u32| layout.slot(index as usize) as u32;
    let (count, sticks) = match sticks {
        PlainSticks::Family(offset, phase, rest_length, severed) => {
            in_range("rest length", *rest_length, f32::MIN_POSITIVE, f32::MAX)?;
            let batch = family(layout, *offset, *phase)?;
            check_severed(layout, batch, severed)?;
            let runs = batch.without(&batch.runs(&[]), severed);
            let (rest_length, severed) = (*rest_length, severed.clone().into());
            let sticks = BatchSticks::Grid { batch, runs, rest_length, severed };
            (batch.count(), sticks)
        }
        PlainSticks::Listed(sticks, is_independent) => {
            check_sticks(sticks, particles)?;
            if *is_independent && !are_independent(sticks, particles) {
                return Err(BuildError::BadTopology { reason: "sticks of a batch share a particle" });
            }
            let mut batch = ListedBatch::new(listed.begin_batch(), *is_independent);
            sticks.iter().for_each(|&(ends, length)| listed.push(ends, length));
            batch.arrange(listed, sticks.len(), layout.cells(), slot);
            (sticks.len(), BatchSticks::Listed(batch))
        }
        PlainSticks::Loose(sticks) => {
            check_sticks(sticks, particles)?;
            let loose = |&(ends, rest_length): &PlainStick| LooseStick { slots: ends.map(slot), rest_length };
            (sticks.len(), BatchSticks::Loose(sticks.iter().map(loose).collect()))
        }
    };
    let severed = if let BatchSticks::Grid { severed, .. } = &sticks { severed.len() } else { 0 };
    let (first, count) = (topology.stick_count, count - severed);
    if count == 0 {
        return Err(BuildError::BadTopology { reason: "a batch has no sticks" });
    }
    topology.batches.push(StickBatch { material, first, count, sticks });
    topology.stick_count += count;
    Ok(())
}

/// The half of a family of a torn grid whose sticks lead so far.
fn family(layout: &Layout, [right, down]: [i32; 2], phase: u8) -> Result<GridBatch, BuildError> {
    let is_offset = match down {
        0 => (1..=2).contains(&right),
        _ => (1..=2).contains(&down) && (-1..=1).contains(&right),
    };
    let grid = layout.grid().filter(|_| is_offset);
    let halves = grid.map(|grid| GridBatch::halves(grid, right as isize, down as usize));
    let half = halves.and_then(|halves| halves.get(usize::from(phase)).copied());
    half.ok_or(BuildError::BadTopology { reason: "no grid has its sticks" })
}

/// Checks that the other sticks of the family all join particles.
fn check_severed(layout: &Layout, family: GridBatch, severed: &[u32]) -> Result<(), BuildError> {
    let is_in_family = severed.last().is_none_or(|&last| (last as usize) < family.count());
    let is_left = |stick: &usize| severed.binary_search(&(*stick as u32)).is_err();
    let joins = |stick: usize| family.slots(stick).iter().all(|&slot| layout.index(slot).is_some());
    let is_list = severed.is_sorted_by(|a, b| a < b) && is_in_family;
    if is_list && (0..family.count()).filter(is_left).all(joins) {
        Ok(())
    } else {
        Err(BuildError::BadTopology { reason: "sticks of a torn grid join no particles" })
    }
}

fn check_sticks(sticks: &[PlainStick], particles: usize) -> Result<(), BuildError> {
    for &([a, b], length) in sticks {
        known("a stick", &[a, b], particles)?;
        if a == b {
            return Err(BuildError::SameEnds { particle: a });
        }
        in_range("rest length", length, f32::MIN_POSITIVE, f32::MAX)?;
    }
    Ok(())
}

/// True if no two sticks share a particle.
fn are_independent(sticks: &[PlainStick], particles: usize) -> bool {
    let mut is_taken = vec![false; particles];
    let mut ends = sticks.iter().flat_map(|(ends, _)| ends);
    ends.all(|&end| !core::mem::replace(&mut is_taken[end as usize], true))
}

impl PlainPart {
    fn new(part: &FacePart) -> Self {
        let pair = |pair: [Vec3; 2]| pair.map(|point| point.to_array());
        Self(
            part.face,
            part.corners.iter().map(Vec3::to_array).collect(),
            part.marks.entries.iter().map(|entry| pair([entry.from, entry.tip])).collect(),
            part.marks.open.iter().copied().map(pair).collect(),
        )
    }

    /// The part of one of `count` faces.
    fn build(&self, count: usize) -> Result<FacePart, BuildError> {
        let Self(face, corners, entries, open) = self;
        let points = || corners.iter().chain(entries.as_flattened()).chain(open.as_flattened());
        for &weight in points().flatten() {
            // The end of a blade may lie beside its face by rounding.
            in_range("weight of a corner", weight, -ROUNDING, 1.0 + ROUNDING)?;
        }
        if *face as usize >= count || corners.len() < 3 {
            return Err(BuildError::BadTopology { reason: "a part belongs to no face" });
        }
        let pair = |pair: &[[f32; 3]; 2]| pair.map(Vec3::from_array);
        let entry = |ends: &[[f32; 3]; 2]| {
            let [from, tip] = pair(ends);
            Entry { from, tip }
        };
        let marks =
            Marks { entries: entries.iter().map(entry).collect(), open: open.iter().map(pair).collect() };
        Ok(FacePart { face: *face, corners: corners.iter().copied().map(Vec3::from_array).collect(), marks })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::miri::unless_miri;
    use crate::{Body, BodySettings, ClothBuilder, ClothMaterial, MembraneStiffness, MeshClothBuilder};

    /// A sheet of 1 m x 1 m in the XY plane around the origin, slit from its left side to its middle, and the topology that it had.
    fn slit(is_mesh: bool) -> (Body, Arc<Topology>) {
        let settings = BodySettings::default();
        let grid = ClothBuilder::new(1.0, 1.0, unless_miri(16, 9), 9)
            .placed(Vec3::new(-0.5, 0.5, 0.0), Vec3::X, Vec3::NEG_Y)
            .material(ClothMaterial {
                membrane_stiffness: MembraneStiffness::balanced(0.0, 20.0),
                ..ClothMaterial::default()
            })
            .pin(0)
            .build(settings);
        let mut body = grid.expect("valid");
        if is_mesh {
            let places = body.particles.positions().collect();
            let mesh = MeshClothBuilder::new(places, body.topology.faces().to_vec()).pin(0).build(settings);
            body = mesh.expect("valid");
        }
        let whole = Arc::clone(&body.topology);
        let blade = [[-0.6, 0.02, -1.0], [0.02, 0.02, -1.0], [0.02, 0.02, 9.0]].map(Vec3::from_array);
        assert!(body.cut(&[blade]).expect("can be cut").is_some());
        (body, whole)
    }

    #[test]
    fn numbers_of_no_torn_body_are_refused() {
        for is_mesh in [false, true] {
            let (body, whole) = slit(is_mesh);
            let good = TornTopology::new(&body.topology, &whole);
            assert_eq!(good.build(&whole).as_ref(), Ok(&*body.topology));
            assert_eq!(body.topology.has_membrane(), !is_mesh);
            let count = body.particles.len() as u32;
            let opened: [([&str; 2], fn(&mut Opened, u32)); 17] = [
                (["a face", "a face"], |opened, count| opened.faces[3][1] = count),
                (["a segment", "a segment"], |opened, count| opened.segments.push([0, count])),
                (["a tether", "a tether"], |opened, count| opened.tethers[0].0 = count),
                (["a tether", "a tether"], |opened, count| opened.tethers[0].1 = count),
                (["length of a tether", "length of a tether"], |opened, _| opened.tethers[0].2 = f32::NAN),
                (["rest position", "rest position"], |opened, _| opened.rest[0][2] = f32::INFINITY),
                (["no place", "its order"], |opened, _| match &mut opened.arrangement {
                    Arrangement::Torn(_, homes) => homes.truncate(homes.len() - 1),
                    other => *other = Arrangement::Renumbered(vec![0, 1, 2]),
                }),
                (["longest edge", "longest edge"], |opened, _| opened.longest_edge = -1.0),
                (["rigidity", "rigidity"], |opened, _| opened.rigidity.warp = -1.0),
                (["friction", "friction"], |opened, _| opened.friction.weft = f32::NAN),
                (["stiffness", "stiffness"], |opened, _| opened.batches[0].0.stiffness = 2.0),
                (["no grid", "its order"], |opened, _| match &mut opened.arrangement {
                    Arrangement::Torn(size, _) => *size = [0, u32::MAX],
                    other => *other = Arrangement::Renumbered(vec![0; 3]),
                }),
                (["no place", "its order"], |opened, count| match &mut opened.arrangement {
                    Arrangement::Torn(_, homes) => homes[1] = u32::MAX,
                    other => *other = Arrangement::Renumbered(vec![0; count as usize]),
                }),
                (["join no particles", "rest length"], |opened, _| match &mut opened.batches[0].1 {
                    PlainSticks::Family(.., severed) => severed.push(u32::MAX),
                    PlainSticks::Listed(sticks, _) | PlainSticks::Loose(sticks) => sticks[0].1 = 0.0,
                }),
                (["no grid", "to itself"], |opened, _| match &mut opened.batches[0].1 {
                    PlainSticks::Family(offset, ..) => *offset = [0, 0],
                    PlainSticks::Listed(sticks, _) | PlainSticks::Loose(sticks) => sticks[0].0 = [1, 1],
                }),
                (["no grid", "share a particle"], |opened, _| match &mut opened.batches[0].1 {
                    PlainSticks::Family(_, phase, ..) => *phase = 2,
                    PlainSticks::Listed(sticks, is_independent) => {
                        *is_independent = true;
                        sticks.push(sticks[0]);
                    }
                    PlainSticks::Loose(_) => unreachable!("the first batch is a family or a list"),
                }),
                (["a stick names", "a stick names"], |opened, count| {
                    match &mut opened.batches.last_mut().expect("there are several").1 {
                        PlainSticks::Family(.., length, _) => *length = 0.0,
                        PlainSticks::Listed(sticks, _) | PlainSticks::Loose(sticks) => sticks[0].0[1] = count,
                    }
                }),
            ];
            for (expected, change) in opened {
                let mut bad = good.clone();
                change(bad.opened.as_mut().expect("the slit has opened"), count);
                let error = bad.build(&whole).expect_err("was changed").to_string();
                assert!(error.contains(expected[usize::from(is_mesh)]), "{error}, expected {expected:?}");
            }
            let parts: [(&str, fn(&mut Vec<PlainPart>)); 4] = [
                ("to no face", |parts| parts[0].0 = u32::MAX),
                ("to no face", |parts| parts[0].1.truncate(2)),
                ("weight", |parts| parts[0].1[0][0] = f32::NAN),
                ("out of order", |parts| parts.reverse()),
            ];
            for (expected, change) in parts {
                let mut bad = good.clone();
                change(&mut bad.parts);
                let error = bad.build(&whole).expect_err("was changed").to_string();
                assert!(error.contains(expected), "{error}, expected {expected}");
            }
        }
    }

    /// A few bytes of a file must not ask for gigabytes.
    #[test]
    fn a_grid_without_particles_is_refused() {
        let (body, whole) = slit(false);
        let mut numbers = TornTopology::new(&body.topology, &whole);
        let opened = numbers.opened.as_mut().expect("the slit has opened");
        opened.arrangement = Arrangement::Torn([8192, 8192], (0..opened.rest.len() as u32).collect());
        let reason = "a particle has no place in its torn grid";
        assert_eq!(numbers.build(&whole), Err(BuildError::BadTopology { reason }));
    }

    #[test]
    fn sticks_to_empty_places_are_refused() {
        let (body, whole) = slit(false);
        let mut numbers = TornTopology::new(&body.topology, &whole);
        let opened = numbers.opened.as_mut().expect("the slit has opened");
        let Arrangement::Torn(_, homes) = &mut opened.arrangement else { panic!("a grid") };
        // The last particle at home moves behind the grid: its place is empty.
        let last = homes[whole.particle_count() - 1];
        homes[whole.particle_count() - 1] = homes[0];
        assert_ne!(homes[0], last);
        assert_eq!(
            numbers.build(&whole),
            Err(BuildError::BadTopology { reason: "sticks of a torn grid join no particles" }),
        );
    }
}
