//! The bodies and balls of a world, and what they are doing: `wake` and `cull` change it, by the rules of `waking.rs` and
//! `activity_rules.rs`.

use glam::Vec3;

use crate::island::BodyScratch;
use crate::state::ball::Ball;
use crate::state::body::Body;
use crate::state::layers::Layers;
use crate::world::activity::{Activity, ActivityCounts};
use crate::world::activity_rules::ActivityRules;
use crate::world::bounds::Bounds;
use crate::world::events::Fault;
use crate::world::extent::{Extent, ball_bounds, ball_reach};
use crate::world::id::{BallId, BodyId, MemberId};
use crate::world::kind::Kind;
use crate::world::slots::Slots;
use crate::world::waking::{Proxy, Waking, is_roused};

/// Length of a step in seconds and size of gravity in m/s^2: how far things get in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace {
    pub dt: f32,
    pub gravity: f32,
}

/// Facts that a world keeps about a body or ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MemberState {
    /// Its place in the order of creation.
    pub order: u64,
    pub activity: Activity,
    /// True if it could not be simulated and has not been edited since.
    pub is_refused: bool,
    /// True if it has been edited since the last step.
    is_edited: bool,
    /// True if it is in the list of those that are active.
    is_listed: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct BodyEntry {
    pub body: Body,
    /// Kept from step to step, so that a warm step allocates nothing.
    scratch: BodyScratch,
    /// As of the last step or edit.
    pub extent: Extent,
    pub state: MemberState,
}

#[derive(Clone, Debug)]
pub(crate) struct BallEntry {
    pub ball: Ball,
    pub state: MemberState,
}

/// All bodies and balls.
#[derive(Clone, Default)]
pub(crate) struct Members {
    pub bodies: Slots<BodyEntry>,
    pub balls: Slots<BallEntry>,
    pub waking: Waking<MemberId>,
    /// All that are active, and some that were until now.
    active: Vec<MemberId>,
    /// Those that were added or edited since the last step.
    edited: Vec<MemberId>,
    /// Scratch: those that are looked at, and those that wake.
    seen: Vec<MemberId>,
    /// Empty bodies that lie where those are missing that are stepped: to make one takes memory.
    spares: Vec<Body>,
    last_order: u64,
}

impl Members {
    pub fn add_body(&mut self, body: Body) -> BodyId {
        let state = self.new_state();
        let id = BodyId(self.bodies.insert(BodyEntry {
            body,
            scratch: BodyScratch::default(),
            extent: Extent::default(),
            state,
        }));
        self.list_new(id.into());
        id
    }

    pub fn add_ball(&mut self, ball: Ball) -> BallId {
        let state = self.new_state();
        let id = BallId(self.balls.insert(BallEntry { ball, state }));
        self.list_new(id.into());
        id
    }

    fn new_state(&mut self) -> MemberState {
        self.last_order += 1;
        let (order, activity) = (self.last_order, Activity::Active);
        MemberState { order, activity, is_refused: false, is_edited: true, is_listed: true }
    }

    fn list_new(&mut self, id: MemberId) {
        self.active.push(id);
        self.edited.push(id);
    }

    /// Takes a body out; what touched it wakes.
    pub fn remove_body(&mut self, id: BodyId) -> Option<Body> {
        self.leave(id.into());
        self.waking.remove_body(id.into());
        self.bodies.remove(id.0).map(|entry| entry.body)
    }

    /// Takes a ball out; what touched it wakes.
    pub fn remove_ball(&mut self, id: BallId) -> Option<Ball> {
        self.leave(id.into());
        self.waking.remove_ball(id.into());
        self.balls.remove(id.0).map(|entry| entry.ball)
    }

    /// Takes a body out for a step, until it is [put back](Self::put_body).
    pub fn take_body(&mut self, id: BodyId) -> Option<(Body, BodyScratch)> {
        let entry = self.bodies.get_mut(id.0)?;
        let spare = self.spares.pop().unwrap_or_default();
        Some((core::mem::replace(&mut entry.body, spare), core::mem::take(&mut entry.scratch)))
    }

