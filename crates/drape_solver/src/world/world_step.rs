//! The step of a world.
//!
//! ```text
//! surroundings -> obstacles fly -> wake -> cull -> form islands -> step each -> fall asleep -> obstacles land
//! ```
//!
//! `members.rs` wakes and culls, `grouping.rs` forms the islands, `finish` here puts to sleep.

use crate::constants::CONTACT_MARGIN;
use crate::contact::event::{Other, Party};
use crate::error::StepError;
use crate::motion::environment::Environment;
use crate::motion::wind::WindZone;
use crate::parallel::for_each::for_each;
use crate::parallel::threads::{Alone, Threads};
use crate::world::activity::Activity;
use crate::world::bounds::Bounds;
use crate::world::events::{BallTouch, Events, Fault, ObstacleReaction, ReportedContact};
use crate::world::grouping::Member;
use crate::world::id::{BallId, BodyId, MemberId, WorldId};
use crate::world::interface::World;
use crate::world::kind::Kind;
use crate::world::members::Members;
use crate::world::obstacle_list::ObstacleList;
use crate::world::staged_island::{StagedIsland, StepStage};

/// Begins the order of obstacles, which come after all bodies and balls.
const OBSTACLES: u64 = 1 << 63;

/// An island of a step, with the names of its members.
#[derive(Clone, Debug, Default)]
pub(super) struct WorldIsland {
    staged: StagedIsland,
    bodies: Vec<BodyId>,
    balls: Vec<BallId>,
}

impl World {
    /// Advances the world by [`dt`](Self::dt) seconds on this thread.
    ///
    /// A body or ball that cannot be stepped is left out and named in [`Events::faults`]; the others go on without it.
    ///
    /// # Errors
    /// [`StepError`] if the time step, gravity or wind is invalid: nothing has moved then.
    pub fn step(&mut self) -> Result<(), StepError> {
        self.step_on(&Alone)
    }

    /// The same on several threads, to the same bits: islands are shared out, and if there is only one, its large bodies.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_on(&mut self, threads: &dyn Threads) -> Result<(), StepError> {
        let surroundings_changed = self.read_surroundings()?;
        let pace = self.pace();
        let Self { environment, members, obstacles, events, .. } = self;
        events.clear();
        obstacles.begin_step(
            &mut environment.obstacles,
            environment.gravity,
            environment.dt,
            &mut members.waking,
        );
        members.wake(surroundings_changed, pace, &mut events.woken);
        let is_new_view = self.rules != self.known_rules || self.viewers != self.known_viewers;
        members.cull(&self.rules, &self.viewers, is_new_view, pace);
        if is_new_view {
            self.known_rules = self.rules;
            self.known_viewers.clone_from(&self.viewers);
        }
        self.form_islands();
        self.run_islands(threads)?;
        self.finish();
        Ok(())
    }

    /// Brings time step, gravity and wind into the environment; true if what acts on bodies at rest has changed, or always
    /// changes.
    fn read_surroundings(&mut self) -> Result<bool, StepError> {
        if !(self.dt > 0.0 && self.dt.is_finite()) {
            return Err(StepError::BadTimestep(self.dt));
        }
        if !self.gravity.is_finite() {
            return Err(StepError::BadEnvironment("gravity"));
        }
        self.wind.validate()?;
        self.wind_zones.iter().try_for_each(WindZone::validate)?;
        let environment = &mut self.environment;
        let has_changed = environment.gravity != self.gravity
            || environment.wind != self.wind
            || environment.wind_zones != self.wind_zones
            || self.wind.turbulence.speed > 0.0;
        environment.dt = self.dt;
        environment.gravity = self.gravity;
        environment.wind = self.wind;
        environment.wind_zones.clone_from(&self.wind_zones);
        Ok(has_changed)
    }

    /// Groups all active bodies and balls into the islands of this step.
    fn form_islands(&mut self) {
        let pace = self.pace();
        let Self { environment, members, obstacles, events, grouping, islands, .. } = self;
        members.refuse_wrong_particles(&mut events.faults);
        grouping.clear();
        for id in members.active() {
            if let (Some(state), Some(proxy)) = (members.state(id), members.moving_proxy(id, pace)) {
                let (order, key) = (state.order, id.into());
                grouping.push(Member { order, key, kind: proxy.kind, bounds: proxy.bounds });
            }
        }
        for (place, index) in obstacles.flying().enumerate() {
            let bounds = Bounds::from(environment.obstacles[index].swept_bounds()).grown(CONTACT_MARGIN);
            let (order, key) = (OBSTACLES + place as u64, obstacles.id(index).into());
            grouping.push(Member { order, key, kind: Kind::Obstacle, bounds });
        }
        islands.iter_mut().for_each(WorldIsland::reset);
        self.island_count = grouping.form(|number, member| {
            if number == islands.len() {
                islands.push(WorldIsland::default());
            }
            match member.key {
                WorldId::Body(id) => islands[number].bodies.push(id),
                WorldId::Ball(id) => islands[number].balls.push(id),
                WorldId::Obstacle(_) => {}
            }
        });
    }

    /// Takes all islands through the step: side by side if there are several, else with all threads for the bodies of one.
    fn run_islands(&mut self, threads: &dyn Threads) -> Result<(), StepError> {
        let Self { environment, members, islands, island_count, events, .. } = self;
        let islands = &mut islands[..*island_count];
        let mut outcome = Ok(());
        if islands.len() < 2 || threads.count() < 2 {
            for island in islands {
                island.take(members);
                island.staged.advance(environment, StepStage::Done, threads);
                outcome = outcome.and(island.go_on_without_faulty(environment, members, events, threads));
                island.give_back(members);
            }
        } else {
            islands.iter_mut().for_each(|island| island.take(members));
            for_each(islands, threads, &|island: &mut WorldIsland| {
                island.staged.advance(environment, StepStage::Done, &Alone);
            });
            for island in islands {
                outcome = outcome.and(island.go_on_without_faulty(environment, members, events, threads));
                island.give_back(members);
            }
        }
        outcome
    }

    /// Ends the step: events, sleep, obstacles.
    fn finish(&mut self) {
        let pace = self.pace();
        let Self { environment, members, obstacles, events, rules, .. } = self;
        let islands = &self.islands[..self.island_count];
        for island in islands {
            island.tell(obstacles, events);
            if rules.falls_asleep(island.staged.still_for) {
                for id in island.members() {
                    members.set_activity(id, Activity::Resting, pace);
                    events.slept.push(id);
                }
            }
        }
        let moved = islands.iter().flat_map(|island| &island.staged.island.moved);
        obstacles.end_step(&mut environment.obstacles, moved);
        members.tidy();
        environment.time += f64::from(environment.dt);
    }
}

