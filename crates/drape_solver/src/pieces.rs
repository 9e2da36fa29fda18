//! What a body becomes once its cracks are open: one piece or several, each a body of its own.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::body::{Body, BodyContext};
use crate::columns::LANES;
use crate::error::BuildError;
use crate::fabric::Fabric;
use crate::grid::{GridBatch, GridRuns};
use crate::layout::Layout;
use crate::particles::Particles;
use crate::split::{Cracks, Split};
use crate::tear::TornStick;
use crate::tether::{TetherPlan, Tethers};
use crate::topology::{BatchSticks, LooseStick, StickBatch, StickMaterial, Topology};
use crate::topology_builder::TopologyBuilder;
use crate::torn_grid::TornGrid;

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

/// A batch's sticks between split particles.
struct Joined {
    material: StickMaterial,
    sticks: Vec<([u32; 2], f32)>,
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
    let (batches, severed) = join(&split);
    let severed = severed.into_iter().map(|i| body.torn_stick(i)).collect();
    let mut members = members(&split, &batches);
    let tethers = Crossing::new(&topology, cracks);
    let mut bodies = members.iter().enumerate().map(|(place, members)| {
        let piece = PieceBuilder { split: &split, batches: &batches, members, tethers: &tethers };
        let topology = if place == 0 && topology.layout.grid().is_some() {
            piece.rest_of_grid()?
        } else {
            piece.irregular()?
        };
        let particles = piece.particles(&body.particles, &topology.layout);
        let context = BodyContext::default();
        Ok(Body { particles, topology: Arc::new(topology), context, ..body.clone() })
    });
    let bodies = bodies.by_ref().collect::<Result<Vec<Body>, BuildError>>()?;
    let origins = |members: &[u32]| members.iter().map(|&m| split.origins[m as usize]).collect::<Vec<u32>>();
    let mut pieces = bodies.into_iter().zip(members.drain(..));
    let Some((rest, kept)) = pieces.next() else {
        return Ok(None);
    };
    let origins_of_rest = origins(&kept);
    let pieces = pieces.map(|(body, members)| Piece { body, origins: origins(&members) }).collect();
    *body = rest;
    Ok(Some(Parted { origins: origins_of_rest, pieces, severed }))
}

/// The sticks of each batch as they are now, and those that are gone.
fn join(split: &Split) -> (Vec<Joined>, Vec<usize>) {
    let topology = split.fabric.topology();
    let (mut severed, mut pairs) = (Vec::new(), Vec::new());
    let batches = topology.batches.iter().map(|batch| {
        let mut sticks = Vec::with_capacity(batch.count);
        for i in batch.range() {
            let (ends, rest_length) = (topology.stick(i), topology.rest_length(i));
            if split.may_concern(ends) {
                split.joined(ends, &mut pairs);
                sticks.extend(pairs.iter().map(|&ends| (ends, rest_length)));
                if pairs.is_empty() {
                    severed.push(i);
                }
            } else {
                sticks.push((ends, rest_length));
            }
        }
        Joined { material: batch.material, sticks }
    });
    (batches.collect(), severed)
}

/// The particles of each piece, in order; the piece with the most comes first.
fn members(split: &Split, batches: &[Joined]) -> Vec<Vec<u32>> {
    let mut group: Vec<u32> = (0..split.origins.len() as u32).collect();
    let sticks = batches.iter().flat_map(|batch| &batch.sticks).map(|&(ends, _)| ends);
    let sides = split.corners().iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]);
    for [a, b] in sides.chain(sticks) {
        let (p, q) = (root(&mut group, a), root(&mut group, b));
        group[p.max(q) as usize] = p.min(q);
    }
    let mut pieces: Vec<Vec<u32>> = Vec::new();
    let mut piece_of = vec![usize::MAX; group.len()];
    for particle in 0..group.len() as u32 {
        let root = root(&mut group, particle) as usize;
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

/// The first of the group that `i` is in.
fn root(group: &mut [u32], mut i: u32) -> u32 {
    while group[i as usize] != i {
        let above = group[group[i as usize] as usize];
        group[i as usize] = above;
        i = above;
    }
    i
}

struct PieceBuilder<'a> {
    split: &'a Split<'a>,
    batches: &'a [Joined],
    members: &'a [u32],
    tethers: &'a Crossing,
}