    /// Puts a body back after a step that has brought it to `extent`, if it got that far.
    pub fn put_body(&mut self, id: BodyId, body: Body, scratch: BodyScratch, extent: Option<Extent>) {
        let Some(entry) = self.bodies.get_mut(id.0) else { return };
        entry.scratch = scratch;
        self.spares.push(core::mem::replace(&mut entry.body, body));
        entry.extent = extent.unwrap_or(entry.extent);
    }

    /// Has all that touches a body or ball wake in the coming step.
    fn leave(&mut self, id: MemberId) {
        if let Some(proxy) = self.resting_proxy(id, Pace::default()) {
            self.waking.disturb(Proxy::of_space(proxy.bounds, Layers::ALL));
        }
    }

    /// Notes that a body or ball is going to be edited. What rests on it wakes, as it may go anywhere.
    pub fn note_edit(&mut self, id: MemberId) {
        let Some(state) = self.state_mut(id) else { return };
        if state.is_edited {
            return;
        }
        state.is_edited = true;
        if state.activity == Activity::Resting {
            self.leave(id);
        }
        self.edited.push(id);
    }

    pub fn state(&self, id: MemberId) -> Option<&MemberState> {
        match id {
            MemberId::Body(id) => self.bodies.get(id.0).map(|entry| &entry.state),
            MemberId::Ball(id) => self.balls.get(id.0).map(|entry| &entry.state),
        }
    }

    fn state_mut(&mut self, id: MemberId) -> Option<&mut MemberState> {
        match id {
            MemberId::Body(id) => self.bodies.get_mut(id.0).map(|entry| &mut entry.state),
            MemberId::Ball(id) => self.balls.get_mut(id.0).map(|entry| &mut entry.state),
        }
    }

