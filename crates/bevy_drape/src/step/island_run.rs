//! One island's run through a step.

use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use drape_solver::{Alone, Ball, Body, BodyScratch, Environment, StepError, Threads, step};

use crate::body::body_state::Extent;
use crate::body::layers::DrapeLayers;
use crate::step::components::{BallQuery, BodyQuery};
use crate::step::compute_threads::ComputeThreads;

/// The stages of a step in order. The three stages of a substep repeat for each substep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum StepStage {
    #[default]
    Begin,
    AccumulateForces,
    DetectCollisions,
    Integrate,
    Relax,
    ProjectCollisions,
    Finish,
    /// The step is over.
    Done,
}

/// One island's run through a step: the solver's island, the entities behind its bodies and balls, and its progress.
#[derive(Default)]
pub(crate) struct IslandRun {
    pub solver: drape_solver::Island,
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    /// Time in seconds for which all of them have been slower than the threshold of rest; set at the end of the step.
    pub still_for: f32,
    /// Boxes and greatest speeds of the bodies at the end of the step; empty before.
    pub extents: Vec<Extent>,
    /// Number of particles that motion limits keep in obstacles; set at the end of the step.
    pub limit_conflicts: usize,
    /// Error of the last stage. The island stops until it is taken away.
    pub error: Option<StepError>,
    /// Time of the search for contacts in this step.
    pub detect_time: Duration,
    /// Time of the substeps.
    pub substep_time: Duration,
    /// True if no other island runs at the same time, so that its bodies may use all threads.
    pub is_alone: bool,
    /// The stage that comes next.
    next: StepStage,
    /// Substeps taken of this step.
    taken: u32,
}

impl IslandRun {
    /// Empties the island for a new step, and keeps its memory.
    pub fn reset(&mut self) {
        self.solver.clear();
        self.bodies.clear();
        self.balls.clear();
        self.extents.clear();
        self.still_for = 0.0;
        self.limit_conflicts = 0;
        self.error = None;
        self.detect_time = Duration::ZERO;
        self.substep_time = Duration::ZERO;
        self.is_alone = false;
        self.next = StepStage::Begin;
        self.taken = 0;
    }

    /// Runs all remaining stages before `end`.
    pub fn advance(&mut self, environment: &Environment, end: StepStage) {
        while self.next < end && self.error.is_none() {
            if self.next == StepStage::Integrate && end > StepStage::ProjectCollisions {
                self.run_substeps(environment);
            } else {
                self.run_next(environment);
            }
        }
    }

    /// Runs one stage of a substep if it is next. An island with fewer substeps than others finishes before them.
    pub fn run_substep_stage(&mut self, environment: &Environment, stage: StepStage) {
        if self.next == stage && self.error.is_none() {
            let start = Instant::now();
            self.run_next(environment);
            self.substep_time += start.elapsed();
        }
    }

    fn run_substeps(&mut self, environment: &Environment) {
        let start = Instant::now();
        let threads: &dyn Threads = if self.is_alone { &ComputeThreads } else { &Alone };
        step::substeps_on(&mut self.solver, environment, threads);
        self.substep_time += start.elapsed();
        self.next = StepStage::Finish;
    }

    fn run_next(&mut self, environment: &Environment) {
        let solver = &mut self.solver;
        let outcome = match self.next {
            StepStage::Begin => step::begin(solver, environment).map(|()| StepStage::AccumulateForces),
            StepStage::AccumulateForces => {
                step::accumulate_forces(solver, environment);
                Ok(StepStage::DetectCollisions)
            }
            StepStage::DetectCollisions => {
                let start = Instant::now();
                step::detect_collisions(solver, environment);
                self.detect_time = start.elapsed();
                Ok(StepStage::Integrate)
            }
            StepStage::Integrate => {
                step::integrate(solver, environment);
                Ok(StepStage::Relax)
            }
            StepStage::Relax => {
                step::relax(solver, environment);
                Ok(StepStage::ProjectCollisions)
            }
            StepStage::ProjectCollisions => {
                step::project_collisions(solver, environment);
                self.taken += 1;
                Ok(if self.taken < solver.substeps() { StepStage::Integrate } else { StepStage::Finish })
            }
            StepStage::Finish => step::finish(solver).map(|()| {
                self.extents
                    .extend(solver.bodies.iter().map(|body| Extent::of(&body.particles, &body.topology)));
                let conflicts = solver.bodies.iter().map(|body| body.context.limit_conflicts());
                self.limit_conflicts = conflicts.sum();
                let bodies = solver.bodies.iter().map(Body::still_for);
                self.still_for =
                    bodies.chain(solver.balls.iter().map(Ball::still_for)).fold(f32::INFINITY, f32::min);
                StepStage::Done
            }),
            StepStage::Done => Ok(StepStage::Done),
        };
        match outcome {
            Ok(next) => self.next = next,
            Err(error) => self.error = Some(error),
        }
    }

    /// Moves the bodies and balls from their components into the island.
    pub fn take(&mut self, bodies: &mut BodyQuery, balls: &mut BallQuery) {
        let solver = &mut self.solver;
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
        let mut extents = self.extents.drain(..);
        for (&entity, (body, scratch)) in self.bodies.iter().zip(self.solver.drain_bodies()) {
            let extent = extents.next();
            if let Ok((mut particles, _, mut state, ..)) = bodies.get_mut(entity) {
                particles.0 = body.particles;
                state.context = body.context;
                state.scratch = scratch;
                state.extent = extent.unwrap_or(state.extent);
            }
        }
        for (&entity, ball) in self.balls.iter().zip(&self.solver.balls) {
            if let Ok((mut state, ..)) = balls.get_mut(entity) {
                state.0.clone_from(ball);
            }
        }
    }
}
