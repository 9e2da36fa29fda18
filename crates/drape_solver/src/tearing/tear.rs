//! Tearing: cloth and ropes part where they are stretched too far.
//!
//! A stick that is stretched beyond a limit pulls its weaker end apart, at right angles to itself (S24). All sticks that
//! are too long are marked first, then their particles are split together, so that what tears does not
//! depend on the order in which it is looked at. No face is lost: the cloth opens along the edges of its faces.
//!
//! ```text
//!   pulled to the right         o---o---o
//!   at a:                       |   |   |         the two edges at a that are most
//!     o---a===>b                o---a a'===>b     nearly at right angles to the pull
//!                               |  /   \  |       open; next time the pull is at
//!                               o--o-----o        their far ends, and the tear runs on
//! ```

use glam::Vec3;

use crate::build::adjacency::Fabric;
use crate::constraint::strain::greatest_stretch;
use crate::error::BuildError;
use crate::state::body::Body;
use crate::state::topology::{StickBound, StickKind};
use crate::tearing::pieces::{self, Piece};
use crate::tearing::split::Cracks;

/// When a body tears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TearLimits {
    /// The strain of a structural stick beyond which it tears: 0.5 means half as long again as at rest. Above 0.
    pub strain: f32,
    /// The most particles that are split at once: the most stretched sticks come first, the others wait for the next time.
    pub most: u32,
}

impl Default for TearLimits {
    /// Half as long again; 16 at once.
    fn default() -> Self {
        Self { strain: 0.5, most: 16 }
    }
}

/// A stick that has given way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TornStick {
    /// The particles that it joined, by their indices before.
    pub particles: [u32; 2],
    /// Metres.
    pub rest_length: f32,
    /// How long it was when it gave way, in metres.
    pub length: f32,
    /// The middle of it in the world.
    pub position: Vec3,
}

/// What a tear or a cut has done to a body.
#[derive(Clone, Debug)]
pub struct Torn {
    /// For each particle that the body has now the index that it had before, or that of the particle that it is a copy of.
    pub origins: Vec<u32>,
    /// The sticks that gave way.
    pub sticks: Vec<TornStick>,
    /// What has come off, largest first.
    pub pieces: Vec<Piece>,
}

impl Body {
    /// Tears the body where its structural sticks are longer than `limits` allow; none where nothing tears. What comes off
    /// is taken out of the body, which remains the largest piece.
    ///
    /// Mass and momentum stay; faces keep their number; the particles of a split one are behind the others. Pinned
    /// particles are not split. To be called between steps.
    ///
    /// # Errors
    /// [`BuildError`] if a piece cannot be built; the body is as it was then.
    pub fn tear(&mut self, limits: &TearLimits) -> Result<Option<Torn>, BuildError> {
        self.particles.arrange(&self.topology.layout);
        let stretch = greatest_stretch(self);
        // What is not a number tears nothing.
        if stretch.is_nan() || stretch <= limits.strain {
            return Ok(None);
        }
        let mut stretched = Vec::new();
        for batch in self.topology.batches.iter().filter(|batch| batch.material.kind == StickKind::Structural)
        {
            // One that keeps its ends apart has nothing to tear.
            let is_cord = batch.material.bound != StickBound::AtLeast;
            for stick in batch.range().filter(|_| is_cord).map(|i| self.torn_stick(i)) {
                let strain = stick.length / stick.rest_length - 1.0;
                if strain > limits.strain {
                    stretched.push((strain, stick));
                }
            }
        }
        stretched.sort_by(|(p, a), (q, b)| q.total_cmp(p).then(a.particles.cmp(&b.particles)));
        let mut cracks = Cracks::default();
        let mut sticks = Vec::new();
        let fabric = Fabric::new(&self.topology);
        let mut is_used = vec![false; self.particles.len()];
        for (_, stick) in stretched {
            if sticks.len() >= limits.most as usize {
                break;
            }
            if let Some(split) = self.crack(&fabric, &stick, &mut cracks, &is_used) {
                let around = fabric.around(split).flat_map(|element| fabric.corners(element));
                around.for_each(|&corner| is_used[corner as usize] = true);
                sticks.push(stick);
            }
        }
        let parted = pieces::part(self, &cracks)?;
        Ok(parted.map(|parted| Torn { origins: parted.origins, sticks, pieces: parted.pieces }))
    }

    /// Adds the cracks that a stick makes which pulls at one of its ends; that end, or none if neither can part.
    fn crack(
        &self,
        fabric: &Fabric,
        stick: &TornStick,
        cracks: &mut Cracks,
        is_used: &[bool],
    ) -> Option<u32> {
        let [a, b] = stick.particles;
        let may_part = |end: u32| !is_used[end as usize] && !self.particles.is_pinned(end as usize);
        let ends = [(a, b), (b, a)].into_iter().filter(|&(end, _)| may_part(end));
        if !fabric.has_faces() {
            let (end, _) = ends.into_iter().find(|&(end, _)| fabric.around(end).nth(1).is_some())?;
            cracks.particles.insert(end);
            return Some(end);
        }
        let fans = ends.filter_map(|(end, pulled)| {
            let fan = fabric.fan(end)?;
            Some((fan.is_closed(), end, fan.cracks(pulled)?))
        });
        // The rim, and the end of a tear, part before the middle of the cloth does.
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
