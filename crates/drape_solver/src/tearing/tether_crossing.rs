//! Drops the tethers that a crack crosses at rest.
//!
//! ```text
//!   pin o   o pin      the tether of p runs through the crack and is dropped; that of q stays, as
//!       |\  |          q is as far from its pin as before
//!     ==|=\=|===
//!       p  \q
//! ```
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::simd::columns::LANES;
use crate::state::layout::Layout;
use crate::state::tethers::{TetherPlan, Tethers};
use crate::state::topology::Topology;
use crate::tearing::piece_topology::ELSEWHERE;
use crate::tearing::split::{Cracks, Split};

/// The cracks of a body that is flat at rest, as line segments that no tether may cross.
pub(crate) struct TetherCrossing {
    /// Unit vectors in the plane of the body at rest.
    axes: [Vec3; 2],
    lines: Vec<[Vec2; 2]>,
    /// Corners of a box around all lines, along the first of them.
    corners: [Vec2; 4],
}

/// An end of a tether.
#[derive(Clone, Copy)]
struct End {
    place: Vec2,
    /// A bit for each side of the box around all lines beyond which it lies.
    beyond: u8,
}

/// Above 0 if a point lies to the left of the way between two others.
fn side(from: Vec2, to: Vec2, point: Vec2) -> f32 {
    (to - from).perp_dot(point - from)
}

impl TetherCrossing {
    pub fn new(topology: &Topology, cracks: &Cracks) -> Self {
        let rest = |corner: u32| topology.rest[corner as usize];
        let axes = topology.faces.first().map(|&[p, q, r]| {
            let along = (rest(q) - rest(p)).normalize_or(Vec3::X);
            [along, (rest(r) - rest(p)).reject_from_normalized(along).normalize_or(Vec3::Y)]
        });
        let axes = axes.unwrap_or([Vec3::X, Vec3::Y]);
        let mut crossing = Self { axes, lines: Vec::new(), corners: [Vec2::ZERO; 4] };
        let edges = cracks.edges.iter().map(|edge| edge.map(rest));
        let lines = edges.chain(cracks.lines.iter().copied());
        crossing.lines = lines.map(|line| line.map(|end| crossing.flat(end))).collect();
        crossing.corners = box_around(&crossing.lines);
        crossing
    }

    fn flat(&self, place: Vec3) -> Vec2 {
        Vec2::from(self.axes.map(|axis| axis.dot(place)))
    }

    fn end(&self, place: Vec3) -> End {
        let (place, [a, b, c, d]) = (self.flat(place), self.corners);
        let sides = [[a, b], [b, c], [c, d], [d, a]].map(|[from, to]| side(from, to, place) < 0.0);
        End { place, beyond: sides.into_iter().fold(0, |bits, is_beyond| bits << 1 | u8::from(is_beyond)) }
    }

    fn is_crossed(&self, p: End, q: End) -> bool {
        if p.beyond & q.beyond != 0 {
            return false;
        }
        let (p, q) = (p.place, q.place);
        let sides = self.corners.map(|corner| side(p, q, corner));
        if sides.iter().all(|&side| side < 0.0) || sides.iter().all(|&side| side > 0.0) {
            return false;
        }
        // Counts a touch as a crossing: one tether fewer does no harm.
        self.lines.iter().any(|&[a, b]| {
            let meet = p.min(q).cmple(a.max(b)).all() && a.min(b).cmple(p.max(q)).all();
            meet && side(p, q, a) * side(p, q, b) <= 0.0 && side(a, b, p) * side(a, b, q) <= 0.0
        })
    }

