//! The founding experiment without an engine: a curtain, the ground, and shots, run stage by stage so that an observer
//! sees the states in between.

use drape_solver::glam::Vec3;
use drape_solver::step::{
    accumulate_forces, begin, detect_collisions, finish, integrate, project_collisions, relax,
};
use drape_solver::{
    Ball, BallMaterial, BodySettings, ClothBuilder, Edge, Environment, Island, Obstacle, StepError,
};

use crate::collision::State;
use crate::failure::Failure;

/// Seconds of stillness after which a ball is removed: as long as a scene manager waits to let it sleep.
const STILL: f32 = 1.0;

/// One shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Time in seconds.
    pub time: f64,
    /// Position of the muzzle in metres.
    pub muzzle: Vec3,
    /// Velocity in m/s.
    pub velocity: Vec3,
}

/// A curtain, and shots at it.
#[derive(Clone, Debug)]
pub struct Bombardment {
    /// Width and height of the curtain in metres; it hangs in the plane z = 0, pinned along its top.
    pub size: [f32; 2],
    /// Height of its lower edge above the ground in metres.
    pub clearance: f32,
    /// Particles in a row and in a column.
    pub particles: [u32; 2],
    /// Solver settings of the curtain.
    pub settings: BodySettings,
    /// Material of the balls.
    pub ball: BallMaterial,
    /// The shots, in order of time.
    pub shots: Vec<Shot>,
    /// Length of a step in seconds.
    pub step: f32,
    /// Gravity in m/s^2.
    pub gravity: Vec3,
    /// Duration after the last shot in seconds.
    pub rest: f64,
}

/// Observes the states of a bombardment.
pub trait Observer {
    /// Called at the start of a step, before collision detection. `shot` is the number of the last one fired.
    fn begin_step(&mut self, shot: usize, state: &mut State);
    /// Called in a substep, after free flight and before projections.
    fn substep(&mut self, shot: usize, state: &mut State);
}

impl Bombardment {
    /// The curtain before the first shot.
    fn state(&self) -> Result<State, Failure> {
        let [width, height] = self.size;
        let [columns, rows] = self.particles;
        let corner = Vec3::new(-0.5 * width, self.clearance + height, 0.0);
        let curtain = ClothBuilder::new(width, height, columns, rows)
            .placed(corner, Vec3::X, Vec3::NEG_Y)
            .pin_edge(Edge::Top)
            .build(self.settings)?;
        Ok(State::new(Island::of_body(curtain), self.step, self.gravity))
    }

    /// Runs the bombardment. `on_step` gets the time in seconds.
    ///
    /// # Errors
    /// [`Failure`] if the solver refuses the scene or a step.
    pub fn run(&self, observer: &mut impl Observer, mut on_step: impl FnMut(f64)) -> Result<(), Failure> {
        let mut state = self.state()?;
        let obstacles = vec![Obstacle::ground()];
        let environment = Environment { obstacles: obstacles.into(), ..state.environment.clone() };
        let last = self.shots.last().map_or(0.0, |shot| shot.time);
        let (mut fired, mut steps) = (0, 0_u32);
        loop {
            let time = f64::from(steps) * f64::from(self.step);
            // Half a step of slack, as times are rounded.
            let now = time + 0.5 * f64::from(self.step);
            if now > last + self.rest {
                return Ok(());
            }
            while let Some(shot) = self.shots.get(fired).filter(|shot| shot.time <= now) {
                let substep = self.step / self.settings.substeps as f32;
                let ball = Ball::launch(self.ball, shot.muzzle, shot.velocity, self.gravity, substep)?;
                state.island.balls.push(ball);
                fired += 1;
            }
            state.island.balls.retain(|ball| ball.still_for() < STILL);
            let shot = fired.checked_sub(1);
            self.step(&mut state, &environment, shot, observer)?;
            on_step(time);
            steps += 1;
        }
    }

    fn step(
        &self,
        state: &mut State,
        environment: &Environment,
        shot: Option<usize>,
        observer: &mut impl Observer,
    ) -> Result<(), StepError> {
        begin(&mut state.island, environment)?;
        accumulate_forces(&mut state.island, environment);
        if let Some(shot) = shot {
            observer.begin_step(shot, state);
        }
        detect_collisions(&mut state.island, environment);
        for _ in 0..state.island.substeps() {
            integrate(&mut state.island, environment);
            if let Some(shot) = shot {
                observer.substep(shot, state);
            }
            relax(&mut state.island, environment);
            project_collisions(&mut state.island, environment);
        }
        finish(&mut state.island)
    }
}