impl PieceBuilder<'_> {
    fn old(&self) -> &Topology {
        self.split.fabric.topology()
    }

    fn origin(&self, member: u32) -> usize {
        self.split.origins[member as usize] as usize
    }

    /// The indices that split particles have in this piece; `u32::MAX` for those of others.
    fn indices(&self) -> Vec<u32> {
        let mut indices = vec![u32::MAX; self.split.origins.len()];
        for (index, &member) in self.members.iter().enumerate() {
            indices[member as usize] = index as u32;
        }
        indices
    }

    fn rest(&self) -> Vec<Vec3> {
        self.members.iter().map(|&member| self.old().rest[self.origin(member)]).collect()
    }

    /// What is left of a grid: families go on without the sticks that are severed, and what belongs to none of them is
    /// loose.
    fn rest_of_grid(&self) -> Result<Topology, BuildError> {
        let old = self.old();
        let Some(grid) = old.layout.grid() else {
            return self.irregular();
        };
        let home = |&member: &u32| match &old.layout {
            Layout::Torn(torn) => torn.home(self.origin(member)),
            layout => layout.slot(self.origin(member)) as u32,
        };
        let torn = TornGrid::new(grid, self.members.iter().map(home).collect());
        let indices = self.indices();
        let families: Vec<_> = old.batches.iter().filter_map(Family::of).collect();
        let mut present: Vec<Vec<bool>> =
            families.iter().map(|family| vec![false; family.batch.count()]).collect();
        let mut loose: Vec<(StickMaterial, Vec<LooseStick>)> = Vec::new();
        for (batch, joined) in old.batches.iter().zip(self.batches) {
            for &(ends, rest_length) in &joined.sticks {
                let ends = ends.map(|end| indices[end as usize]);
                if ends.contains(&u32::MAX) {
                    continue;
                }
                let slots = ends.map(|end| torn.slot(end as usize));
                let is_home = |i: usize| torn.home(ends[i] as usize) as usize == slots[i];
                let place = if is_home(0) && is_home(1) {
                    families.iter().position(|family| family.may_have(batch, rest_length, slots))
                } else {
                    None
                };
                let stick =
                    place.and_then(|place| Some((place, families[place].batch.stick_between(slots)?)));
                if let Some((place, stick)) = stick.filter(|&(place, stick)| !present[place][stick]) {
                    present[place][stick] = true;
                    continue;
                }
                let slots = slots.map(|slot| slot as u32);
                let stick = LooseStick { slots, rest_length };
                match loose.iter_mut().find(|(material, _)| *material == batch.material) {
                    Some((_, sticks)) => sticks.push(stick),
                    None => loose.push((batch.material, vec![stick])),
                }
            }
        }
        let mut topology = Topology { layout: Layout::Torn(Arc::new(torn)), ..Topology::default() };
        let mut push = |material, count, sticks| {
            let first = topology.stick_count;
            if count > 0 {
                topology.batches.push(StickBatch { material, first, count, sticks });
                topology.stick_count += count;
            }
        };
        for (family, present) in families.iter().zip(present) {
            let severed: Vec<u32> = (0..present.len()).filter(|&k| !present[k]).map(|k| k as u32).collect();
            let count = present.len() - severed.len();
            push(family.material, count, family.without(severed.into()));
        }
        for (material, sticks) in loose {
            push(material, sticks.len(), BatchSticks::Loose(sticks.into()));
        }
        let faces = self.split.faces().iter().map(|face| face.map(|corner| indices[corner as usize]));
        topology.faces = faces.filter(|face| !face.contains(&u32::MAX)).collect();
        let segments = self.split.segments().map(|ends| ends.map(|end| indices[end as usize]));
        topology.segments = segments.filter(|ends| !ends.contains(&u32::MAX)).collect();
        topology.longest_edge = old.longest_edge;
        topology.rest = self.rest();
        topology.tethers = TetherPlan::new(&self.uncrossed(&indices), &topology.layout);
        Ok(topology)
    }

    /// The tethers of a flat body that no crack has crossed.
    fn uncrossed(&self, indices: &[u32]) -> Tethers {
        let old = self.old();
        let tethers = old.tethers.list(&old.layout);
        let mut copies: Vec<Vec<u32>> = vec![Vec::new(); old.particle_count()];
        for &member in self.members {
            copies[self.origin(member)].push(member);
        }
        let mut inside = vec![None; self.split.origins.len()];
        let mut place = |member: u32| *inside[member as usize].get_or_insert_with(|| self.inside(member));
        let mut kept = Vec::new();
        for (particle, pin, length) in tethers {
            for &member in &copies[particle as usize] {
                let is_free = |pin: &&u32| !self.tethers.is_crossed(place(member), place(**pin));
                if let Some(&pin) = copies[pin as usize].iter().find(is_free) {
                    kept.push((indices[member as usize], indices[pin as usize], length));
                }
            }
        }
        kept.sort_by_key(|&(particle, ..)| particle);
        Tethers::from_list(kept)
    }

    /// A point just inside the faces around a particle at rest: on its own side of a crack.
    fn inside(&self, member: u32) -> Vec3 {
        let rest = &self.old().rest;
        let place = rest[self.origin(member)];
        let own = self.split.fabric.around(self.split.origins[member as usize]);
        let own = own.filter(|&element| self.split.corners()[element].contains(&member));
        let (sum, count) = own
            .flat_map(|element| self.split.fabric.corners(element))
            .fold((Vec3::ZERO, 0.0), |(sum, count), &corner| (sum + rest[corner as usize], count + 1.0));
        if count > 0.0 { place + (sum / count - place) * INWARDS } else { place }
    }

    /// A body of listed sticks.
    fn irregular(&self) -> Result<Topology, BuildError> {
        let indices = self.indices();
        let new = |ends: [u32; 2]| ends.map(|end| indices[end as usize]);
        let mut builder = TopologyBuilder::new(&self.rest());
        for same in self.batches.chunk_by(|p, q| p.material == q.material) {
            let sticks =
                same.iter().flat_map(|batch| &batch.sticks).map(|&(ends, length)| (new(ends), length));
            let sticks = sticks.filter(|(ends, _)| !ends.contains(&u32::MAX));
            builder.family_with_lengths(same[0].material, sticks)?;
        }
        let faces = self.split.faces().iter().map(|face| face.map(|corner| indices[corner as usize]));
        builder.faces(faces.filter(|face| !face.contains(&u32::MAX)))?;
        builder.segments(self.split.segments().map(new).filter(|ends| !ends.contains(&u32::MAX)))?;
        let old = self.old();
        let mut is_pin = vec![false; old.particle_count()];
        old.tethers.list(&old.layout).iter().for_each(|&(_, pin, _)| is_pin[pin as usize] = true);
        let members = 0..self.members.len() as u32;
        let pins: Vec<u32> =
            members.filter(|&index| is_pin[self.origin(self.members[index as usize])]).collect();
        if !pins.is_empty() {
            let tethers = Tethers::geodesic(self.members.len(), builder.edges(), &pins);
            builder.tethers(tethers)?;
        }
        builder.build()
    }

    /// The particles of the piece, each with its part of the mass.
    fn particles(&self, whole: &Particles, layout: &Layout) -> Particles {
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
        for (index, &member) in self.members.iter().enumerate() {
            let [to, from] = [layout.slot(index), whole.layout.slot(self.origin(member))];
            particles.position.set(to, whole.position.get(from));
            particles.displacement.set(to, whole.displacement.get(from));
            let share = self.split.shares[member as usize];
            particles.inverse_mass[to] = whole.inverse_mass[from] / share.max(LEAST_SHARE);
            if !whole.force.is_empty() {
                particles.force.set(to, whole.force.get(from) * share);
            }
            let targets = whole.pin_targets.iter().filter(|&&(slot, _)| slot as usize == from);
            particles.pin_targets.extend(targets.map(|&(_, target)| (to as u32, target)));
        }
        particles.pin_targets.sort_unstable_by_key(|&(slot, _)| slot);
        particles
    }
}

