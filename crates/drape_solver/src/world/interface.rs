//! A world: bodies, balls and obstacles by name.

use core::ops::Index;

use glam::Vec3;

use crate::motion::environment::Environment;
use crate::motion::wind::{Wind, WindZone};
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::obstacle::Obstacle;
use crate::world::activity::{Activity, ActivityCounts};
use crate::world::activity_rules::ActivityRules;
use crate::world::events::Events;
use crate::world::grouping::Grouping;
use crate::world::id::{BallId, BodyId, MemberId, ObstacleId, WorldId};
use crate::world::members::{Members, Pace};
use crate::world::obstacle_list::ObstacleList;
use crate::world::world_step::WorldIsland;

/// Bodies, balls and obstacles that are stepped together, without an engine.
///
/// In each [`step`](Self::step) what could touch is grouped into islands, which do not depend on each other. What comes to
/// rest falls asleep and costs nothing until something touches, pushes or edits it. A clone of a world goes on with the
/// same bits.
///
/// ```
/// use drape_solver::glam::Vec3;
/// use drape_solver::{Activity, Ball, BallMaterial, Obstacle, World};
///
/// let mut world = World::new();
/// world.add_obstacle(Obstacle::ground());
/// let ball = world.add_ball(Ball::new(BallMaterial::default(), Vec3::Y, Vec3::ZERO)?);
/// while world.activity(ball) == Some(Activity::Active) {
///     world.step()?;
/// }
/// assert!((world[ball].position().y - 0.15).abs() < 1e-3, "it sleeps on the ground");
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct World {
    /// Length of a step in seconds.
    pub dt: f32,
    /// Acceleration of gravity in m/s^2. A change wakes everything.
    pub gravity: Vec3,
    /// The wind that blows everywhere. A change wakes everything, and while there are gusts nothing falls asleep.
    pub wind: Wind,
    /// Places with a wind of their own. A change wakes everything.
    pub wind_zones: Vec<WindZone>,
    /// When bodies and balls fall asleep and are culled.
    pub rules: ActivityRules,
    /// Places of cameras, in metres: sleepers far from all of them are culled.
    pub viewers: Vec<Vec3>,
    pub(super) environment: Environment,
    pub(super) members: Members,
    pub(super) obstacles: ObstacleList,
    pub(super) events: Events,
    pub(super) grouping: Grouping<WorldId>,
    /// Islands of the last step; those beyond `island_count` are kept for their memory.
    pub(super) islands: Vec<WorldIsland>,
    pub(super) island_count: usize,
    /// Rules and viewers of the last step.
    pub(super) known_rules: ActivityRules,
    pub(super) known_viewers: Vec<Vec3>,
}

impl Default for World {
    fn default() -> Self {
        let environment = Environment::default();
        Self {
            dt: environment.dt,
            gravity: environment.gravity,
            wind: environment.wind,
            wind_zones: Vec::new(),
            rules: ActivityRules::default(),
            viewers: Vec::new(),
            environment,
            members: Members::default(),
            obstacles: ObstacleList::default(),
            events: Events::default(),
            grouping: Grouping::default(),
            islands: Vec::new(),
            island_count: 0,
            known_rules: ActivityRules::default(),
            known_viewers: Vec::new(),
        }
    }
}

impl World {
    /// An empty world with steps of 1/60 s and a gravity of 9.81 m/s^2 downwards.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a cloth, rope or rig. It is active, and wakes what it could touch in the coming step.
    pub fn add_body(&mut self, body: Body) -> BodyId {
        self.members.add_body(body)
    }

    /// Adds a ball. It is active, and wakes what it could touch in the coming step.
    pub fn add_ball(&mut self, ball: Ball) -> BallId {
        self.members.add_ball(ball)
    }

    /// Adds an obstacle, which wakes what it could touch.
    pub fn add_obstacle(&mut self, obstacle: Obstacle) -> ObstacleId {
        self.obstacles.add(&mut self.environment.obstacles, obstacle)
    }

    /// Takes a body out; what it touched wakes. `None` if it is gone.
    pub fn remove_body(&mut self, id: BodyId) -> Option<Body> {
        self.members.remove_body(id)
    }

    /// Takes a ball out; what it touched wakes. `None` if it is gone.
    pub fn remove_ball(&mut self, id: BallId) -> Option<Ball> {
        self.members.remove_ball(id)
    }

