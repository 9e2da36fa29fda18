//! Tethers as data: pairs of a particle and a pin, with their length.
//!
//! The length is the geodesic distance in the rest pose (Kim, Chentanez and Müller-Fischer 2012, "Long Range
//! Attachments"); `constraint/tether.rs` projects them.
//!
//! Design: `docs/design/tethers.md`.

use std::collections::BinaryHeap;

use core::cmp::{Ordering, Reverse};

use glam::Vec3;

use crate::constants::MAX_TETHERS;
use crate::simd::columns::LANES;
use crate::state::layout::Layout;
use crate::state::particles::Particles;

/// The tethers of a body: up to [`MAX_TETHERS`] for each particle, in the order of their projection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tethers {
    /// Particle that each tether holds.
    particle: Vec<u32>,
    pin: Vec<u32>,
    length: Vec<f32>,
}

impl Tethers {
    /// No tethers.
    pub fn none() -> Self {
        Self::default()
    }

    /// Tethers for a body that is flat and convex at rest, where the geodesic is the straight line.
    pub fn straight(rest: &[Vec3], pins: &[u32]) -> Self {
        Self::straight_by_groups(rest, &pins.iter().map(|&pin| (pin, pin)).collect::<Vec<_>>())
    }

    /// The same for pins in groups, as (pin, group) in order of the pins: a particle is tethered to the nearest pin of
    /// each group. The pins of an edge together hold a particle no better than the nearest of them.
    pub fn straight_by_groups(rest: &[Vec3], pins: &[(u32, u32)]) -> Self {
        let mut tethers = Self::default();
        if pins.is_empty() {
            return tethers;
        }
        let mut nearest: Vec<(f32, u32, u32)> = Vec::with_capacity(pins.len());
        let mut is_pin = vec![false; rest.len()];
        pins.iter().for_each(|&(pin, _)| is_pin[pin as usize] = true);
        for (i, &position) in rest.iter().enumerate().filter(|&(i, _)| !is_pin[i]) {
            nearest.clear();
            for &(pin, group) in pins {
                let distance = position.distance(rest[pin as usize]);
                match nearest.iter_mut().find(|known| known.2 == group) {
                    Some(known) if distance < known.0 => *known = (distance, pin, group),
                    Some(_) => {}
                    None => nearest.push((distance, pin, group)),
                }
            }
            if nearest.len() > MAX_TETHERS {
                nearest.select_nth_unstable_by(MAX_TETHERS - 1, by_distance);
                nearest.truncate(MAX_TETHERS);
            }
            nearest.sort_unstable_by(by_distance);
            for &(length, pin, _) in &nearest {
                tethers.push(i as u32, pin, length);
            }
        }
        tethers
    }

    /// Tethers along the sticks of a body of any form: `edges` are (end, end, rest length in metres). Runs
    /// Dijkstra's algorithm from all pins at once; each particle keeps the first pins that reach it.
    pub fn geodesic(
        particle_count: usize,
        edges: impl IntoIterator<Item = (u32, u32, f32)>,
        pins: &[u32],
    ) -> Self {
        let pins: Vec<_> = pins.iter().map(|&pin| (pin, pin)).collect();
        Self::geodesic_by_groups(particle_count, edges, &pins)
    }

    /// The same for pins in groups, as (pin, group): a particle is tethered to the pin of each group that reaches it first.
    pub fn geodesic_by_groups(
        particle_count: usize,
        edges: impl IntoIterator<Item = (u32, u32, f32)>,
        pins: &[(u32, u32)],
    ) -> Self {
        let mut group_of = vec![None; particle_count];
        pins.iter().for_each(|&(pin, group)| group_of[pin as usize] = Some(group));
        let mut neighbours: Vec<Vec<(u32, f32)>> = vec![Vec::new(); particle_count];
        for (a, b, length) in edges {
            neighbours[a as usize].push((b, length));
            neighbours[b as usize].push((a, length));
        }
        let mut reached: Vec<Vec<(f32, u32)>> = vec![Vec::new(); particle_count];
        let mut queue: BinaryHeap<Reverse<Visit>> = BinaryHeap::new();
        for &(pin, _) in pins {
            queue.push(Reverse(Visit { distance: 0.0, particle: pin, pin }));
        }
        while let Some(Reverse(visit)) = queue.pop() {
            let known = &mut reached[visit.particle as usize];
            let group = |pin: u32| group_of[pin as usize];
            if known.len() == MAX_TETHERS || known.iter().any(|&(_, pin)| group(pin) == group(visit.pin)) {
                continue;
            }
            known.push((visit.distance, visit.pin));
            for &(particle, length) in &neighbours[visit.particle as usize] {
                let distance = visit.distance + length;
                queue.push(Reverse(Visit { distance, particle, ..visit }));
            }
        }
        let mut tethers = Self::default();
        for (i, known) in reached.iter().enumerate() {
            if group_of[i].is_none() {
                for &(length, pin) in known {
                    tethers.push(i as u32, pin, length);
                }
            }
        }
        tethers
    }

