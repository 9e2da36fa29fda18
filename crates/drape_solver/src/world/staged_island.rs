//! An island on its way through a step, stage by stage, so that one that cannot be stepped loses the member at fault and
//! goes on.

use crate::contact::event::Other;
use crate::error::StepError;
use crate::island::{BodyScratch, Island};
use crate::motion::environment::Environment;
use crate::parallel::threads::Threads;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::step;
use crate::world::extent::Extent;

/// The stages of a step, in their order. The three of a substep come once for each substep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum StepStage {
    /// The first of the step.
    #[default]
    Begin,
    /// Gravity, wind and forces.
    AccumulateForces,
    /// The search for contacts.
    DetectCollisions,
    /// The first of a substep.
    Integrate,
    /// The iterations of a substep.
    Relax,
    /// The last of a substep.
    ProjectCollisions,
    /// The last of the step.
    Finish,
    /// The step is over.
    Done,
}

/// An island of the solver on its way through a step.
#[derive(Clone, Debug, Default)]
pub struct StagedIsland {
    /// Bodies, balls and what happened to them.
    pub island: Island,
    /// Time in seconds that all members have been slower than the threshold of rest; known once the step is done.
    pub still_for: f32,
    /// Boxes and speeds of the bodies; known once the step is done, empty before that.
    pub extents: Vec<Extent>,
    /// Why the next stage cannot be run. Nothing goes on while there is a reason.
    pub error: Option<StepError>,
    next: StepStage,
    /// Substeps taken of this step.
    taken: u32,
}

impl StagedIsland {
    /// Makes it an empty island at the start of a step, keeping the memory.
    pub fn reset(&mut self) {
        self.island.clear();
        self.still_for = 0.0;
        self.extents.clear();
        self.error = None;
        self.next = StepStage::Begin;
        self.taken = 0;
    }

    /// The stage that comes next.
    pub fn next_stage(&self) -> StepStage {
        self.next
    }

    /// True if there is a stage to run before `end`.
    pub fn is_before(&self, end: StepStage) -> bool {
        self.next < end && self.error.is_none()
    }

    /// Runs the stages that are left before `end`, however many have been run one by one already.
    pub fn advance(&mut self, environment: &Environment, end: StepStage, threads: &dyn Threads) {
        while self.is_before(end) {
            self.run_towards(environment, end, threads);
        }
    }

    /// Runs the next stage, or all substeps that are left if `end` lies behind them.
    pub fn run_towards(&mut self, environment: &Environment, end: StepStage, threads: &dyn Threads) {
        if self.next == StepStage::Integrate && end > StepStage::ProjectCollisions {
            step::substeps_on(&mut self.island, environment, threads);
            self.next = StepStage::Finish;
        } else {
            self.run_next(environment);
        }
    }

    /// Runs the next stage.
    pub fn run_next(&mut self, environment: &Environment) {
        let island = &mut self.island;
        let outcome = match self.next {
            StepStage::Begin => step::begin(island, environment).map(|()| StepStage::AccumulateForces),
            StepStage::AccumulateForces => {
                step::accumulate_forces(island, environment);
                Ok(StepStage::DetectCollisions)
            }
            StepStage::DetectCollisions => {
                step::detect_collisions(island, environment);
                Ok(StepStage::Integrate)
            }
            StepStage::Integrate => {
                step::integrate(island, environment);
                Ok(StepStage::Relax)
            }
            StepStage::Relax => {
                step::relax(island, environment);
                Ok(StepStage::ProjectCollisions)
            }
            StepStage::ProjectCollisions => {
                step::project_collisions(island, environment);
                self.taken += 1;
                let is_last = self.taken >= island.substeps();
                Ok(if is_last { StepStage::Finish } else { StepStage::Integrate })
            }
            StepStage::Finish => step::finish(island).map(|()| {
                let bodies = island.bodies.iter();
                self.extents.extend(bodies.clone().map(|body| Extent::of(&body.particles, &body.topology)));
                let bodies = bodies.map(Body::still_for);
                let balls = island.balls.iter().map(Ball::still_for);
                self.still_for = bodies.chain(balls).fold(f32::INFINITY, f32::min);
                StepStage::Done
            }),
            StepStage::Done => Ok(StepStage::Done),
        };
        match outcome {
            Ok(next) => self.next = next,
            Err(error) => self.error = Some(error),
        }
    }

    /// Takes the body at `index` out with its scratch, and drops what was asked of it for this step; the others can go on
    /// without it.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn leave_body_out(&mut self, index: usize) -> (Body, BodyScratch) {
        let (mut body, scratch) = self.island.remove_body(index);
        body.particles.clear_requests();
        self.island.forget(Other::Body(index));
        (body, scratch)
    }

    /// The same for a ball.
    ///
    /// # Panics
    /// If there is no such ball.
    pub fn leave_ball_out(&mut self, index: usize) -> Ball {
        let mut ball = self.island.balls.remove(index);
        ball.clear_force();
        self.island.forget(Other::Ball(index));
        ball
    }
}
