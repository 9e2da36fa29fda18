//! Islands: groups of bodies and balls that are stepped together.
//!
//! The solver owns the bodies that it steps. A body's columns are moved from its component into an island (a few
//! pointers, no copy of particles), stepped, and moved back. Islands are independent, so they run on all threads of the
//! compute pool and give the same bits on any number of threads.

use bevy::prelude::*;
use drape_solver::Body;

use crate::bounds::{Bounds, overlap};
use crate::step::compute_threads::pool;
use crate::step::island_run::IslandRun;

/// All islands of this step. Slots beyond `live` are kept for their memory.
#[derive(Resource, Default)]
pub(crate) struct Islands {
    slots: Vec<IslandRun>,
    live: usize,
    /// Members to be grouped.
    pub members: Vec<IslandMember>,
    parents: Vec<usize>,
    /// Members sorted by the beginnings of their boxes, and those whose boxes are open in the sweep.
    sweep: Vec<u32>,
    open: Vec<u32>,
    slot_of: Vec<usize>,
    /// Memory in which one thread steps the bodies of one island after another.
    pub bodies: Vec<Body>,
    /// True without user systems between the stages of this step. Then each island runs all stages at once, on its own
    /// thread, while its particles are in the cache.
    pub is_fused: bool,
}

/// Kind of a member.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum MemberKind {
    Body {
        /// True if it touches other bodies of this kind.
        has_self_contact: bool,
    },
    Ball,
    /// A dynamic obstacle: everything that it touches must be in one island. Ordered after all others.
    Obstacle,
}

/// A body, ball or dynamic obstacle to be grouped.
#[derive(Clone, Copy)]
pub(crate) struct IslandMember {
    pub order: u64,
    pub entity: Entity,
    pub kind: MemberKind,
    /// Box that it does not leave within the step.
    pub bounds: Bounds,
}

impl IslandMember {
    /// True if the two can touch in this step. Balls touch everything; bodies touch each other if both have self
    /// contact.
    fn may_touch(&self, other: &Self) -> bool {
        let do_touch = match (self.kind, other.kind) {
            (MemberKind::Body { has_self_contact }, MemberKind::Body { has_self_contact: others_has }) => {
                has_self_contact && others_has
            }
            (MemberKind::Obstacle, MemberKind::Obstacle) => false,
            _ => true,
        };
        do_touch && overlap(self.bounds, other.bounds)
    }
}

/// Returns the axis along which the members are spread the farthest.
fn widest_axis(members: &[IslandMember]) -> usize {
    let corners = members.iter().map(|member| member.bounds.0);
    let low = corners.clone().fold(Vec3::INFINITY, Vec3::min);
    let size = corners.fold(Vec3::NEG_INFINITY, Vec3::max) - low;
    (1..3).fold(0, |widest, axis| if size[axis] > size[widest] { axis } else { widest })
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
        self.live().iter().map(|island| island.solver.substeps()).max().unwrap_or(0)
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
        self.members.sort_unstable_by_key(|member| member.order);
        let count = self.members.len();
        self.parents.clear();
        self.parents.extend(0..count);
        self.join_neighbours();
        self.live = 0;
        self.slot_of.clear();
        for i in 0..count {
            // The root of an island is its oldest member, so it gets its slot before the others need it.
            let root = root(&mut self.parents, i);
            if self.members[i].kind == MemberKind::Obstacle {
                // It only joins others; the obstacle itself stays in the environment.
                continue;
            }
            if root == i {
                self.open_slot();
            }
            let slot = if root == i { self.live - 1 } else { self.slot_of[root] };
            self.slot_of.push(slot);
            let (member, island) = (self.members[i], &mut self.slots[slot]);
            let list = if member.kind == MemberKind::Ball { &mut island.balls } else { &mut island.bodies };
            list.push(member.entity);
        }
    }

    /// Joins members that may touch (sweep and prune): along the axis of the widest spread, each box is compared with
    /// those that begin before it and have not ended.
    fn join_neighbours(&mut self) {
        let Self { members, parents, sweep, open, .. } = self;
        let axis = widest_axis(members);
        let begin = |member: u32| members[member as usize].bounds.0[axis];
        sweep.clear();
        sweep.extend(0..members.len() as u32);
        sweep.sort_unstable_by(|&a, &b| begin(a).total_cmp(&begin(b)).then(a.cmp(&b)));
        open.clear();
        for &next in sweep.iter() {
            let member = &members[next as usize];
            open.retain(|&other| members[other as usize].bounds.1[axis] >= member.bounds.0[axis]);
            for &other in open.iter() {
                if member.may_touch(&members[other as usize]) {
                    let (p, q) = (root(parents, next as usize), root(parents, other as usize));
                    parents[p.max(q)] = p.min(q);
                }
            }
            open.push(next);
        }
    }

    fn open_slot(&mut self) {
        if self.live == self.slots.len() {
            self.slots.push(IslandRun::default());
        }
        self.slots[self.live].reset();
        self.live += 1;
    }
}

/// Returns the oldest member of `i`'s group.
fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}
