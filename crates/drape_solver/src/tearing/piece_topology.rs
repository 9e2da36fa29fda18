//! Builds the topology of a piece, from the sticks that `Split::joined` (`split.rs`) keeps.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::build::topology_builder::TopologyBuilder;
use crate::constraint::direct::grid_lines::Lines;
use crate::error::BuildError;
use crate::state::bends::Bends;
use crate::state::grid::GridBatch;
use crate::state::layout::{Grid, Layout};
use crate::state::membrane::Membrane;
use crate::state::particles::Particles;
use crate::state::topology::{BatchSticks, LooseStick, StickBatch, StickMaterial, Topology};
use crate::state::torn_grid::TornGrid;
use crate::tearing::pieces::Rejoined;
use crate::tearing::split::Split;
use crate::tearing::tether_crossing::TetherCrossing;

/// The data from which the topology of one piece is built.
pub(crate) struct PieceTopology<'a> {
    split: &'a Split<'a>,
    /// Those of the body before.
    particles: &'a Particles,
    batches: &'a [Rejoined<'a>],
    crossing: &'a TetherCrossing,
    members: &'a [u32],
    /// The index in the piece of each particle of the split body; [`ELSEWHERE`] for particles of other pieces.
    indices: Vec<u32>,
    /// For each particle of the body before, the slot of the grid that it had when the body was built.
    homes: Vec<u32>,
}

/// Marks particles of other pieces.
pub(crate) const ELSEWHERE: u32 = u32::MAX;

