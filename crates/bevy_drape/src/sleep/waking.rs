//! Wakes resting bodies and balls.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::Layers;

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::body_state::{BodyState, CreationOrder, Extent};
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks};
use crate::body::settings::{DefaultSolverSettings, SolverSettings};
use crate::bounds::{Bounds, overlap};
use crate::clock::DrapeClock;
use crate::detail::level::CurrentDetail;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::sleep::candidates::Candidates;
use crate::sleep::resting_bvh::RestingBvh;

/// A source of waking: it wakes resting bodies and balls in a box.
#[derive(Clone, Copy)]
struct WakeSource {
    bounds: Bounds,
    layers: Layers,
    touches: Touches,
}

/// Bodies that a source touches and therefore wakes. Every source touches balls.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Touches {
    NoBodies,
    BodiesWithSelfContact,
    AllBodies,
}

impl Touches {
    fn of_body(settings: &SolverSettings) -> Self {
        if settings.has_self_contact() { Self::BodiesWithSelfContact } else { Self::NoBodies }
    }
}

/// Sources of waking in this step, and everything that rests.
#[derive(Default)]
pub(crate) struct WakeSearch {
    sources: Vec<WakeSource>,
    bodies: RestingBvh,
    balls: RestingBvh,
    found: Vec<Entity>,
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
            Option<&'static SolverSettings>,
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
}

impl WakeSearch {
    /// Wakes the neighbours of a body or ball that rested here until now: they may have lain on it.
    fn wake_around(&mut self, bounds: Bounds, touches: Touches) {
        self.sources.push(WakeSource { bounds, layers: Layers::ALL, touches });
    }

    /// Wakes balls that were pushed or edited, and sorts all candidates into sources and resting balls.
    fn update_balls(&mut self, candidates: &[Entity], targets: &mut WakeTargets) {
        let (dt, gravity) = targets.step_and_gravity();
        let WakeTargets { balls, solver, .. } = targets;
        for &entity in candidates {
            let Ok((mut activity, mut ball, mut record, layers)) = balls.get_mut(entity) else { continue };
            // An edit gives a refused ball another chance.
            let mended = record.refused && ball.is_changed();
            let bounds = ball.bounds_within_step(dt, gravity);
            let resting = *activity == Activity::Resting;
            let is_elsewhere = ball.layers() != DrapeLayers::of(layers);
            if mended || (resting && (ball.is_disturbed() || is_elsewhere || solver.changed)) {
                record.refused = false;
                *activity = Activity::Active;
                ball.bypass_change_detection().rouse();
            }
            if *activity == Activity::Active {
                let layers = DrapeLayers::of(layers);
                self.sources.push(WakeSource { bounds, layers, touches: Touches::AllBodies });
            }
            if *activity == Activity::Resting {
                self.balls.insert(entity, bounds);
            } else {
                if let Some(bounds) = self.balls.remove(entity) {
                    self.wake_around(bounds, Touches::AllBodies);
                }
            }
        }
    }

