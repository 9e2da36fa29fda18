//! Wakes resting bodies and balls.
//!
//! A body wakes by itself (an edit, a force, changed settings or layers, changed gravity or wind, gusts), by something
//! active whose box reaches it, or by a [wake region](crate::environment::wake_regions): an obstacle that moved, appeared
//! or vanished there. [`drape_solver::world::waking`] has the rule.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::Layers;
use drape_solver::world::extent::Extent;
use drape_solver::world::kind::Kind;
use drape_solver::world::resting_tree::Key;
use drape_solver::world::waking::{Proxy, Waking, is_roused};

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::body_state::{BodyState, CreationOrder};
use crate::body::defaults::{Defaults, Described};
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks};
use crate::clock::DrapeClock;
use crate::detail::level::CurrentDetail;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::sleep::candidates::Candidates;

/// The entity of a body or ball, as the key of what rests.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct EntityKey(pub Entity);

impl Key for EntityKey {
    fn index(self) -> usize {
        self.0.index_u32() as usize
    }
}

/// Sources of waking in this step, and everything that rests.
#[derive(Default)]
pub(crate) struct WakeSearch {
    waking: Waking<EntityKey>,
    woken: Vec<EntityKey>,
}

/// Bodies and balls that may wake, and the data for their motion in this step.
#[derive(SystemParam)]
pub(crate) struct WakeTargets<'w, 's> {
    bodies: Query<
        'w,
        's,
        (
            &'static mut Activity,
            &'static mut Particles,
            Ref<'static, Sticks>,
            &'static mut BodyState,
            Described,
            Option<&'static DrapeLayers>,
            Option<&'static CurrentDetail>,
        ),
    >,
    balls: Query<
        'w,
        's,
        (
            &'static mut Activity,
            &'static mut ProjectileState,
            &'static mut ProjectileRecord,
            Option<&'static DrapeLayers>,
        ),
        Without<Particles>,
    >,
    solver: Res<'w, SolverEnvironment>,
    clock: Res<'w, DrapeClock>,
}

impl WakeTargets<'_, '_> {
    /// Returns the length of the step in seconds and the magnitude of gravity in m/s^2.
    fn step_and_gravity(&self) -> (f32, f32) {
        (self.clock.delta(), self.solver.environment.gravity.length())
    }

    /// Box, layers and kind of what rests; none if it is gone or does not rest.
    fn sleeper(&self, EntityKey(entity): EntityKey) -> Option<Proxy> {
        let (dt, gravity) = self.step_and_gravity();
        let (activity, proxy) = if let Ok((activity, ball, ..)) = self.balls.get(entity) {
            let bounds = ball.bounds_within_step(dt, gravity);
            (activity, Proxy { bounds, layers: ball.layers(), kind: Kind::Ball })
        } else {
            let (activity, _, _, state, ..) = self.bodies.get(entity).ok()?;
            let (bounds, kind) = (state.bounds(), Kind::of_body(&state.settings));
            (activity, Proxy { bounds, layers: state.layers, kind })
        };
        (*activity == Activity::Resting).then_some(proxy)
    }

    /// Has a body or ball that rested be simulated.
    fn rouse(&mut self, EntityKey(entity): EntityKey) {
        if let Ok((mut activity, mut ball, ..)) = self.balls.get_mut(entity) {
            *activity = Activity::Active;
            ball.bypass_change_detection().rouse();
        } else if let Ok((mut activity, mut particles, ..)) = self.bodies.get_mut(entity) {
            *activity = Activity::Active;
            particles.bypass_change_detection().rouse();
        }
    }
}