    /// The tethers of a piece that no crack crosses, for particles in this `layout`. `indices` has the index in the piece of each of its
    /// `members`, and [`ELSEWHERE`] for all others.
    pub fn uncrossed(&self, split: &Split, members: &[u32], indices: &[u32], layout: &Layout) -> TetherPlan {
        let Topology { tethers: plan, layout: old, .. } = split.adjacency.topology();
        let before = old.count();
        // The members that come of each particle: itself, and the copies behind all that were there before.
        let mut copies: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut has_copies = vec![false; before];
        for &member in members.iter().filter(|&&member| member as usize >= before) {
            copies.entry(split.origins[member as usize]).or_default().push(member);
            has_copies[split.origins[member as usize] as usize] = true;
        }
        let come_of = |particle: u32| {
            let own = (indices[particle as usize] != ELSEWHERE).then_some(particle);
            let others = if has_copies[particle as usize] { copies.get(&particle) } else { None };
            own.into_iter().chain(others.into_iter().flatten().copied())
        };
        let ends: Vec<End> = members.iter().map(|&member| self.end(inside(split, member))).collect();
        let end = |member: u32| ends[indices[member as usize] as usize];
        // The particle in each slot, and true if it keeps that slot and has not been split.
        let mut slots = vec![(ELSEWHERE, false); old.cells() * LANES];
        for (particle, slot) in (0..).zip(old.slots()) {
            let index = indices[particle as usize];
            let stays = index != ELSEWHERE && layout.slot(index as usize) == slot;
            slots[slot] = (particle, stays && !has_copies[particle as usize]);
        }
        let mut changed = Vec::new();
        let mut kept = Vec::new();
        for cell in 0..old.cells() {
            let (begun, mut is_same) = (changed.len(), true);
            for (slot, pin, length) in plan.of_cell(cell) {
                let [(particle, stays), (pin, pin_stays)] = [slots[slot], slots[pin]];
                let holds = |member: u32, pin: u32| {
                    split.is_real[pin as usize] && !self.is_crossed(end(member), end(pin))
                };
                let mut tie = |member: u32, pin: u32| {
                    changed.push((indices[member as usize], indices[pin as usize], length));
                };
                if stays && pin_stays {
                    let is_left = holds(particle, pin);
                    is_same &= is_left;
                    if is_left {
                        tie(particle, pin);
                    }
                    continue;
                }
                is_same = false;
                for member in come_of(particle) {
                    if let Some(pin) = come_of(pin).find(|&pin| holds(member, pin)) {
                        tie(member, pin);
                    }
                }
            }
            // Particles that stay have their cell in the new layout, too.
            if is_same && changed.len() > begun {
                kept.push(cell);
                changed.truncate(begun);
            }
        }
        let mut is_kept = vec![false; layout.cells()];
        kept.into_iter().for_each(|cell| is_kept[cell] = true);
        // A copy may come into the cell of copies of an earlier tear.
        for place in 0..changed.len() {
            let cell = layout.slot(changed[place].0 as usize) / LANES;
            if core::mem::take(&mut is_kept[cell]) {
                let index = |slot: usize| indices[slots[slot].0 as usize];
                changed
                    .extend(plan.of_cell(cell).map(|(slot, pin, length)| (index(slot), index(pin), length)));
            }
        }
        plan.repacked(&is_kept, &Tethers::from_list(changed), layout)
    }
}

/// Corners, counter-clockwise, of a box around all `lines`, along the first of them, and somewhat wider.
fn box_around(lines: &[[Vec2; 2]]) -> [Vec2; 4] {
    let along = lines.first().map_or(Vec2::X, |[from, to]| (*to - *from).normalize_or(Vec2::X));
    let turned = |point: &Vec2| Vec2::new(along.dot(*point), along.perp_dot(*point));
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for point in lines.as_flattened().iter().map(turned) {
        (low, high) = (low.min(point), high.max(point));
    }
    let margin = BOX_MARGIN * (high - low).max_element();
    let (low, high) = (low - margin, high + margin);
    let corners = [low, Vec2::new(high.x, low.y), high, Vec2::new(low.x, high.y)];
    corners.map(|Vec2 { x, y }| along * x + along.perp() * y)
}

/// Part of the longer side by which the box around all lines is wider than they are: rounding must not put them outside.
const BOX_MARGIN: f32 = 1e-3;

/// A point just inside the faces around a split particle at rest, on its side of the crack; in their middle if the place of the particle
/// belongs to none of them.
fn inside(split: &Split, member: u32) -> Vec3 {
    let place = split.adjacency.topology().rest[split.origins[member as usize] as usize];
    if split.shares[member as usize] == 1.0 {
        return place;
    }
    let middle = split.middle_of(member);
    if split.is_real[member as usize] { place + (middle - place) * INWARDS } else { middle }
}

/// The part of the way to the middle of its faces by which such a point is moved.
const INWARDS: f32 = 1e-2;