impl<'a> PieceTopology<'a> {
    pub fn new(
        split: &'a Split<'a>,
        particles: &'a Particles,
        batches: &'a [Rejoined<'a>],
        crossing: &'a TetherCrossing,
        members: &'a [u32],
    ) -> Self {
        let mut indices = vec![ELSEWHERE; split.origins.len()];
        for (index, &member) in members.iter().enumerate() {
            indices[member as usize] = index as u32;
        }
        let homes = match &split.adjacency.topology().layout {
            Layout::Torn(torn) => (0..torn.count()).map(|index| torn.home(index)).collect(),
            layout => layout.slots().map(|slot| slot as u32).collect(),
        };
        Self { split, particles, batches, crossing, members, indices, homes }
    }

    fn old(&self) -> &'a Topology {
        self.split.adjacency.topology()
    }

    /// The kind of a batch. Springs are solved along their lines, so each direction has batches of its own.
    fn kind(&self, batch: &StickBatch) -> Kind {
        let lines = self.old().membrane.and_then(|_| Lines::along(batch, self.old()));
        (batch.material, lines)
    }

    fn origin(&self, member: u32) -> usize {
        self.split.origins[member as usize] as usize
    }

    /// Indices in the piece of `particles`; none unless all belong to the piece.
    fn own<const N: usize>(&self, particles: [u32; N]) -> Option<[u32; N]> {
        let own = particles.map(|particle| self.indices[particle as usize]);
        (!own.contains(&ELSEWHERE)).then_some(own)
    }

    /// True if a particle has the place of a pin.
    fn is_held(&self, member: u32) -> bool {
        self.particles.is_pinned(self.origin(member)) && self.split.is_real[member as usize]
    }

    fn rest(&self) -> Vec<Vec3> {
        self.members.iter().map(|&member| self.old().rest[self.origin(member)]).collect()
    }

    /// The slot that a particle had in the old grid when the body was built.
    fn home(&self, member: u32) -> u32 {
        self.homes[self.origin(member)]
    }

    /// The topology of a body with cracks that is still one piece. A grid keeps its slots, and only sticks near the cracks
    /// change.
    pub fn of_slit_body(&self) -> Result<Topology, BuildError> {
        let Some(grid) = self.old().layout.grid() else {
            return self.irregular();
        };
        let torn = TornGrid::new(grid, self.members.iter().map(|&member| self.home(member)).collect());
        let (mut batches, mut loose) = (Batches::default(), LooseSticks::default());
        for rejoined in self.batches {
            let kind @ (material, _) = self.kind(rejoined.batch);
            let BatchSticks::Grid { batch, runs, rest_length, severed } = &rejoined.batch.sticks else {
                for (ends, rest_length) in rejoined.sticks() {
                    loose.push(kind, ends.map(|end| torn.slot(end as usize)), rest_length);
                }
                continue;
            };
            let stick = |&i: &usize| rejoined.batch.place_in_family(i, severed) as u32;
            let mut gone: Vec<u32> = rejoined.near_cracks.iter().map(stick).collect();
            for &(ends, rest_length) in &rejoined.changed {
                let slots = ends.map(|end| torn.slot(end as usize));
                let stick = batch.stick_between(slots).filter(|_| torn.are_home(ends));
                match stick.and_then(|stick| gone.binary_search(&(stick as u32)).ok()) {
                    Some(place) => drop(gone.remove(place)),
                    None => loose.push(kind, slots, rest_length),
                }
            }
            let runs = if gone.is_empty() { runs.clone() } else { batch.without(runs, &gone) };
            gone.extend(severed);
            gone.sort_unstable();
            let (batch, rest_length, severed) = (*batch, *rest_length, gone.into());
            batches.push_family(material, BatchSticks::Grid { batch, runs, rest_length, severed });
        }
        Ok(self.finish(torn, batches, loose))
    }

    /// The topology of one of several pieces: a grid if the piece fills at least half of the grid around it, else a list of
    /// sticks.
    pub fn of_part(&self) -> Result<Topology, BuildError> {
        let frame = self.old().layout.grid().and_then(|grid| Frame::new(grid, || self.homes()));
        match frame {
            Some(frame) if 2 * self.members.len() >= frame.grid.columns * frame.grid.rows => {
                Ok(self.of_grid(frame))
            }
            _ => self.irregular(),
        }
    }

    fn homes(&self) -> impl Iterator<Item = usize> + '_ {
        self.members.iter().map(|&member| self.home(member) as usize)
    }

    fn of_grid(&self, frame: Frame) -> Topology {
        let homes = self.homes().map(|home| frame.slot(home) as u32).collect();
        let torn = TornGrid::new(frame.grid, homes);
        let mut families: Vec<Family> = Vec::new();
        for rejoined in self.batches {
            if let BatchSticks::Grid { batch, rest_length, .. } = &rejoined.batch.sticks {
                let (right, down) = batch.offset();
                let material = rejoined.batch.material;
                // Both halves of a family have the same offset, so one entry is enough.
                if !families.iter().any(|family| family.batch.offset() == (right, down)) {
                    families.extend(
                        GridBatch::halves(frame.grid, right, down)
                            .map(|batch| Family::new(material, batch, *rest_length)),
                    );
                }
            }
        }
        let mut loose = LooseSticks::default();
        for rejoined in self.batches {
            let kind @ (material, _) = self.kind(rejoined.batch);
            for (ends, rest_length) in rejoined.sticks() {
                let Some(ends) = self.own(ends) else { continue };
                let slots = ends.map(|end| torn.slot(end as usize));
                let is_taken = torn.are_home(ends)
                    && families.iter_mut().any(|family| family.take(material, rest_length, slots));
                if !is_taken {
                    loose.push(kind, slots, rest_length);
                }
            }
        }
        let mut batches = Batches::default();
        for family in families {
            let severed: Box<[u32]> =
                (0..family.has.len()).filter(|&k| !family.has[k]).map(|k| k as u32).collect();
            let (batch, rest_length) = (family.batch, family.rest_length);
            let runs = batch.without(&batch.runs(&[]), &severed);
            batches.push_family(family.material, BatchSticks::Grid { batch, runs, rest_length, severed });
        }
        self.finish(torn, batches, loose)
    }

    /// Builds the topology of a torn grid.
    fn finish(&self, torn: TornGrid, mut batches: Batches, loose: LooseSticks) -> Topology {
        for ((material, _), sticks) in loose.0 {
            batches.push(material, sticks.len(), BatchSticks::Loose(sticks.into()));
        }
        let (faces, parts) = self.split.faces_of(|corners| self.own(corners));
        let segments = self.split.segments().filter_map(|ends| self.own(ends));
        let mut topology = Topology {
            layout: Layout::Torn(Arc::new(torn)),
            batches: batches.list,
            stick_count: batches.count,
            faces,
            parts,
            segments: segments.collect(),
            longest_edge: self.old().longest_edge,
            rest: self.rest(),
            ..Topology::default()
        };
        topology.tethers = self.crossing.uncrossed(self.split, self.members, &self.indices, &topology.layout);
        let Bends { rigidity, friction, .. } = self.old().bends;
        topology.bends = Bends::new(&topology, None, rigidity, friction);
        topology.membrane = self.old().membrane.map(Membrane::torn);
        topology
    }

    /// Builds a topology of listed sticks.
    fn irregular(&self) -> Result<Topology, BuildError> {
        let mut builder = TopologyBuilder::new(&self.rest());
        for same in self.batches.chunk_by(|p, q| self.kind(p.batch) == self.kind(q.batch)) {
            let sticks = same.iter().flat_map(Rejoined::sticks);
            let sticks = sticks.filter_map(|(ends, length)| Some((self.own(ends)?, length)));
            builder.family_with_lengths(same[0].batch.material, sticks)?;
        }
        let (faces, parts) = self.split.faces_of(|corners| self.own(corners));
        builder.faces(faces)?;
        builder.segments(self.split.segments().filter_map(|ends| self.own(ends)))?;
        let Bends { rigidity, friction, .. } = self.old().bends;
        builder.bending(rigidity)?.bending_friction(friction)?;
        let old = self.old();
        if !old.tethers.is_empty() {
            let members = 0..self.members.len() as u32;
            let pins: Vec<u32> =
                members.filter(|&index| self.is_held(self.members[index as usize])).collect();
            builder.geodesic_tethers(&pins)?;
        }
        Ok(Topology { parts, membrane: old.membrane.map(Membrane::torn), ..builder.build()? })
    }
}

