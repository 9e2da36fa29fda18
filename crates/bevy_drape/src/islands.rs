//! Islands: which bodies and balls are stepped together, and their way into the solver and back.
//!
//! The solver owns what it steps. A body's columns are moved out of its component into an island (a few pointers,
//! no copy of the particles), stepped, and moved back. Islands do not depend on each other, so they run on all
//! threads of the compute pool and give the same bits on any number of them.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use drape_solver::Body;

use crate::island::Island;
use crate::particles::{BodyState, Particles, Sticks};
use crate::projectile::{ProjectileRecord, ProjectileState};
use crate::scene_manager::{Bounds, overlap};

/// All islands of this step. Slots beyond `live` are kept for their memory.
#[derive(Resource, Default)]
pub(crate) struct Islands {
    slots: Vec<Island>,
    live: usize,
    /// What is to be grouped.
    pub members: Vec<Member>,
    parents: Vec<usize>,
    slot_of: Vec<usize>,
    /// Whether nobody has a system of their own between the stages of this step. Each island then goes through all
    /// of them in one go, on its own thread, while its particles are in the cache.
    pub is_fused: bool,
}

/// A body or ball on its way into an island.
#[derive(Clone, Copy)]
pub(crate) struct Member {
    pub order: u64,
    pub entity: Entity,
    pub is_ball: bool,
    /// Where it can get within the step.
    pub bounds: Bounds,
}

pub(crate) type BodyQuery<'w, 's> =
    Query<'w, 's, (&'static mut Particles, &'static Sticks, &'static mut BodyState)>;
pub(crate) type BallQuery<'w, 's> =
    Query<'w, 's, (&'static mut ProjectileState, &'static mut ProjectileRecord)>;

impl Islands {
    /// The islands of this step.
    pub fn live(&self) -> &[Island] {
        &self.slots[..self.live]
    }

    pub fn live_mut(&mut self) -> &mut [Island] {
        &mut self.slots[..self.live]
    }

    /// The most substeps that an island takes in this step.
    pub fn substeps(&self) -> u32 {
        self.live().iter().map(|island| island.solver.substeps()).max().unwrap_or(0)
    }

    /// Moves all bodies and balls from their components into the islands.
    pub fn take(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        for island in self.live_mut() {
            let Island { solver, bodies: entities, balls: ball_entities, .. } = island;
            solver.bodies.clear();
            for entity in entities.iter_mut() {
                let body = match bodies.get_mut(*entity) {
                    Ok((mut particles, sticks, mut state)) if fits(&particles, sticks) => Body {
                        particles: core::mem::take(&mut particles.bypass_change_detection().0),
                        topology: Arc::clone(&sticks.0),
                        settings: state.settings,
                        context: core::mem::take(&mut state.context),
                    },
                    _ => Body::default(),
                };
                let is_gone = body.particles.is_empty();
                solver.bodies.push(body);
                if is_gone {
                    // A user's system took the body away in the middle of the step.
                    solver.vacate_body(solver.bodies.len() - 1);
                    *entity = Entity::PLACEHOLDER;
                }
            }
            let is_first_time = solver.balls.is_empty();
            for (slot, &entity) in ball_entities.iter().enumerate() {
                if let Ok((state, _)) = balls.get(entity) {
                    if is_first_time {
                        solver.balls.push(state.0.clone());
                    } else {
                        solver.balls[slot].clone_from(&state.0);
                    }
                }
            }
        }
    }

    /// Moves all bodies and balls back into their components.
    pub fn give_back(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        for island in self.live_mut() {
            let mut extents = island.extents.drain(..);
            for (&entity, body) in island.bodies.iter().zip(island.solver.bodies.drain(..)) {
                let extent = extents.next();
                if let Ok((mut particles, _, mut state)) = bodies.get_mut(entity) {
                    particles.0 = body.particles;
                    state.context = body.context;
                    state.extent = extent.unwrap_or(state.extent);
                }
            }
            for (&entity, ball) in island.balls.iter().zip(&island.solver.balls) {
                if let Ok((mut state, _)) = balls.get_mut(entity) {
                    state.0.clone_from(ball);
                }
            }
        }
    }

    /// Runs `stage` on every island, on all threads of the compute pool.
    pub fn each(&mut self, stage: impl Fn(&mut Island) + Send + Sync) {
        let islands = self.live_mut();
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let threads = pool.thread_num();
        if threads < 2 || islands.len() < 2 {
            islands.iter_mut().for_each(stage);
            return;
        }
        let share = islands.len().div_ceil(threads * 4);
        pool.scope(|scope| {
            for chunk in islands.chunks_mut(share) {
                let stage = &stage;
                scope.spawn(async move { chunk.iter_mut().for_each(stage) });
            }
        });
    }

    /// Groups the members whose boxes meet in this step: islands in order of their oldest member.
    pub fn form(&mut self) {
        self.members.sort_unstable_by_key(|member| member.order);
        let count = self.members.len();
        self.parents.clear();
        self.parents.extend(0..count);
        for (b, ball) in self.members.iter().enumerate().filter(|(_, member)| member.is_ball) {
            for (other, member) in self.members.iter().enumerate() {
                if other != b && overlap(ball.bounds, member.bounds) {
                    let (p, q) = (root(&mut self.parents, b), root(&mut self.parents, other));
                    self.parents[p.max(q)] = p.min(q);
                }
            }
        }
        self.live = 0;
        self.slot_of.clear();
        for i in 0..count {
            // The root of an island is its oldest member, so it has its slot before the others ask for it.
            let root = root(&mut self.parents, i);
            if root == i {
                self.open_slot();
            }
            let slot = if root == i { self.live - 1 } else { self.slot_of[root] };
            self.slot_of.push(slot);
            let (member, island) = (self.members[i], &mut self.slots[slot]);
            let list = if member.is_ball { &mut island.balls } else { &mut island.bodies };
            list.push(member.entity);
        }
    }

    fn open_slot(&mut self) {
        if self.live == self.slots.len() {
            self.slots.push(Island::default());
        }
        self.slots[self.live].reset();
        self.live += 1;
    }
}

/// Whether these particles and sticks belong together.
pub(crate) fn fits(particles: &Particles, sticks: &Sticks) -> bool {
    !particles.is_empty() && particles.len() == sticks.particle_count()
}

/// The oldest member of `i`'s group.
fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}
