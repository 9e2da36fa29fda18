//! Islands: groups of bodies and balls that are stepped together.
//!
//! The solver owns the bodies that it steps. A body's columns are moved from its component into an island (a few
//! pointers, no copy of particles), stepped, and moved back. Islands are independent, so they run on all threads of the
//! compute pool and give the same bits on any number of threads.

use bevy::prelude::*;
use drape_solver::Body;
use drape_solver::world::grouping::{Grouping, Member};
use drape_solver::world::kind::Kind;

use crate::step::compute_threads::pool;
use crate::step::island_run::IslandRun;

/// All islands of this step. Slots beyond `live` are kept for their memory.
#[derive(Resource, Default)]
pub(crate) struct Islands {
    slots: Vec<IslandRun>,
    live: usize,
    /// Everything that is to be grouped: active bodies and balls, and dynamic obstacles.
    pub grouping: Grouping<Entity>,
    /// Memory that bodies are stepped in on one thread, one island after another.
    pub bodies: Vec<Body>,
    /// True without user systems between the stages of this step. Then each island runs all stages at once, on its own
    /// thread, while its particles are in the cache.
    pub is_fused: bool,
}

impl Islands {
    /// Returns the islands of this step.
    pub fn live(&self) -> &[IslandRun] {
        &self.slots[..self.live]
    }

    pub fn live_mut(&mut self) -> &mut [IslandRun] {
        &mut self.slots[..self.live]
    }

    /// Returns the greatest number of substeps of an island in this step.
    pub fn substeps(&self) -> u32 {
        self.live().iter().map(|island| island.solver().substeps()).max().unwrap_or(0)
    }

    /// Returns the number of edges that passed through faces when this step began.
    pub fn crossings(&self) -> u32 {
        self.live().iter().map(|island| island.solver().self_contact_counts().crossings).sum()
    }

    /// True if there are fewer than two islands, or only one thread.
    pub fn are_for_one_thread(&self) -> bool {
        self.live < 2 || pool().thread_num() < 2
    }

    /// Runs `stages` on every island, on all threads of the compute pool.
    pub fn each(&mut self, stages: impl Fn(&mut IslandRun) + Send + Sync) {
        let pool = pool();
        let islands = self.live_mut();
        let share = islands.len().div_ceil(pool.thread_num() * 4).max(1);
        pool.scope(|scope| {
            for chunk in islands.chunks_mut(share) {
                let stages = &stages;
                scope.spawn(async move { chunk.iter_mut().for_each(stages) });
            }
        });
    }

    /// Groups the members whose boxes overlap, into islands in the order of their oldest members.
    pub fn form(&mut self) {
        let Self { slots, grouping, .. } = self;
        self.live = grouping.form(|number, &Member { key: entity, kind, .. }| {
            if number == slots.len() {
                slots.push(IslandRun::default());
            }
            let list = if kind == Kind::Ball { &mut slots[number].balls } else { &mut slots[number].bodies };
            list.push(entity);
        });
    }

    /// Empties all islands, and the list of what is to be grouped.
    pub fn clear(&mut self) {
        self.slots.iter_mut().for_each(IslandRun::reset);
        self.grouping.clear();
    }
}