    /// Takes an obstacle out; what it touched wakes. `None` if it is gone.
    pub fn remove_obstacle(&mut self, id: ObstacleId) -> Option<Obstacle> {
        self.obstacles.remove(&mut self.environment.obstacles, id, &mut self.members.waking)
    }

    /// A body; `None` if it is gone. `world[id]` is the same for one that is known to be there.
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.members.bodies.get(id.0).map(|entry| &entry.body)
    }

    /// A ball; `None` if it is gone. `world[id]` is the same for one that is known to be there.
    pub fn ball(&self, id: BallId) -> Option<&Ball> {
        self.members.balls.get(id.0).map(|entry| &entry.ball)
    }

    /// An obstacle; `None` if it is gone. `world[id]` is the same for one that is known to be there.
    pub fn obstacle(&self, id: ObstacleId) -> Option<&Obstacle> {
        self.environment.obstacles.get(self.obstacles.index(id)?)
    }

    /// A body, to be pushed or edited: it wakes in the next step. `None` if it is gone.
    pub fn body_mut(&mut self, id: BodyId) -> Option<&mut Body> {
        self.members.note_edit(id.into());
        self.members.bodies.get_mut(id.0).map(|entry| &mut entry.body)
    }

    /// A ball, to be pushed or edited: it wakes in the next step. `None` if it is gone.
    pub fn ball_mut(&mut self, id: BallId) -> Option<&mut Ball> {
        self.members.note_edit(id.into());
        self.members.balls.get_mut(id.0).map(|entry| &mut entry.ball)
    }

    /// An obstacle, to be moved or changed: what rests where it is now or goes in the next step wakes. One that
    /// [moves](Obstacle::move_to) stands still again after that step. `None` if it is gone.
    pub fn obstacle_mut(&mut self, id: ObstacleId) -> Option<&mut Obstacle> {
        self.obstacles.edit(&mut self.environment.obstacles, id, &mut self.members.waking)
    }

    /// All bodies.
    pub fn bodies(&self) -> impl Iterator<Item = (BodyId, &Body)> + '_ {
        self.members.bodies.iter().map(|(slot, entry)| (BodyId(slot), &entry.body))
    }

    /// All balls.
    pub fn balls(&self) -> impl Iterator<Item = (BallId, &Ball)> + '_ {
        self.members.balls.iter().map(|(slot, entry)| (BallId(slot), &entry.ball))
    }

    /// All obstacles.
    pub fn obstacles(&self) -> impl Iterator<Item = (ObstacleId, &Obstacle)> + '_ {
        self.obstacles.ids().iter().copied().zip(&self.environment.obstacles)
    }

    /// Tells if a body or ball is simulated; `None` if it is gone.
    pub fn activity(&self, id: impl Into<MemberId>) -> Option<Activity> {
        self.members.state(id.into()).map(|state| state.activity)
    }

    /// Puts a body or ball to sleep, holds it still or wakes it by hand, whatever was edited before. False if it does that
    /// already, or is gone.
    pub fn set_activity(&mut self, id: impl Into<MemberId>, activity: Activity) -> bool {
        let pace = self.pace();
        self.members.order_activity(id.into(), activity, pace)
    }

    /// The number of bodies and balls in each state.
    pub fn counts(&self) -> ActivityCounts {
        self.members.counts()
    }

    /// The number of islands that the last step has stepped.
    pub fn island_count(&self) -> usize {
        self.island_count
    }

    /// Everything that happened in the last step.
    pub fn events(&self) -> &Events {
        &self.events
    }

    /// Time in seconds since the start: the sum of all steps.
    pub fn time(&self) -> f64 {
        self.environment.time
    }

    pub(super) fn pace(&self) -> Pace {
        Pace { dt: self.dt, gravity: self.gravity.length() }
    }
}

impl Index<BodyId> for World {
    type Output = Body;

    /// # Panics
    /// If the body is gone.
    fn index(&self, id: BodyId) -> &Body {
        self.body(id).expect("a body of this world")
    }
}

impl Index<BallId> for World {
    type Output = Ball;

    /// # Panics
    /// If the ball is gone.
    fn index(&self, id: BallId) -> &Ball {
        self.ball(id).expect("a ball of this world")
    }
}

impl Index<ObstacleId> for World {
    type Output = Obstacle;

    /// # Panics
    /// If the obstacle is gone.
    fn index(&self, id: ObstacleId) -> &Obstacle {
        self.obstacle(id).expect("an obstacle of this world")
    }
}
