//! Tearing: cloth and ropes tear where they are stretched too far.
//!
//! A stick that is stretched beyond a limit splits its weaker end, at right angles to itself (S24). All sticks that are too
//! long are marked first, and then their particles are split together, so that the result does not depend on the order of
//! sticks. The cloth opens along the edges of its faces; no face is lost. The stretched stick stays; its end is split.
//! Sticks across the crack are removed (`split.rs`, `Split::joined`).
//!
//! ```text
//!   pulled to the right         o---o---o
//!   at a:                       |   |   |         the two edges at a that are most
//!     o---a===>b                o---a a'===>b     nearly at right angles to the pull
//!                               |  /   \  |       open; next time the pull is at
//!                               o--o-----o        their far ends, and the tear runs on
//! ```
//!
//! Design: `docs/design/tears_and_cuts.md`.

use std::sync::Arc;

use glam::Vec3;

use crate::build::adjacency::Adjacency;
use crate::constraint::strain::stretched_sticks;
use crate::error::BuildError;
use crate::state::body::Body;
use crate::tearing::elements::Elements;
use crate::tearing::pieces::{self, Piece};
use crate::tearing::split::Cracks;

/// The strain at which a body tears, and the number of splits per call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TearLimits {
    /// The strain of a structural stick beyond which it tears: 0.5 means half as long again as at rest. Above 0.
    /// [Lines](crate::StructuralSolve::Lines) leave next to no strain: sweep what is to tear.
    pub strain: f32,
    /// The greatest number of particles to split in one call. The most stretched sticks come first; the others wait for the
    /// next call.
    pub most: u32,
}

impl Default for TearLimits {
    /// Tears at a strain of 0.5, at most 16 particles in a call.
    fn default() -> Self {
        Self { strain: 0.5, most: 16 }
    }
}

/// A stick that tore or was cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TornStick {
    /// Indices of its particles before the tear.
    pub particles: [u32; 2],
    /// Rest length in metres.
    pub rest_length: f32,
    /// Length in metres when it tore.
    pub length: f32,
    /// Its middle in the world in metres.
    pub position: Vec3,
}

/// The result of a tear or a cut.
#[derive(Clone, Debug)]
pub struct Torn {
    /// For each particle of the body now, its index before; for a copy, that of the particle it was split from.
    pub origins: Vec<u32>,
    /// The sticks that tore or were cut.
    pub sticks: Vec<TornStick>,
    /// The edges of faces along which it tore, by their particles before, the lower index first, in order. A cut has none.
    pub edges: Vec<[u32; 2]>,
    /// The pieces that have separated, largest first.
    pub pieces: Vec<Piece>,
}

impl Body {
    /// Tears the body where its structural sticks, as far as they are relaxed, are longer than `limits` allow; returns none if nothing tears. The body
    /// becomes its largest piece, and [`Torn::pieces`] holds the others.
    ///
    /// Mass, momentum and the area stay. Copies of split particles come behind all others. Pinned particles are not
    /// split. Call it between steps.
    ///
    /// # Errors
    /// [`BuildError`] if a piece cannot be built; the body is then unchanged.
    pub fn tear(&mut self, limits: &TearLimits) -> Result<Option<Torn>, BuildError> {
        self.particles.arrange(&self.topology.layout);
        let topology = Arc::clone(&self.topology);
        let too_long = stretched_sticks(self, limits.strain);
        if too_long.is_empty() {
            return Ok(None);
        }
        let sticks = too_long.into_iter().map(|i| self.torn_stick(i));
        let mut stretched: Vec<(f32, TornStick)> =
            sticks.map(|stick| (stick.length / stick.rest_length - 1.0, stick)).collect();
        stretched.sort_by(|(p, a), (q, b)| q.total_cmp(p).then(a.particles.cmp(&b.particles)));
        let mut cracks = Cracks::default();
        let mut sticks = Vec::new();
        let adjacency = Adjacency::new(&topology);
        let mut is_used = vec![false; self.particles.len()];
        for (_, stick) in stretched {
            if sticks.len() >= limits.most as usize {
                break;
            }
            if let Some(split) = self.crack(&adjacency, &stick, &mut cracks, &is_used) {
                let around = adjacency.around(split).flat_map(|element| adjacency.corners(element));
                around.for_each(|&corner| is_used[corner as usize] = true);
                sticks.push(stick);
            }
        }
        // Without parts of faces, the elements are the faces.
        let known = topology.parts.is_empty().then_some(adjacency);
        let parted = pieces::part(self, &Elements::of(&topology), &cracks, known)?;
        let edges = cracks.edges.into_iter().collect();
        Ok(parted.map(|parted| Torn { origins: parted.origins, sticks, edges, pieces: parted.pieces }))
    }

    /// Adds the cracks of a stick that pulls at one of its ends. Returns that end, or none if neither can be split.
    fn crack(
        &self,
        adjacency: &Adjacency,
        stick: &TornStick,
        cracks: &mut Cracks,
        is_used: &[bool],
    ) -> Option<u32> {
        let [a, b] = stick.particles;
        let may_part = |end: u32| !is_used[end as usize] && !self.particles.is_pinned(end as usize);
        let ends = [(a, b), (b, a)].into_iter().filter(|&(end, _)| may_part(end));
        if !adjacency.has_faces() {
            let (end, _) = ends.into_iter().find(|&(end, _)| adjacency.around(end).nth(1).is_some())?;
            cracks.particles.insert(end);
            return Some(end);
        }
        let fans = ends.filter_map(|(end, pulled)| {
            let fan = adjacency.fan(end)?;
            Some((fan.is_closed(), end, fan.cracks(pulled)?))
        });
        // The rim and the end of a tear split before the middle of the cloth.
        let (_, end, spokes) = fans.min_by_key(|&(is_closed, ..)| is_closed)?;
        spokes.into_iter().for_each(|spoke| cracks.add_edge(end, spoke));
        Some(end)
    }

    /// Stick `i` as it is now.
    pub(crate) fn torn_stick(&self, i: usize) -> TornStick {
        let particles = self.topology.stick(i);
        let [p, q] = particles.map(|end| self.particles.position(end as usize));
        let [from, to] = particles.map(|end| self.particles.local_position(end as usize));
        let (rest_length, length) = (self.topology.rest_length(i), from.distance(to));
        TornStick { particles, rest_length, length, position: p.midpoint(q) }
    }
}
