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

/// The tethers of a body: up to [`MAX_TETHERS`] for each particle, nearest pin first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tethers {
    /// Particle that each tether holds; ascending.
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
        let mut neighbours: Vec<Vec<(u32, f32)>> = vec![Vec::new(); particle_count];
        for (a, b, length) in edges {
            neighbours[a as usize].push((b, length));
            neighbours[b as usize].push((a, length));
        }
        let mut reached: Vec<Vec<(f32, u32)>> = vec![Vec::new(); particle_count];
        let mut queue: BinaryHeap<Reverse<Visit>> = BinaryHeap::new();
        for &pin in pins {
            queue.push(Reverse(Visit { distance: 0.0, particle: pin, pin }));
        }
        while let Some(Reverse(visit)) = queue.pop() {
            let known = &mut reached[visit.particle as usize];
            if known.len() == MAX_TETHERS || known.iter().any(|&(_, pin)| pin == visit.pin) {
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
            if !pins.contains(&(i as u32)) {
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

    /// Tethers from (particle, pin, length in metres), in order of the particles, nearest pin first.
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
}

impl Anchor {
    /// The slot of the pin of `lane`.
    pub fn slot(self, lane: usize) -> usize {
        match self {
            Self::Slot(slot) => slot as usize,
            Self::Cell(cell) => cell as usize * LANES + lane,
        }
    }
}

impl TetherPlan {
    pub fn new(tethers: &Tethers, layout: &Layout) -> Self {
        let mut places: Vec<(usize, usize, usize, f32)> = Vec::with_capacity(tethers.len());
        places.extend(tethers.iter().map(|(particle, pin, length)| {
            let [slot, pin] = [particle, pin].map(|index| layout.slot(index as usize));
            (slot / LANES, slot % LANES, pin, length)
        }));
        // Stable: the nearest pin of each particle stays the first.
        places.sort_by_key(|place| place.0);
        let mut plan = Self { first: Vec::with_capacity(layout.cells() + 1), ..Self::default() };
        let mut rest = places.as_slice();
        for cell in 0..layout.cells() {
            plan.first.push(plan.ties.len() as u32);
            let (here, beyond) = rest.split_at(rest.partition_point(|place| place.0 == cell));
            for (length, anchor) in ties_of_cell(here) {
                let anchor = plan.place_of(anchor);
                plan.ties.push(Tie { length, anchor });
            }
            rest = beyond;
        }
        plan.first.push(plan.ties.len() as u32);
        plan
    }

    /// The index of `anchor` in the list, to which it is added if it is new.
    fn place_of(&mut self, anchor: Anchor) -> u32 {
        let place = self.anchors.iter().position(|&known| known == anchor);
        place.unwrap_or_else(|| {
            self.anchors.push(anchor);
            self.anchors.len() - 1
        }) as u32
    }

    pub fn is_empty(&self) -> bool {
        self.ties.is_empty()
    }

    /// The way in this substep of the nearest pin that a tether holds the particle in `slot` to, in metres; zero if there is none.
    pub fn anchor_travel(&self, slot: usize, particles: &Particles) -> Vec3 {
        let (cell, lane) = (slot / LANES, slot % LANES);
        let ties = &self.ties[self.first[cell] as usize..self.first[cell + 1] as usize];
        let pins = ties.iter().filter(|tie| tie.length[lane].is_finite()).filter_map(|tie| {
            let pin = self.anchors[tie.anchor as usize].slot(lane);
            particles.is_anchor(pin).then_some((tie.length[lane], pin))
        });
        let nearest = pins.min_by(|(a, _), (b, _)| a.total_cmp(b));
        nearest.map_or(Vec3::ZERO, |(_, pin)| particles.displacement.get(pin))
    }

    /// Each tether as (particle, pin, length in metres).
    pub fn list(&self, layout: &Layout) -> Vec<(u32, u32, f32)> {
        let mut list = Vec::new();
        for (cell, range) in self.first.windows(2).enumerate() {
            for tie in &self.ties[range[0] as usize..range[1] as usize] {
                for lane in (0..LANES).filter(|&lane| tie.length[lane].is_finite()) {
                    let pin = self.anchors[tie.anchor as usize].slot(lane);
                    if let [Some(particle), Some(pin)] =
                        [cell * LANES + lane, pin].map(|slot| layout.index(slot))
                    {
                        list.push((particle as u32, pin as u32, tie.length[lane]));
                    }
                }
            }
        }
        list.sort_by_key(|tether| tether.0);
        list
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.ties) + size_of_val(&*self.anchors)
    }
}

/// Packs the tethers of one cell, (cell, lane, pin's slot, length), into as few ties as their pins allow.
fn ties_of_cell(tethers: &[(usize, usize, usize, f32)]) -> Vec<([f32; LANES], Anchor)> {
    let mut ties = Vec::new();
    let mut rest = tethers.to_vec();
    while let Some(&(_, lane, pin, _)) = rest.first() {
        let shares_pin = |tether: &(usize, usize, usize, f32)| tether.2 == pin;
        let is_aligned = |tether: &(usize, usize, usize, f32)| {
            pin % LANES == lane && tether.2 / LANES == pin / LANES && tether.2 % LANES == tether.1
        };
        let count =
            |is_in: &dyn Fn(&(usize, usize, usize, f32)) -> bool| rest.iter().filter(|t| is_in(t)).count();
        let aligned = count(&is_aligned) > count(&shares_pin);
        let mut length = [f32::INFINITY; LANES];
        rest.retain(|tether| {
            let is_in = if aligned { is_aligned(tether) } else { shares_pin(tether) };
            if is_in {
                length[tether.1] = tether.3;
            }
            !is_in
        });
        let anchor = if aligned { Anchor::Cell((pin / LANES) as u32) } else { Anchor::Slot(pin as u32) };
        ties.push((length, anchor));
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