    /// All that are active, in no particular order.
    pub fn active(&self) -> impl Iterator<Item = MemberId> + '_ {
        let is_active = |id: &MemberId| self.state(*id).is_some_and(|s| s.activity == Activity::Active);
        self.active.iter().copied().filter(is_active)
    }

    pub fn counts(&self) -> ActivityCounts {
        let bodies = self.bodies.iter().map(|(_, entry)| entry.state.activity);
        let balls = self.balls.iter().map(|(_, entry)| entry.state.activity);
        let mut counts = ActivityCounts::default();
        bodies.chain(balls).for_each(|activity| counts.add(activity));
        counts
    }

    fn resting_proxy(&self, id: MemberId, pace: Pace) -> Option<Proxy> {
        resting_proxy(&self.bodies, &self.balls, id, pace)
    }

    /// Box, layers and kind of a body or ball, with the box that it can get to in the coming step.
    pub fn moving_proxy(&self, id: MemberId, pace: Pace) -> Option<Proxy> {
        match id {
            MemberId::Body(id) => self.bodies.get(id.0).map(|BodyEntry { body, extent, .. }| Proxy {
                bounds: extent.reach(&body.settings, pace.dt, pace.gravity),
                layers: body.layers,
                kind: Kind::of_body(&body.settings),
            }),
            MemberId::Ball(id) => self.balls.get(id.0).map(|entry| ball_proxy(&entry.ball, pace)),
        }
    }

    /// Leaves a body or ball out of the simulation until it is edited.
    pub fn refuse(&mut self, id: MemberId) {
        if let Some(state) = self.state_mut(id) {
            state.is_refused = true;
        }
        self.set_activity(id, Activity::Culled, Pace::default());
    }

    /// Leaves out active bodies whose particles are not those that their topology joins.
    pub fn refuse_wrong_particles(&mut self, faults: &mut Vec<Fault>) {
        for place in 0..self.active.len() {
            let MemberId::Body(id) = self.active[place] else { continue };
            let Some(BodyEntry { body, state, .. }) = self.bodies.get(id.0) else { continue };
            let (particles, joined) = (body.particles.len(), body.topology.particle_count());
            if state.activity == Activity::Active && (particles == 0 || particles != joined) {
                faults.push(Fault::WrongParticles { body: id, particles, joined });
                self.refuse(id.into());
            }
        }
    }

    /// Changes what a body or ball is doing; false if it does that already, or is gone.
    pub fn set_activity(&mut self, id: MemberId, activity: Activity, pace: Pace) -> bool {
        let Some(state) = self.state_mut(id) else { return false };
        if state.activity == activity {
            return false;
        }
        let before = core::mem::replace(&mut state.activity, activity);
        if activity == Activity::Active && !core::mem::replace(&mut state.is_listed, true) {
            self.active.push(id);
        }
        match id {
            MemberId::Body(body) if before == Activity::Resting => self.waking.remove_body(body.into()),
            MemberId::Ball(ball) if before == Activity::Resting => self.waking.remove_ball(ball.into()),
            _ => {}
        }
        if activity == Activity::Active {
            self.rouse(id);
        }
        if activity == Activity::Resting
            && let Some(proxy) = self.resting_proxy(id, pace)
        {
            match id {
                MemberId::Body(_) => self.waking.rest_body(id, proxy.bounds),
                MemberId::Ball(_) => self.waking.rest_ball(id, proxy.bounds),
            }
        }
        true
    }

    /// Starts its time at rest anew.
    fn rouse(&mut self, id: MemberId) {
        match id {
            MemberId::Body(id) => {
                if let Some(entry) = self.bodies.get_mut(id.0) {
                    entry.body.particles.rouse();
                }
            }
            MemberId::Ball(id) => {
                if let Some(entry) = self.balls.get_mut(id.0) {
                    entry.ball.rouse();
                }
            }
        }
    }

    /// Wakes what was edited, what may be touched in the coming step, and all that rests if the `surroundings_changed`:
    /// gravity or wind. Appends them to `woken`.
    pub fn wake(&mut self, surroundings_changed: bool, pace: Pace, woken: &mut Vec<MemberId>) {
        for place in 0..self.edited.len() {
            self.take_edit(self.edited[place], pace, woken);
        }
        if surroundings_changed {
            let mut seen = self.list_all();
            for id in seen.drain(..) {
                if self.state(id).is_some_and(|state| is_roused(state.activity, true, false)) {
                    self.set_activity(id, Activity::Active, pace);
                    woken.push(id);
                }
            }
            self.seen = seen;
        }
        for place in 0..self.active.len() {
            let id = self.active[place];
            if self.state(id).is_some_and(|state| state.activity == Activity::Active)
                && let Some(proxy) = self.moving_proxy(id, pace)
            {
                self.waking.disturb(proxy);
            }
        }
        let first = woken.len();
        let Self { waking, bodies, balls, .. } = self;
        waking.wake(|id| resting_proxy(bodies, balls, id, pace), woken);
        for &id in &woken[first..] {
            self.set_activity(id, Activity::Active, pace);
        }
    }

    /// Takes note of an edit, and wakes what was edited.
    fn take_edit(&mut self, id: MemberId, pace: Pace, woken: &mut Vec<MemberId>) {
        let Some(was_refused) = self.settle_edit(id) else { return };
        if self.state(id).is_some_and(|state| is_roused(state.activity, true, was_refused)) {
            self.set_activity(id, Activity::Active, pace);
            woken.push(id);
        }
    }

    /// Takes note of an edit. `None` if there was none; else true if the body or ball had been refused until then.
    fn settle_edit(&mut self, id: MemberId) -> Option<bool> {
        let state = self.state_mut(id).filter(|state| state.is_edited)?;
        state.is_edited = false;
        let was_refused = core::mem::take(&mut state.is_refused);
        if let MemberId::Body(id) = id
            && let Some(BodyEntry { body, extent, .. }) = self.bodies.get_mut(id.0)
        {
            *extent = Extent::of(&body.particles, &body.topology);
        }
        Some(was_refused)
    }

    /// Sets by hand what a body or ball is doing: an edit that came before does not wake it.
    pub fn order_activity(&mut self, id: MemberId, activity: Activity, pace: Pace) -> bool {
        self.settle_edit(id);
        self.set_activity(id, activity, pace)
    }

    /// Culls what left the play area or sleeps far from every viewer, and brings it back when it is in sight again. Looks
    /// at what is active or was edited; at all there is if `is_all`.
    pub fn cull(&mut self, rules: &ActivityRules, viewers: &[Vec3], is_all: bool, pace: Pace) {
        let mut seen = if is_all { self.list_all() } else { self.list_active_and_edited() };
        self.edited.clear();
        for id in seen.drain(..) {
            let (Some(&state), Some((bounds, still_for))) = (self.state(id), self.place_at_rest(id)) else {
                continue;
            };
            let next = rules.after_culling(state.activity, bounds, state.is_refused, still_for, viewers);
            self.set_activity(id, next, pace);
            // Edited while it was culled: it wakes in the next step.
            if next == Activity::Resting && self.is_disturbed(id) {
                self.note_edit(id);
            }
        }
        self.seen = seen;
    }

    fn is_disturbed(&self, id: MemberId) -> bool {
        match id {
            MemberId::Body(id) => {
                self.bodies.get(id.0).is_some_and(|entry| entry.body.particles.is_disturbed())
            }
            MemberId::Ball(id) => self.balls.get(id.0).is_some_and(|entry| entry.ball.is_disturbed()),
        }
    }

    /// The box of a body or ball, and how long it has been still in seconds.
    fn place_at_rest(&self, id: MemberId) -> Option<(Bounds, f32)> {
        match id {
            MemberId::Body(id) => {
                self.bodies.get(id.0).map(|entry| (entry.extent.bounds, entry.body.still_for()))
            }
            MemberId::Ball(id) => {
                self.balls.get(id.0).map(|entry| (ball_bounds(&entry.ball), entry.ball.still_for()))
            }
        }
    }

    fn list_all(&mut self) -> Vec<MemberId> {
        let mut seen = core::mem::take(&mut self.seen);
        seen.extend(self.bodies.iter().map(|(slot, _)| MemberId::Body(BodyId(slot))));
        seen.extend(self.balls.iter().map(|(slot, _)| MemberId::Ball(BallId(slot))));
        seen
    }

    fn list_active_and_edited(&mut self) -> Vec<MemberId> {
        let mut seen = core::mem::take(&mut self.seen);
        seen.extend(&self.active);
        seen.extend(&self.edited);
        seen
    }

    /// Drops those from the list of the active that are no longer.
    pub fn tidy(&mut self) {
        let mut active = core::mem::take(&mut self.active);
        active.retain(|&id| {
            let Some(state) = self.state_mut(id) else { return false };
            state.is_listed = state.activity == Activity::Active;
            state.is_listed
        });
        self.active = active;
    }
}

/// Box, layers and kind of a body or ball, with the box in which it can be touched while it rests.
fn resting_proxy(
    bodies: &Slots<BodyEntry>,
    balls: &Slots<BallEntry>,
    id: MemberId,
    pace: Pace,
) -> Option<Proxy> {
    match id {
        MemberId::Body(id) => bodies.get(id.0).map(|BodyEntry { body, extent, .. }| Proxy {
            bounds: extent.surface(&body.settings),
            layers: body.layers,
            kind: Kind::of_body(&body.settings),
        }),
        MemberId::Ball(id) => balls.get(id.0).map(|entry| ball_proxy(&entry.ball, pace)),
    }
}

fn ball_proxy(ball: &Ball, Pace { dt, gravity }: Pace) -> Proxy {
    Proxy { bounds: ball_reach(ball, dt, gravity), layers: ball.layers(), kind: Kind::Ball }
}