    /// The number of tethers.
    pub fn len(&self) -> usize {
        self.length.len()
    }

    /// True if there are no tethers.
    pub fn is_empty(&self) -> bool {
        self.length.is_empty()
    }

    /// Each tether as (particle, pin, length in metres).
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (u32, u32, f32)> + '_ {
        (0..self.len()).map(|i| (self.particle[i], self.pin[i], self.length[i]))
    }

    /// The greatest index of a particle or pin.
    pub(crate) fn highest_index(&self) -> Option<u32> {
        self.particle.iter().chain(&self.pin).copied().max()
    }

    /// Tethers from (particle, pin, length in metres), those of each particle in the order of their projection.
    pub(crate) fn from_list(list: impl IntoIterator<Item = (u32, u32, f32)>) -> Self {
        let mut tethers = Self::default();
        list.into_iter().for_each(|(particle, pin, length)| tethers.push(particle, pin, length));
        tethers
    }

    fn push(&mut self, particle: u32, pin: u32, length: f32) {
        self.particle.push(particle);
        self.pin.push(pin);
        self.length.push(length);
    }
}

/// Tethers in the order of their projection, cell by cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TetherPlan {
    /// Index of each cell's first tethers in `ties`; one more at the end.
    pub first: Vec<u32>,
    pub ties: Vec<Tie>,
    pub anchors: Vec<Anchor>,
}

/// One tether for each lane of a cell, or for some of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tie {
    /// Metres; infinite where a lane has none.
    pub length: [f32; LANES],
    /// Index in the list of anchors.
    pub anchor: u32,
}

/// The pins of a tie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Anchor {
    /// In one slot, for all lanes: a curtain ring.
    Slot(u32),
    /// In the cell's own lanes of another cell: the edge of a grid.
    Cell(u32),
    /// In a slot for each lane: the collar of a mesh.
    Slots([u32; LANES]),
}

impl Anchor {
    /// The slot of the pin of `lane`.
    pub fn slot(self, lane: usize) -> usize {
        match self {
            Self::Slot(slot) => slot as usize,
            Self::Cell(cell) => cell as usize * LANES + lane,
            Self::Slots(slots) => slots[lane] as usize,
        }
    }
}

impl TetherPlan {
    pub fn new(tethers: &Tethers, layout: &Layout) -> Self {
        Self::default().repacked(&[], tethers, layout)
    }

    /// The plan with the present ties of those cells that are `kept`, and with these `tethers` of all others.
    pub fn repacked(&self, kept: &[bool], tethers: &Tethers, layout: &Layout) -> Self {
        // Sorted by cells, of which each has few.
        let mut first = vec![0; layout.cells() + 1];
        let slot = |particle: u32| layout.slot(particle as usize);
        tethers.particle.iter().for_each(|&particle| first[slot(particle) / LANES + 1] += 1);
        (1..first.len()).for_each(|cell| first[cell] += first[cell - 1]);
        let mut next = first.clone();
        let mut places = vec![CellTether::default(); tethers.len()];
        for (particle, pin, length) in tethers.iter() {
            let (cell, lane) = (slot(particle) / LANES, slot(particle) % LANES);
            places[next[cell]] = CellTether { particle, lane: lane as u32, pin: slot(pin) as u32, length };
            next[cell] += 1;
        }
        let mut plan = Self { first: Vec::with_capacity(layout.cells() + 1), ..Self::default() };
        for (cell, own) in first.windows(2).enumerate() {
            plan.first.push(plan.ties.len() as u32);
            if kept.get(cell) == Some(&true) {
                for &Tie { length, anchor } in self.ties_of(cell) {
                    plan.push(length, self.anchors[anchor as usize]);
                }
                continue;
            }
            let own = &mut places[own[0]..own[1]];
            // Stable: those of one particle stay in order.
            own.sort_by_key(|tether| tether.particle);
            plan.pack(own);
        }
        plan.first.push(plan.ties.len() as u32);
        plan
    }

    /// Packs the tethers of one cell into ties of one anchor each, or, if that takes more than twice as many, into one tie for each of the
    /// tethers that a particle has.
    fn pack(&mut self, tethers: &[CellTether]) {
        let of_particles = || tethers.chunk_by(|p, q| p.particle == q.particle);
        let ranks = of_particles().map(<[_]>::len).max().unwrap_or(0);
        let mut ties = pack_by_pins(tethers.to_vec());
        if ties.len() > 2 * ranks {
            ties.clear();
            for rank in 0..ranks {
                let (mut length, mut slots) = ([f32::INFINITY; LANES], [0; LANES]);
                for tether in of_particles().filter_map(|own| own.get(rank)) {
                    (length[tether.lane as usize], slots[tether.lane as usize]) = (tether.length, tether.pin);
                }
                ties.push((length, Anchor::Slots(slots)));
            }
        }
        for (length, anchor) in ties {
            self.push(length, anchor);
        }
    }

