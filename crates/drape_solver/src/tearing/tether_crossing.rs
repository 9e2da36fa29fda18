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

use glam::{Vec2, Vec3};

use crate::state::tethers::Tethers;
use crate::state::topology::Topology;
use crate::tearing::split::{Cracks, Split};

/// The cracks of a body that is flat at rest, as line segments that no tether may cross.
pub(crate) struct TetherCrossing {
    /// Unit vectors in the plane of the body at rest.
    axes: [Vec3; 2],
    lines: Vec<[Vec2; 2]>,
    /// Least and greatest corner of the box around all lines.
    bounds: [Vec2; 2],
}

impl TetherCrossing {
    pub fn new(topology: &Topology, cracks: &Cracks) -> Self {
        let rest = |corner: u32| topology.rest[corner as usize];
        let axes = topology.faces.first().map(|&[p, q, r]| {
            let along = (rest(q) - rest(p)).normalize_or(Vec3::X);
            [along, (rest(r) - rest(p)).reject_from_normalized(along).normalize_or(Vec3::Y)]
        });
        let bounds = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        let mut crossing = Self { axes: axes.unwrap_or([Vec3::X, Vec3::Y]), lines: Vec::new(), bounds };
        let edges = cracks.edges.iter().map(|edge| edge.map(rest));
        for line in edges.chain(cracks.lines.iter().copied()) {
            let line = line.map(|end| crossing.flat(end));
            let [low, high] = crossing.bounds;
            crossing.bounds = [low.min(line[0]).min(line[1]), high.max(line[0]).max(line[1])];
            crossing.lines.push(line);
        }
        crossing
    }

    fn flat(&self, place: Vec3) -> Vec2 {
        Vec2::from(self.axes.map(|axis| axis.dot(place)))
    }

    fn is_crossed(&self, p: Vec2, q: Vec2) -> bool {
        let [low, high] = self.bounds;
        if p.max(q).cmplt(low).any() || p.min(q).cmpgt(high).any() {
            return false;
        }
        // Counts a touch as a crossing: one tether fewer does no harm.
        self.lines.iter().any(|&[a, b]| {
            let side = |origin: Vec2, end: Vec2, point: Vec2| (end - origin).perp_dot(point - origin);
            side(p, q, a) * side(p, q, b) <= 0.0 && side(a, b, p) * side(a, b, q) <= 0.0
        })
    }

    /// The tethers of a piece that no crack crosses. `indices` has the index in the piece of each of its `members`.
    pub fn uncrossed(&self, split: &Split, members: &[u32], indices: &[u32]) -> Tethers {
        let topology = split.adjacency.topology();
        let origin = |member: u32| split.origins[member as usize] as usize;
        // Groups the copies of each particle.
        let mut by_origin: Vec<u32> = members.to_vec();
        by_origin.sort_by_key(|&member| origin(member));
        let copies = |particle: u32| {
            let first = by_origin.partition_point(|&member| origin(member) < particle as usize);
            by_origin[first..].iter().copied().take_while(move |&member| origin(member) == particle as usize)
        };
        let mut uncrossed = Vec::new();
        for (particle, pin, length) in topology.tethers.list(&topology.layout) {
            for member in copies(particle) {
                let from = self.flat(inside(split, member));
                let is_free = |&pin: &u32| {
                    split.is_real[pin as usize] && !self.is_crossed(from, self.flat(inside(split, pin)))
                };
                if let Some(pin) = copies(pin).find(is_free) {
                    uncrossed.push((indices[member as usize], indices[pin as usize], length));
                }
            }
        }
        uncrossed.sort_by_key(|&(particle, ..)| particle);
        Tethers::from_list(uncrossed)
    }
}

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