impl WakeSearch {
    /// Wakes the balls that were pushed or edited, and notes what is active and what rests.
    fn update_balls(&mut self, candidates: &[Entity], targets: &mut WakeTargets) {
        let (dt, gravity) = targets.step_and_gravity();
        let WakeTargets { balls, solver, .. } = targets;
        for &entity in candidates {
            let Ok((mut activity, mut ball, mut record, layers)) = balls.get_mut(entity) else { continue };
            // An edit gives a refused ball another chance.
            let mended = record.refused && ball.is_changed();
            let bounds = ball.bounds_within_step(dt, gravity);
            let is_elsewhere = ball.layers() != DrapeLayers::of(layers);
            if is_roused((*activity).into(), ball.is_disturbed() || is_elsewhere || solver.changed, mended) {
                record.refused = false;
                *activity = Activity::Active;
                ball.bypass_change_detection().rouse();
            }
            if *activity == Activity::Active {
                let layers = DrapeLayers::of(layers);
                self.waking.disturb(Proxy { bounds, layers, kind: Kind::Ball });
            }
            if *activity == Activity::Resting {
                self.waking.rest_ball(EntityKey(entity), bounds);
            } else {
                self.waking.remove_ball(EntityKey(entity));
            }
        }
    }

    /// Wakes bodies that were pushed, edited or given other settings, and sorts all candidates into sources and resting
    /// bodies.
    fn update_bodies(
        &mut self,
        candidates: &[Entity],
        targets: &mut WakeTargets,
        defaults: &Defaults,
        order: &mut CreationOrder,
    ) {
        let (dt, gravity) = targets.step_and_gravity();
        let WakeTargets { bodies, solver, .. } = targets;
        for &entity in candidates {
            let Ok((mut activity, mut particles, sticks, mut state, described, layers, detail)) =
                bodies.get_mut(entity)
            else {
                continue;
            };
            let state = &mut *state;
            let settings = defaults.of_body(described);
            let settings = detail.map_or(settings, |detail| detail.limit(settings));
            let edited = particles.is_disturbed();
            if state.order == 0 {
                // A body that was not built by the plugin.
                state.order = order.next();
                state.extent = Extent::of(&particles, &sticks);
            } else if edited && particles.is_changed() {
                if *activity == Activity::Resting {
                    let (bounds, kind) = (state.bounds(), Kind::of_body(&state.settings));
                    self.waking.disturb(Proxy { bounds, layers: Layers::ALL, kind });
                }
                state.extent = Extent::of(&particles, &sticks);
            }
            let layers = DrapeLayers::of(layers);
            let rearranged = state.layers != layers
                || !state.settings.has_same_bits(&settings)
                || (sticks.is_changed() && !sticks.is_added());
            state.settings = settings;
            state.layers = layers;
            let mended = state.refused && (rearranged || particles.is_changed());
            if is_roused((*activity).into(), edited || rearranged || solver.changed, mended) {
                state.refused = false;
                *activity = Activity::Active;
                particles.bypass_change_detection().rouse();
            }
            if *activity == Activity::Active {
                let bounds = state.bounds_within_step(dt, gravity);
                self.waking.disturb(Proxy { bounds, layers, kind: Kind::of_body(&state.settings) });
            }
            if *activity == Activity::Resting {
                self.waking.rest_body(EntityKey(entity), state.bounds());
            } else {
                self.waking.remove_body(EntityKey(entity));
            }
        }
    }

    /// Wakes what rests where something is active, and what rests where that can get, until nothing is found.
    fn spread(&mut self, targets: &mut WakeTargets) {
        self.waking.wake(|key| targets.sleeper(key), &mut self.woken);
        self.woken.drain(..).for_each(|key| targets.rouse(key));
    }
}

/// Wakes everything that was pushed, edited, or may be touched in this step. What wakes may wake others.
pub(crate) fn wake(
    mut targets: WakeTargets,
    mut candidates: ResMut<Candidates>,
    defaults: Defaults,
    wake_regions: Res<WakeRegions>,
    mut order: ResMut<CreationOrder>,
    mut search: Local<WakeSearch>,
) {
    for bounds in candidates.left.drain(..) {
        search.waking.disturb(Proxy::of_space(bounds, Layers::ALL));
    }
    wake_regions.0.iter().for_each(|&region| search.waking.disturb(region));
    search.update_balls(&candidates.balls, &mut targets);
    search.update_bodies(&candidates.bodies, &mut targets, &defaults, &mut order);
    search.spread(&mut targets);
}