/// The part of the old grid around a piece, as a grid of its own.
struct Frame {
    old: Grid,
    grid: Grid,
    /// Its first column and row in the old grid.
    first: [usize; 2],
}

impl Frame {
    /// The frame around these slots of the old grid; none if it is too small for a grid.
    fn new<I: Iterator<Item = usize>>(old: Grid, slots: impl Fn() -> I) -> Option<Self> {
        let places = || slots().map(|slot| old.place(slot));
        let range = |axis: usize| {
            let along = || places().map(move |place| place[axis]);
            Some((along().min()?, along().max()?))
        };
        let [(left, right), (top, bottom)] = [range(0)?, range(1)?];
        let grid = Grid::new(right - left + 1, bottom - top + 1)?;
        Some(Self { old, grid, first: [left, top] })
    }

    /// The slot in the new grid of a slot in the old grid.
    fn slot(&self, old: usize) -> usize {
        let [column, row] = self.old.place(old);
        self.grid.slot(column - self.first[0], row - self.first[1])
    }
}

/// Half a family of a grid's sticks, with a flag for each stick that the piece has.
struct Family {
    material: StickMaterial,
    batch: GridBatch,
    rest_length: f32,
    has: Vec<bool>,
}

impl Family {
    fn new(material: StickMaterial, batch: GridBatch, rest_length: f32) -> Self {
        Self { material, batch, rest_length, has: vec![false; batch.count()] }
    }

    /// Marks a stick if it belongs to the family. Returns true if it was marked for the first time.
    fn take(&mut self, material: StickMaterial, rest_length: f32, slots: [usize; 2]) -> bool {
        let is_alike = (material, rest_length) == (self.material, self.rest_length);
        let stick = if is_alike { self.batch.stick_between(slots) } else { None };
        stick.is_some_and(|stick| !core::mem::replace(&mut self.has[stick], true))
    }
}

/// A list of batches whose sticks are numbered in order.
#[derive(Default)]
struct Batches {
    list: Vec<StickBatch>,
    count: usize,
}

impl Batches {
    fn push(&mut self, material: StickMaterial, count: usize, sticks: BatchSticks) {
        if count > 0 {
            self.list.push(StickBatch { material, first: self.count, count, sticks });
            self.count += count;
        }
    }

    fn push_family(&mut self, material: StickMaterial, sticks: BatchSticks) {
        if let BatchSticks::Grid { batch, severed, .. } = &sticks {
            self.push(material, batch.count() - severed.len(), sticks);
        }
    }
}

/// Sticks outside the families of a grid, by kind.
#[derive(Default)]
struct LooseSticks(Vec<(Kind, Vec<LooseStick>)>);

/// Material of the sticks of a batch, and their direction in a cloth with springs.
type Kind = (StickMaterial, Option<Lines>);

impl LooseSticks {
    fn push(&mut self, kind: Kind, slots: [usize; 2], rest_length: f32) {
        let stick = LooseStick { slots: slots.map(|slot| slot as u32), rest_length };
        match self.0.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, sticks)) => sticks.push(stick),
            None => self.0.push((kind, vec![stick])),
        }
    }
}
