//! Particles between a mover and an obstacle that holds them up: cloth under a crate on the floor.
//!
//! ```text
//!    mover   | n         The floor takes back what the mover's push moves the particle along m. So a push of the
//!   =========v====       size p moves the particle by p w (n + c m), with c = -n . m, and along n by p w (1 - c^2):
//!            o           under a level box it does not give way at all, and the box is held up.
//!   =========^====
//!    floor   | m
//! ```
//!
//! Design: `docs/design/dynamic_obstacles.md`.

use glam::Vec3;

use crate::broad_phase::obstacle_search::Candidate;
use crate::contact::particle_obstacle::{ObstacleGroup, Pushes};
use crate::simd::columns::LANES;

/// The contacts with obstacles that nothing pushes, in the order of their cells. Empty if there are no movers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Supports {
    /// The cell and the place in the list of candidates.
    of_cell: Vec<(u32, u32)>,
}

/// What holds up a particle against a push.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Support {
    /// The place of its contact in the list of candidates.
    pub place: usize,
    /// The unit normal along which it pushes.
    pub normal: Vec3,
    /// The cosine between the push and the ground that takes it: 1 if they are opposite.
    pub cosine: f32,
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

    /// What holds up the particle in a slot against a push along the unit vector `normal`, if anything has pushed it in this substep.
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
        let mut best: Option<Support> = None;
        for place in of_cell.map(|&(_, place)| place as usize) {
            if candidates[place].is_touching && pushes[place].depth[lane] > 0.0 {
                let support = pushes[place].normal.get(lane);
                let cosine = -normal.dot(support);
                if cosine > best.map_or(0.0, |best| best.cosine) {
                    best = Some(Support { place, normal: support, cosine: cosine.min(1.0) });
                }
            }
        }
        best
    }
}