/// How far towards the middle of its faces a particle counts as lying where it is asked on which side of a crack.
const INWARDS: f32 = 1e-2;

/// No copy is lighter than this part of what it was split from: faces without area weigh nothing.
const LEAST_SHARE: f32 = 1e-3;

/// A batch of a grid's sticks.
struct Family<'a> {
    material: StickMaterial,
    batch: GridBatch,
    runs: &'a GridRuns,
    rest_length: f32,
    severed: &'a [u32],
}

impl<'a> Family<'a> {
    fn of(batch: &'a StickBatch) -> Option<Self> {
        match &batch.sticks {
            BatchSticks::Grid { batch: own, runs, rest_length, severed } => {
                Some(Self { material: batch.material, batch: *own, runs, rest_length: *rest_length, severed })
            }
            _ => None,
        }
    }

    /// Whether a stick of `batch` between two places of the grid may be one of this family.
    fn may_have(&self, batch: &StickBatch, rest_length: f32, slots: [usize; 2]) -> bool {
        (self.material, self.rest_length) == (batch.material, rest_length)
            && self.batch.stick_between(slots).is_some()
    }

    /// The family without some of its sticks.
    fn without(&self, severed: Box<[u32]>) -> BatchSticks {
        let runs = if *severed == *self.severed { self.runs.clone() } else { self.batch.runs(&severed) };
        BatchSticks::Grid { batch: self.batch, runs, rest_length: self.rest_length, severed }
    }
}

/// The cracks of a flat body at rest, as lines that no tether may cross.
struct Crossing {
    /// Unit vectors in the plane.
    axes: [Vec3; 2],
    lines: Vec<[Vec2; 2]>,
}

impl Crossing {
    fn new(topology: &Topology, cracks: &Cracks) -> Self {
        let rest = &topology.rest;
        let mut axes = [Vec3::X, Vec3::Y];
        if let Some(face) = topology.faces.first() {
            let [p, q, r] = face.map(|corner| rest[corner as usize]);
            let along = (q - p).normalize_or(Vec3::X);
            axes = [along, (r - p).reject_from_normalized(along).normalize_or(Vec3::Y)];
        }
        let mut crossing = Self { axes, lines: Vec::new() };
        let line = |edge: &[u32; 2]| edge.map(|end| crossing.flat(rest[end as usize]));
        let lines = cracks.edges.iter().map(line).collect();
        crossing.lines = lines;
        crossing
    }

    fn flat(&self, place: Vec3) -> Vec2 {
        Vec2::from(self.axes.map(|axis| axis.dot(place)))
    }

    fn is_crossed(&self, from: Vec3, to: Vec3) -> bool {
        let [p, q] = [from, to].map(|place| self.flat(place));
        self.lines.iter().any(|&[a, b]| {
            let side = |origin: Vec2, end: Vec2, point: Vec2| (end - origin).perp_dot(point - origin);
            side(p, q, a) * side(p, q, b) <= 0.0 && side(a, b, p) * side(a, b, q) <= 0.0
        })
    }
}
