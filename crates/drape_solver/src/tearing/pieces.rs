//! What a body becomes once its cracks are open: one piece or several, each a body of its own.

use std::sync::Arc;

use crate::build::adjacency::Fabric;
use crate::error::BuildError;
use crate::simd::columns::LANES;
use crate::state::body::{Body, BodyContext};
use crate::state::layout::Layout;
use crate::state::particles::Particles;
use crate::state::topology::{BatchSticks, StickBatch, Topology};
use crate::tearing::piece_topology::PieceTopology;
use crate::tearing::split::{Cracks, Split};
use crate::tearing::tear::TornStick;
use crate::tearing::tether_crossing::TetherCrossing;
use crate::union_find::Groups;

/// A piece that has come off a body.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The piece as a body of its own, with the settings of the one that it has come off.
    pub body: Body,
    /// For each of its particles the index that it had before, or that of the particle that it is a copy of.
    pub origins: Vec<u32>,
}

/// What remains, and what has come off.
pub(crate) struct Parted {
    /// For each particle of the body its index before, or that of the particle that it is a copy of.
    pub origins: Vec<u32>,
    pub pieces: Vec<Piece>,
    /// The sticks that no longer join anything, as they were before.
    pub severed: Vec<TornStick>,
}

/// Opens the cracks of a body. The largest piece stays what the body was; none if nothing parts.
///
/// # Errors
/// [`BuildError`] if a piece cannot be built; the body is as it was then.
pub(crate) fn part(body: &mut Body, cracks: &Cracks) -> Result<Option<Parted>, BuildError> {
    let topology = Arc::clone(&body.topology);
    body.particles.arrange(&topology.layout);
    let Some(split) = Split::new(Fabric::new(&topology), cracks) else {
        return Ok(None);
    };
    let mut severed = Vec::new();
    let batches: Vec<Rejoined> =
        topology.batches.iter().map(|batch| Rejoined::new(&split, batch, &mut severed)).collect();
    let severed = severed.into_iter().map(|i| body.torn_stick(i)).collect();
    let members = members(&split, &batches);
    let crossing = TetherCrossing::new(&topology, cracks);
    let is_whole = members.len() == 1;
    let mut pieces = Vec::with_capacity(members.len());
    for members in members {
        let piece = PieceTopology::new(&split, &batches, &crossing, &members);
        let topology = if is_whole { piece.of_slit_body() } else { piece.of_part() }?;
        let particles = particles_of(&split, &members, &body.particles, &topology.layout);
        let origins = members.iter().map(|&member| split.origins[member as usize]).collect();
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

/// What has become of a batch's sticks.
pub(crate) struct Rejoined<'a> {
    pub batch: &'a StickBatch,
    topology: &'a Topology,
    /// The sticks near cracks, in order: no longer there as they were.
    pub gone: Vec<usize>,
    /// What has come in their place: the particles that each joins, and its rest length in metres.
    pub changed: Vec<([u32; 2], f32)>,
}

impl<'a> Rejoined<'a> {
    fn new(split: &Split<'a>, batch: &'a StickBatch, severed: &mut Vec<usize>) -> Self {
        let topology = split.fabric.topology();
        let mut rejoined = Self { batch, topology, gone: near(split, batch), changed: Vec::new() };
        let mut joined = Vec::new();
        for &i in &rejoined.gone {
            split.joined(topology.stick(i), &mut joined);
            rejoined.changed.extend(joined.iter().map(|&ends| (ends, topology.rest_length(i))));
            if joined.is_empty() {
                severed.push(i);
            }
        }
        rejoined
    }

    /// All sticks, those that have not changed first.
    pub fn sticks(&self) -> impl Iterator<Item = ([u32; 2], f32)> + '_ {
        let mut gone = self.gone.iter().peekable();
        let kept = self.batch.range().filter(move |i| gone.next_if_eq(&i).is_none());
        let kept = kept.map(|i| (self.topology.stick(i), self.topology.rest_length(i)));
        kept.chain(self.changed.iter().copied())
    }
}

/// The sticks of a batch that may have been severed, in order.
fn near(split: &Split, batch: &StickBatch) -> Vec<usize> {
    let topology = split.fabric.topology();
    if let BatchSticks::Grid { batch: grid, severed, .. } = &batch.sticks {
        // Those at a few places, instead of a look at all.
        let slots = split.near().map(|particle| topology.layout.slot(particle as usize));
        let mut sticks: Vec<usize> = slots.flat_map(|slot| grid.sticks_at(slot)).collect();
        sticks.sort_unstable();
        sticks.dedup();
        let number = |stick: usize| {
            let place = severed.binary_search(&(stick as u32)).err()?;
            Some(batch.first + stick - place)
        };
        sticks.into_iter().filter_map(number).collect()
    } else {
        batch.range().filter(|&i| split.may_concern(topology.stick(i))).collect()
    }
}

/// The particles of each piece, in order; the piece with the most comes first.
fn members(split: &Split, batches: &[Rejoined]) -> Vec<Vec<u32>> {
    let mut groups = Groups::new(split.origins.len());
    let sides = split.corners().iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]);
    // The sticks of a grid join nothing that its faces do not.
    let others = batches.iter().filter(|batch| !matches!(batch.batch.sticks, BatchSticks::Grid { .. }));
    let sticks = others.flat_map(Rejoined::sticks).map(|(ends, _)| ends);
    for [a, b] in sides.chain(sticks) {
        groups.join(a, b);
    }
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
    // Stable: of equal ones, the piece with the first particle comes first.
    pieces.sort_by_key(|piece| core::cmp::Reverse(piece.len()));
    pieces
}

/// The particles of a piece, each with its part of the mass.
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
    for (index, &member) in members.iter().enumerate() {
        let origin = split.origins[member as usize] as usize;
        let [to, from] = [layout.slot(index), whole.layout.slot(origin)];
        particles.position.set(to, whole.position.get(from));
        particles.displacement.set(to, whole.displacement.get(from));
        let share = split.shares[member as usize];
        particles.inverse_mass[to] = whole.inverse_mass[from] / share.max(LEAST_SHARE);
        if !whole.force.is_empty() {
            particles.force.set(to, whole.force.get(from) * share);
        }
        let targets = whole.pin_targets.iter().filter(|&&(slot, _)| slot as usize == from);
        particles.pin_targets.extend(targets.map(|&(_, target)| (to as u32, target)));
    }
    if !whole.limits.is_empty() {
        particles.limits.reset(cells);
        for (index, &member) in members.iter().enumerate() {
            let origin = split.origins[member as usize] as usize;
            if let Some((centre, target, reach)) = whole.limits.get(whole.layout.slot(origin)) {
                particles.limits.set(layout.slot(index), centre, target, reach);
            }
        }
    }
    particles.pin_targets.sort_unstable_by_key(|&(slot, _)| slot);
    particles
}

/// No copy is lighter than this part of what it was split from: faces without area weigh nothing.
const LEAST_SHARE: f32 = 1e-3;
