//! Particles between a mover and an obstacle that holds them up: cloth under a crate on the floor.
//!
//! ```text
//!    mover   | n         The floor takes back what a push of the mover along n moves the particle along m. So the particle
//!   =========v====       gives way to the push as if its inverse mass were w (1 - c^2), with c = -n . m: under a level box
//!            o           not at all, and the box is held up.
//!   =========^====
//!    floor   | m
//! ```
//!
//! If n and m are almost opposite, friction keeps the particle from slipping out sideways like a pip.
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::Vec3;

use crate::broad_phase::obstacle_search::Candidate;
use crate::constants::HELD_FAST;
use crate::contact::particle_obstacle::{ObstacleGroup, Pushes};
use crate::simd::columns::LANES;

/// The contacts with obstacles that nothing pushes, in the order of their cells. Empty if there are no movers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Supports {
    /// The cell and the place in the list of candidates.
    of_cell: Vec<(u32, u32)>,
}

/// A contact that holds up a particle against a push.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Support {
    /// The place of its contact in the list of candidates.
    pub place: usize,
    /// The displacement that it gives the particle for each metre that the push would move it.
    pub back: Vec3,
    /// The part of the particle's inverse mass that is left against the push.
    pub left: f32,
}

impl Supports {
    /// Sorts the contacts of the coming step; a body may have `most`.
    pub fn sort(&mut self, groups: &[ObstacleGroup], candidates: &[Candidate], most: usize) {
        self.of_cell.clear();
        if groups.iter().any(|group| group.is_dynamic) {
            // For all at once, so that cells that come near one by one do not allocate one by one.
            self.of_cell.reserve(most);
            let all = (0..).zip(candidates);
            let held = all.filter(|(_, candidate)| !groups[usize::from(candidate.group)].is_dynamic);
            self.of_cell.extend(held.map(|(place, candidate)| (candidate.cell, place)));
            self.of_cell.sort_unstable();
        }
    }

    /// The contact that holds up the particle in a slot against a push along the unit vector `normal`, if one has pushed it in this
    /// substep.
    pub fn of(
        &self,
        slot: usize,
        normal: Vec3,
        candidates: &[Candidate],
        pushes: &[Pushes],
    ) -> Option<Support> {
        let (cell, lane) = ((slot / LANES) as u32, slot % LANES);
        let first = self.of_cell.partition_point(|&(other, _)| other < cell);
        let of_cell = self.of_cell[first..].iter().take_while(|&&(other, _)| other == cell);
        let pushing = of_cell
            .map(|&(_, place)| place as usize)
            .filter(|&place| candidates[place].is_touching && pushes[place].depth[lane] > 0.0);
        let (mut most, mut best) = (0.0, None);
        for place in pushing {
            let cosine = -normal.dot(pushes[place].normal.get(lane));
            if cosine > most {
                (most, best) = (cosine, Some(place));
            }
        }
        best.map(|place| {
            if most > HELD_FAST {
                Support { place, back: -normal, left: 0.0 }
            } else {
                Support { place, back: pushes[place].normal.get(lane) * most, left: 1.0 - most * most }
            }
        })
    }
}
