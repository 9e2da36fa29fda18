//! One island's run through a step: makes the solver's bodies and balls of their components, steps them, moves them back.

use core::time::Duration;
use std::sync::Arc;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use drape_solver::world::staged_island::{StagedIsland, StepStage};
use drape_solver::{Alone, Body, BodyScratch, Environment, Island, Threads};

use crate::body::layers::DrapeLayers;
use crate::step::components::{BallQuery, BodyQuery};
use crate::step::compute_threads::ComputeThreads;

/// One island: the solver's, and the entities behind its bodies and balls.
#[derive(Default)]
pub(crate) struct IslandRun {
    pub staged: StagedIsland,
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    /// Particles that limits on motion kept in obstacles; known at the end of the step.
    pub limit_conflicts: usize,
    /// Time that the search for contacts took in this step.
    pub detect_time: Duration,
    /// Time of the substeps.
    pub substep_time: Duration,
    /// True if no other island runs at the same time, so that its bodies may have all threads.
    pub is_alone: bool,
}

impl IslandRun {
    /// The solver's island.
    pub fn solver(&self) -> &Island {
        &self.staged.island
    }

    /// Makes it an empty island at the start of a step, keeping the memory.
    pub fn reset(&mut self) {
        self.staged.reset();
        self.bodies.clear();
        self.balls.clear();
        self.limit_conflicts = 0;
        self.detect_time = Duration::ZERO;
        self.substep_time = Duration::ZERO;
        self.is_alone = false;
    }

    /// Runs all remaining stages before `end`.
    pub fn advance(&mut self, environment: &Environment, end: StepStage) {
        let threads: &dyn Threads = if self.is_alone { &ComputeThreads } else { &Alone };
        while self.staged.is_before(end) {
            self.time(|staged| staged.run_towards(environment, end, threads));
        }
        if self.staged.next_stage() == StepStage::Done {
            let conflicts = self.solver().bodies.iter().map(|body| body.context.limit_conflicts());
            self.limit_conflicts = conflicts.sum();
        }
    }

    /// Runs one stage of a substep if it is next. An island with fewer substeps than others finishes before them.
    pub fn run_substep_stage(&mut self, environment: &Environment, stage: StepStage) {
        if self.staged.next_stage() == stage && self.staged.error.is_none() {
            self.time(|staged| staged.run_next(environment));
        }
    }

    /// Runs the next stage by `run`, and notes the time that it takes.
    fn time(&mut self, run: impl FnOnce(&mut StagedIsland)) {
        let (stage, start) = (self.staged.next_stage(), Instant::now());
        run(&mut self.staged);
        match stage {
            StepStage::DetectCollisions => self.detect_time = start.elapsed(),
            StepStage::Integrate | StepStage::Relax | StepStage::ProjectCollisions => {
                self.substep_time += start.elapsed();
            }
            _ => {}
        }
    }

    /// Moves the bodies and balls from their components into the island.
    pub fn take(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        let solver = &mut self.staged.island;
        solver.bodies.clear();
        for entity in &mut self.bodies {
            let (body, scratch) = match bodies.get_mut(*entity) {
                Ok((mut particles, sticks, mut state, reports_contacts, pressure))
                    if sticks.fit(&particles) =>
                {
                    let scratch = core::mem::take(&mut state.scratch);
                    let body = Body {
                        particles: core::mem::take(&mut particles.bypass_change_detection().0),
                        topology: Arc::clone(&sticks.0),
                        settings: state.settings,
                        layers: state.layers,
                        reports_contacts,
                        pressure: pressure.map_or(0.0, |pressure| pressure.0),
                        context: core::mem::take(&mut state.context),
                    };
                    (body, scratch)
                }
                _ => (Body::default(), BodyScratch::default()),
            };
            let is_gone = body.particles.is_empty();
            solver.push_body(body, scratch);
            if is_gone {
                // A user system removed the body within the step.
                solver.vacate_body(solver.bodies.len() - 1);
                *entity = Entity::PLACEHOLDER;
            }
        }
        let is_first_time = solver.balls.is_empty();
        for (slot, &entity) in self.balls.iter().enumerate() {
            if let Ok((state, _, layers, reports_contacts)) = balls.get(entity) {
                if is_first_time {
                    solver.balls.push(state.0.clone());
                } else {
                    solver.balls[slot].clone_from(&state.0);
                }
                solver.balls[slot].set_layers(DrapeLayers::of(layers));
                solver.balls[slot].set_reports_contacts(reports_contacts);
            }
        }
    }

    /// Moves the bodies and balls back into their components.
    pub fn give_back(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        let StagedIsland { island, extents, .. } = &mut self.staged;
        let mut extents = extents.drain(..);
        for (&entity, (body, scratch)) in self.bodies.iter().zip(island.drain_bodies()) {
            let extent = extents.next();
            if let Ok((mut particles, _, mut state, ..)) = bodies.get_mut(entity) {
                particles.0 = body.particles;
                state.context = body.context;
                state.scratch = scratch;
                state.extent = extent.unwrap_or(state.extent);
            }
        }
        for (&entity, ball) in self.balls.iter().zip(&island.balls) {
            if let Ok((mut state, ..)) = balls.get_mut(entity) {
                state.0.clone_from(ball);
            }
        }
    }
}