impl WorldIsland {
    /// Makes it an island without members, keeping the memory.
    fn reset(&mut self) {
        self.staged.reset();
        self.bodies.clear();
        self.balls.clear();
    }

    fn members(&self) -> impl Iterator<Item = MemberId> + '_ {
        let bodies = self.bodies.iter().copied().map(MemberId::Body);
        bodies.chain(self.balls.iter().copied().map(MemberId::Ball))
    }

    /// Moves its bodies and balls here from the lists of the world.
    fn take(&mut self, members: &mut Members) {
        let island = &mut self.staged.island;
        for (body, scratch) in self.bodies.iter().filter_map(|&id| members.take_body(id)) {
            island.push_body(body, scratch);
        }
        island.balls.extend(self.balls.iter().filter_map(|id| Some(members.balls.get(id.0)?.ball.clone())));
    }

    /// Moves them back.
    fn give_back(&mut self, members: &mut Members) {
        let island = &mut self.staged.island;
        let mut extents = self.staged.extents.iter();
        for (&id, (body, scratch)) in self.bodies.iter().zip(island.drain_bodies()) {
            members.put_body(id, body, scratch, extents.next().copied());
        }
        for (id, ball) in self.balls.iter().zip(island.balls.drain(..)) {
            if let Some(entry) = members.balls.get_mut(id.0) {
                entry.ball = ball;
            }
        }
    }

    /// Leaves out what cannot be stepped, and takes the others through the step.
    ///
    /// # Errors
    /// [`StepError`] if it names neither a body nor a ball.
    fn go_on_without_faulty(
        &mut self,
        environment: &Environment,
        members: &mut Members,
        events: &mut Events,
        threads: &dyn Threads,
    ) -> Result<(), StepError> {
        while let Some(error) = self.staged.error.take() {
            let fault = match error {
                StepError::NonFiniteBody(index) => Fault::NonFiniteBody(self.leave_body_out(index, members)),
                StepError::BadSettings { body: index, source } => {
                    Fault::BadSettings { body: self.leave_body_out(index, members), source }
                }
                StepError::NonFiniteBall(index) => Fault::NonFiniteBall(self.leave_ball_out(index, members)),
                other => return Err(other),
            };
            members.refuse(fault.member());
            events.faults.push(fault);
            self.staged.advance(environment, StepStage::Done, threads);
        }
        Ok(())
    }

    fn leave_body_out(&mut self, index: usize, members: &mut Members) -> BodyId {
        let id = self.bodies.remove(index);
        let (body, scratch) = self.staged.leave_body_out(index);
        members.put_body(id, body, scratch, None);
        id
    }

    fn leave_ball_out(&mut self, index: usize, members: &mut Members) -> BallId {
        let (id, ball) = (self.balls.remove(index), self.staged.leave_ball_out(index));
        if let Some(entry) = members.balls.get_mut(id.0) {
            entry.ball = ball;
        }
        id
    }

    /// Adds what happened in it to the events of the world.
    fn tell(&self, obstacles: &ObstacleList, events: &mut Events) {
        let island = &self.staged.island;
        let other = |other: Other| match other {
            Other::Body(i) => WorldId::Body(self.bodies[i]),
            Other::Ball(i) => WorldId::Ball(self.balls[i]),
            Other::Obstacle(i) => WorldId::Obstacle(obstacles.id(i)),
        };
        let party = |party: Party| match party {
            Party::Body(i) => MemberId::Body(self.bodies[i]),
            Party::Ball(i) => MemberId::Ball(self.balls[i]),
        };
        events.touches.extend(island.touches.iter().map(|&touch| BallTouch {
            ball: self.balls[touch.ball],
            other: other(touch.other),
            touch,
        }));
        events.contacts.extend(island.contacts.iter().map(|&contact| ReportedContact {
            party: party(contact.party),
            other: other(contact.other),
            contact,
        }));
        events.reactions.extend(
            island
                .reactions
                .iter()
                .map(|&reaction| ObstacleReaction { obstacle: obstacles.id(reaction.obstacle), reaction }),
        );
    }
}