    /// Wakes bodies that were pushed, edited or given other settings, and sorts all candidates into sources and resting
    /// bodies.
    fn update_bodies(
        &mut self,
        candidates: &[Entity],
        targets: &mut WakeTargets,
        defaults: SolverSettings,
        order: &mut CreationOrder,
    ) {
        let (dt, gravity) = targets.step_and_gravity();
        let WakeTargets { bodies, solver, .. } = targets;
        for &entity in candidates {
            let Ok((mut activity, mut particles, sticks, mut state, settings, layers, detail)) =
                bodies.get_mut(entity)
            else {
                continue;
            };
            let state = &mut *state;
            let settings = settings.copied().unwrap_or(defaults);
            let settings = detail.map_or(settings, |detail| detail.limit(settings));
            let edited = particles.is_disturbed();
            if state.order == 0 {
                // A body that was not built by the plugin.
                state.order = order.next();
                state.extent = Extent::of(&particles, &sticks);
            } else if edited && particles.is_changed() {
                let bounds = state.bounds();
                if *activity == Activity::Resting {
                    self.wake_around(bounds, Touches::of_body(&state.settings));
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
            let resting = *activity == Activity::Resting;
            let bounds = state.bounds();
            if mended || (resting && (edited || rearranged || solver.changed)) {
                state.refused = false;
                *activity = Activity::Active;
                particles.bypass_change_detection().rouse();
            }
            if *activity == Activity::Active {
                let touches = Touches::of_body(&state.settings);
                self.sources.push(WakeSource {
                    bounds: state.bounds_within_step(dt, gravity),
                    layers,
                    touches,
                });
            }
            if *activity == Activity::Resting {
                self.bodies.insert(entity, bounds);
            } else {
                self.bodies.remove(entity);
            }
        }
    }

    /// Wakes everything that rests near a source. What wakes becomes a source itself, until nothing more is found.
    fn spread(&mut self, wake_regions: &WakeRegions, targets: &mut WakeTargets) {
        for &(space, layers) in &wake_regions.0 {
            self.bodies.find(space, &mut self.found);
            self.balls.find(space, &mut self.found);
            self.wake_found(WakeSource { bounds: space, layers, touches: Touches::AllBodies }, targets);
        }
        let mut next = 0;
        while let Some(&who) = self.sources.get(next) {
            next += 1;
            self.balls.find(who.bounds, &mut self.found);
            if who.touches != Touches::NoBodies {
                self.bodies.find(who.bounds, &mut self.found);
            }
            self.wake_found(who, targets);
        }
    }

    /// Wakes the found entities that rest and that `who` could touch, and makes them sources.
    fn wake_found(&mut self, who: WakeSource, targets: &mut WakeTargets) {
        let WakeSource { bounds: space, layers, touches } = who;
        let (dt, gravity) = targets.step_and_gravity();
        for entity in self.found.drain(..) {
            if let Ok((mut activity, mut ball, ..)) = targets.balls.get_mut(entity) {
                let bounds = ball.bounds_within_step(dt, gravity);
                let own = ball.layers();
                if *activity == Activity::Resting && overlap(space, bounds) && layers.interact(own) {
                    *activity = Activity::Active;
                    ball.bypass_change_detection().rouse();
                    self.balls.remove(entity);
                    self.sources.push(WakeSource { bounds, layers: own, touches: Touches::AllBodies });
                }
            } else if let Ok((mut activity, mut particles, _, state, ..)) = targets.bodies.get_mut(entity) {
                let bounds = state.bounds();
                let own = Touches::of_body(&state.settings);
                let is_touched = touches == Touches::AllBodies || touches == own;
                let may_touch = is_touched && layers.interact(state.layers);
                if may_touch && *activity == Activity::Resting && overlap(space, bounds) {
                    *activity = Activity::Active;
                    particles.bypass_change_detection().rouse();
                    self.bodies.remove(entity);
                    self.sources.push(WakeSource { bounds, layers: state.layers, touches: own });
                }
            } else {
                // Despawned while it slept.
                self.balls.remove(entity);
                self.bodies.remove(entity);
            }
        }
    }
}

/// Wakes everything that was pushed, edited, or may be touched in this step. What wakes may wake others.
pub(crate) fn wake(
    mut targets: WakeTargets,
    mut candidates: ResMut<Candidates>,
    defaults: Res<DefaultSolverSettings>,
    wake_regions: Res<WakeRegions>,
    mut order: ResMut<CreationOrder>,
    mut search: Local<WakeSearch>,
) {
    search.sources.clear();
    for bounds in candidates.left.drain(..) {
        search.wake_around(bounds, Touches::AllBodies);
    }
    search.update_balls(&candidates.balls, &mut targets);
    search.update_bodies(&candidates.bodies, &mut targets, **defaults, &mut order);
    search.spread(&wake_regions, &mut targets);
}
