//! Opens the cracks of a body and separates it into pieces, each a body of its own.
//!
//! `Split::joined` (`split.rs`) decides which sticks stay.
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::sync::Arc;

use crate::build::adjacency::Adjacency;
use crate::constraint::bending_friction;
use crate::error::BuildError;
use crate::simd::columns::LANES;
use crate::state::body::{Body, BodyContext};
use crate::state::layout::Layout;
use crate::state::particles::Particles;
use crate::state::topology::{BatchSticks, StickBatch, StickKind, Topology};
use crate::tearing::elements::Elements;
use crate::tearing::piece_topology::PieceTopology;
use crate::tearing::split::{Cracks, Split};
use crate::tearing::tear::TornStick;
use crate::tearing::tether_crossing::TetherCrossing;
use crate::union_find::Groups;

/// A piece that has separated from a body.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The piece as a body of its own, with the settings of the whole.
    pub body: Body,
    /// For each of its particles the index in the whole; for a copy, that of the particle it was split from.
    pub origins: Vec<u32>,
}

/// The remaining body's particles, the pieces, and the sticks between them.
pub(crate) struct Parted {
    /// For each particle of the body its index before; for a copy, that of the particle it was split from.
    pub origins: Vec<u32>,
    pub pieces: Vec<Piece>,
    /// The sticks that no longer join anything, in their state before.
    pub severed: Vec<TornStick>,
}

/// Opens the cracks of a body, which becomes its largest piece. Returns none if nothing changes. `adjacency` is that of its elements, if
/// it is known.
///
/// # Errors
/// [`BuildError`] if a piece cannot be built; the body is then unchanged.
pub(crate) fn part(
    body: &mut Body,
    elements: &Elements,
    cracks: &Cracks,
    adjacency: Option<Adjacency>,
) -> Result<Option<Parted>, BuildError> {
    let topology = Arc::clone(&body.topology);
    body.particles.arrange(&topology.layout);
    if cracks.is_empty() {
        return Ok(None);
    }
    let adjacency = adjacency.unwrap_or_else(|| Adjacency::of(&topology, &elements.corners));
    let Some(split) = Split::new(adjacency, elements, cracks) else {
        return Ok(None);
    };
    let mut severed = Vec::new();
    let batches: Vec<Rejoined> =
        topology.batches.iter().map(|batch| Rejoined::new(&split, cracks, batch, &mut severed)).collect();
    let severed: Vec<TornStick> = severed.into_iter().map(|i| body.torn_stick(i)).collect();
    if split.origins.len() == body.particles.len() {
        // Nothing opens yet: faces have parts and marks, and all else stays.
        let (_, parts) = split.faces_of(Some);
        if parts == body.topology.parts {
            return Ok(None);
        }
        Arc::make_mut(&mut body.topology).parts = parts;
        return Ok(Some(Parted { origins: split.origins, pieces: Vec::new(), severed }));
    }
    let members = members(&split, &batches);
    let crossing = TetherCrossing::new(&topology, cracks);
    let is_whole = members.len() == 1;
    let mut pieces = Vec::with_capacity(members.len());
    for members in members {
        let piece = PieceTopology::new(&split, &body.particles, &batches, &crossing, &members);
        let topology = if is_whole { piece.of_slit_body() } else { piece.of_part() }?;
        let mut particles = particles_of(&split, &members, &body.particles, &topology.layout);
        let origins: Vec<u32> = members.iter().map(|&member| split.origins[member as usize]).collect();
        particles.plastic.edges = bending_friction::kept_edges(body, &topology, &particles, &origins);
        let context = BodyContext::default();
        pieces.push(Piece {
            body: Body { particles, topology: Arc::new(topology), context, ..*body },
            origins,
        });
    }
    let rest = pieces.remove(0);
    *body = rest.body;
    Ok(Some(Parted { origins: rest.origins, pieces, severed }))
}

/// The sticks of a batch after the split.
pub(crate) struct Rejoined<'a> {
    pub batch: &'a StickBatch,
    topology: &'a Topology,
    /// The sticks near cracks, in order.
    pub near_cracks: Vec<usize>,
    /// The sticks that take their place: particles and rest length in metres. Many are the same as before.
    pub changed: Vec<([u32; 2], f32)>,
}

impl<'a> Rejoined<'a> {
    fn new(split: &Split<'a>, cracks: &Cracks, batch: &'a StickBatch, severed: &mut Vec<usize>) -> Self {
        let topology = split.adjacency.topology();
        let mut rejoined = Self { batch, topology, near_cracks: near(split, batch), changed: Vec::new() };
        let mut joined = Vec::new();
        for &i in &rejoined.near_cracks {
            let [a, b] = topology.stick(i);
            split.joined([a, b], &mut joined);
            rejoined.changed.extend(joined.iter().map(|&ends| (ends, topology.rest_length(i))));
            let is_cut = || cracks.crossed.contains(&[a.min(b), a.max(b)]);
            if joined.is_empty() || batch.material.kind == StickKind::Structural && is_cut() {
                severed.push(i);
            }
        }
        rejoined
    }