    fn push(&mut self, length: [f32; LANES], anchor: Anchor) {
        let known = match anchor {
            // Those of a slot for each lane are hardly ever the same.
            Anchor::Slots(_) => None,
            _ => self.anchors.iter().position(|&known| known == anchor),
        };
        let place = known.unwrap_or_else(|| {
            self.anchors.push(anchor);
            self.anchors.len() - 1
        });
        self.ties.push(Tie { length, anchor: place as u32 });
    }

    pub fn is_empty(&self) -> bool {
        self.ties.is_empty()
    }

    fn ties_of(&self, cell: usize) -> &[Tie] {
        &self.ties[self.first[cell] as usize..self.first[cell + 1] as usize]
    }

    /// The tethers of a cell: slot, slot of the pin, and length in metres.
    pub fn of_cell(&self, cell: usize) -> impl Iterator<Item = (usize, usize, f32)> + '_ {
        self.ties_of(cell).iter().flat_map(move |tie| {
            let lanes = (0..LANES).filter(|&lane| tie.length[lane].is_finite());
            let pin = self.anchors[tie.anchor as usize];
            lanes.map(move |lane| (cell * LANES + lane, pin.slot(lane), tie.length[lane]))
        })
    }

    /// The way in this substep of the nearest pin that a tether holds the particle in `slot` to, in metres; zero if there is none.
    pub fn anchor_travel(&self, slot: usize, particles: &Particles) -> Vec3 {
        let (cell, lane) = (slot / LANES, slot % LANES);
        let pins = self.ties_of(cell).iter().filter(|tie| tie.length[lane].is_finite()).filter_map(|tie| {
            let pin = self.anchors[tie.anchor as usize].slot(lane);
            particles.is_anchor(pin).then_some((tie.length[lane], pin))
        });
        let nearest = pins.min_by(|(a, _), (b, _)| a.total_cmp(b));
        nearest.map_or(Vec3::ZERO, |(_, pin)| particles.displacement.get(pin))
    }

    /// Each tether as (particle, pin, length in metres), in order of the particles.
    pub fn list(&self, layout: &Layout) -> Vec<(u32, u32, f32)> {
        let cells = 0..self.first.len().saturating_sub(1);
        let named =
            |(slot, pin, length)| Some((layout.index(slot)? as u32, layout.index(pin)? as u32, length));
        let mut list: Vec<_> = cells.flat_map(|cell| self.of_cell(cell)).filter_map(named).collect();
        list.sort_by_key(|tether| tether.0);
        list
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.ties) + size_of_val(&*self.anchors)
    }
}

/// A tether of one cell.
#[derive(Clone, Copy, Debug, Default)]
struct CellTether {
    particle: u32,
    lane: u32,
    /// The slot of its pin.
    pin: u32,
    /// Metres.
    length: f32,
}

/// Packs the tethers of one cell into ties of which each has one anchor for all lanes.
fn pack_by_pins(mut tethers: Vec<CellTether>) -> Vec<([f32; LANES], Anchor)> {
    const ALL: u32 = LANES as u32;
    let mut ties = Vec::new();
    while let Some(&CellTether { lane, pin, .. }) = tethers.first() {
        let shares_pin = |tether: &CellTether| tether.pin == pin;
        let is_aligned = |tether: &CellTether| {
            pin % ALL == lane && tether.pin / ALL == pin / ALL && tether.pin % ALL == tether.lane
        };
        let (shared, aligned) = tethers.iter().fold((0, 0), |(shared, aligned), tether| {
            (shared + u32::from(shares_pin(tether)), aligned + u32::from(is_aligned(tether)))
        });
        let mut length = [f32::INFINITY; LANES];
        tethers.retain(|tether| {
            let is_in = if aligned > shared { is_aligned(tether) } else { shares_pin(tether) };
            if is_in {
                length[tether.lane as usize] = tether.length;
            }
            !is_in
        });
        ties.push((length, if aligned > shared { Anchor::Cell(pin / ALL) } else { Anchor::Slot(pin) }));
    }
    ties
}

fn by_distance(a: &(f32, u32, u32), b: &(f32, u32, u32)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// A particle reached from a pin, ordered by distance, then by index, so that the order is the same on every machine.
#[derive(Clone, Copy, PartialEq)]
struct Visit {
    distance: f32,
    particle: u32,
    pin: u32,
}

impl Eq for Visit {}

impl Ord for Visit {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance
            .total_cmp(&other.distance)
            .then(self.particle.cmp(&other.particle))
            .then(self.pin.cmp(&other.pin))
    }
}

impl PartialOrd for Visit {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