    /// All sticks after the split; those away from cracks come first.
    pub fn sticks(&self) -> impl Iterator<Item = ([u32; 2], f32)> + '_ {
        let mut near_cracks = self.near_cracks.iter().peekable();
        let all = self.batch.range().zip(self.topology.sticks_of(self.batch));
        let unchanged = all.filter(move |(i, _)| near_cracks.next_if_eq(&i).is_none());
        unchanged.map(|(_, stick)| stick).chain(self.changed.iter().copied())
    }
}

/// The sticks of a batch near cracks, in order.
fn near(split: &Split, batch: &StickBatch) -> Vec<usize> {
    let topology = split.adjacency.topology();
    if let BatchSticks::Grid { batch: grid, severed, .. } = &batch.sticks {
        // Searches a few slots instead of the whole grid.
        let slots = split.near().iter().map(|&particle| topology.layout.slot(particle as usize));
        let mut sticks: Vec<usize> = slots.flat_map(|slot| grid.sticks_at(slot)).collect();
        sticks.sort_unstable();
        sticks.dedup();
        sticks.into_iter().filter_map(|stick| batch.number_of(stick, severed)).collect()
    } else {
        batch.range().filter(|&i| split.may_concern(topology.stick(i))).collect()
    }
}

/// The particles of each piece, in order; the piece with the most comes first.
fn members(split: &Split, batches: &[Rejoined]) -> Vec<Vec<u32>> {
    let mut groups = Groups::new(split.origins.len());
    for &[a, b, c] in split.corners() {
        groups.join(a, b);
        groups.join(b, c);
    }
    // Faces already join all that the sticks of a grid join.
    let others = batches.iter().filter(|batch| !matches!(batch.batch.sticks, BatchSticks::Grid { .. }));
    let sticks = others.flat_map(Rejoined::sticks).map(|(ends, _)| ends);
    sticks.for_each(|[a, b]| _ = groups.join(a, b));
    let mut pieces: Vec<Vec<u32>> = Vec::new();
    let mut piece_of = vec![usize::MAX; split.origins.len()];
    for particle in 0..split.origins.len() as u32 {
        let root = groups.root(particle) as usize;
        if piece_of[root] == usize::MAX {
            piece_of[root] = pieces.len();
            pieces.push(Vec::new());
        }
        pieces[piece_of[root]].push(particle);
    }
    // The sort is stable: of equal pieces, the one with the first particle comes first.
    pieces.sort_by_key(|piece| core::cmp::Reverse(piece.len()));
    pieces
}

/// The particles of a piece, each with its share of the mass.
fn particles_of(split: &Split, members: &[u32], whole: &Particles, layout: &Layout) -> Particles {
    let cells = layout.cells();
    let mut particles = Particles {
        origin: whole.origin,
        substep: whole.substep,
        layout: layout.clone(),
        inverse_mass: vec![0.0; cells * LANES],
        disturbed: true,
        ..Particles::default()
    };
    particles.position.reset(cells);
    particles.displacement.reset(cells);
    particles.force.reset(if whole.force.is_empty() { 0 } else { cells });
    let slots_before: Vec<usize> = whole.layout.slots().collect();
    let from = |member: u32| slots_before[split.origins[member as usize] as usize];
    for (index, &member) in members.iter().enumerate() {
        let [to, from] = [layout.slot(index), from(member)];
        particles.position.set(to, whole.position.get(from));
        particles.displacement.set(to, whole.displacement.get(from));
        let share = split.shares[member as usize];
        let is_freed = whole.inverse_mass[from] == 0.0 && !split.is_real[member as usize];
        particles.inverse_mass[to] = if is_freed {
            split.inverse_mass_beside(member, |particle| whole.inverse_mass(particle as usize)) / share
        } else {
            whole.inverse_mass[from] / share
        };
        if !whole.force.is_empty() {
            particles.force.set(to, whole.force.get(from) * share);
        }
        let targets = whole.pin_targets.iter().filter(|&&(slot, _)| slot as usize == from && !is_freed);
        particles.pin_targets.extend(targets.map(|&(_, target)| (to as u32, target)));
    }
    let slots = members.iter().enumerate().map(|(index, &member)| (from(member), layout.slot(index)));
    particles.pose = whole.pose.picked(cells, slots.clone());
    if layout.is_torn() {
        particles.plastic = whole.plastic.picked(layout, slots.map(|(from, to)| [from, to]));
    }
    particles.pin_targets.sort_unstable_by_key(|&(slot, _)| slot);
    particles
}
