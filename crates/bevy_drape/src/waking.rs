//! Wakes what is at rest.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::Layers;

use crate::activity::Activity;
use crate::attention::Attention;
use crate::clock::DrapeClock;
use crate::detail::CurrentDetail;
use crate::environment::SolverEnvironment;
use crate::layers::DrapeLayers;
use crate::obstacle::StirredSpace;
use crate::particles::{BodyState, CreationOrder, Extent, Particles, Sticks};
use crate::projectile::{ProjectileRecord, ProjectileState};
use crate::scene_manager::{Bounds, ball_reach, body_reach, grown, overlap};
use crate::settings::{DefaultSolverSettings, SolverSettings, same_settings};
use crate::sleepers::Sleepers;

/// Something active, and where it can get in this step: it wakes what rests there.
#[derive(Clone, Copy)]
struct Stirrer {
    bounds: Bounds,
    layers: Layers,
    touches: Touches,
}

/// Which bodies something active touches, and so wakes. All touch balls.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Touches {
    NoBodies,
    BodiesWithSelfContact,
    AllBodies,
}

impl Touches {
    fn of_body(settings: &drape_solver::SolverSettings) -> Self {
        if settings.has_self_contact() { Self::BodiesWithSelfContact } else { Self::NoBodies }
    }
}

/// What stirs in this step, and what rests.
#[derive(Default)]
pub(crate) struct Stir {
    stirrers: Vec<Stirrer>,
    bodies: Sleepers,
    balls: Sleepers,
    found: Vec<Entity>,
}

/// What may rest, and what tells how far it gets in this step.
#[derive(SystemParam)]
pub(crate) struct MayRest<'w, 's> {
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

impl MayRest<'_, '_> {
    /// Length of the step in seconds and size of gravity in m/s^2.
    fn pace(&self) -> (f32, f32) {
        (self.clock.delta(), self.solver.environment.gravity.length())
    }
}

impl Stir {
    /// Has what rests where a body or ball rested until now looked at: it may have lain on it.
    fn leave(&mut self, bounds: Bounds, touches: Touches) {
        self.stirrers.push(Stirrer { bounds, layers: Layers::ALL, touches });
    }

    /// Wakes what was found, does rest where `who` stirs and could touch it, so that it stirs itself.
    fn wake_found(&mut self, who: Stirrer, may_rest: &mut MayRest) {
        let Stirrer { bounds: space, layers, touches } = who;
        let (dt, gravity) = may_rest.pace();
        for entity in self.found.drain(..) {
            if let Ok((mut activity, mut ball, ..)) = may_rest.balls.get_mut(entity) {
                let bounds = ball_reach(&ball, dt, gravity);
                let own = ball.layers();
                if *activity == Activity::Resting && overlap(space, bounds) && layers.interact(own) {
                    *activity = Activity::Active;
                    ball.bypass_change_detection().rouse();
                    self.balls.remove(entity);
                    self.stirrers.push(Stirrer { bounds, layers: own, touches: Touches::AllBodies });
                }
            } else if let Ok((mut activity, mut particles, _, state, ..)) = may_rest.bodies.get_mut(entity) {
                let bounds = grown(state.extent.bounds, state.settings.thickness);
                let own = Touches::of_body(&state.settings);
                let is_touched = touches == Touches::AllBodies || touches == own;
                let may_touch = is_touched && layers.interact(state.layers);
                if may_touch && *activity == Activity::Resting && overlap(space, bounds) {
                    *activity = Activity::Active;
                    particles.bypass_change_detection().rouse();
                    self.bodies.remove(entity);
                    self.stirrers.push(Stirrer { bounds, layers: state.layers, touches: own });
                }
            } else {
                // It was despawned in its sleep.
                self.balls.remove(entity);
                self.bodies.remove(entity);
            }
        }
    }
}

/// Wakes what was pushed, edited, or may be touched in this step. What has just been woken may wake others.
pub(crate) fn wake(
    mut may_rest: MayRest,
    mut attention: ResMut<Attention>,
    defaults: Res<DefaultSolverSettings>,
    stirred: Res<StirredSpace>,
    mut order: ResMut<CreationOrder>,
    mut stir: Local<Stir>,
) {
    let stir = &mut *stir;
    let (dt, gravity) = may_rest.pace();
    let MayRest { bodies, balls, solver, .. } = &mut may_rest;
    stir.stirrers.clear();
    for bounds in attention.left.drain(..) {
        stir.leave(bounds, Touches::AllBodies);
    }
    for &entity in &attention.balls {
        let Ok((mut activity, mut ball, mut record, layers)) = balls.get_mut(entity) else { continue };
        // A ball that was refused gets another chance when somebody has edited it.
        let mended = record.refused && ball.is_changed();
        let bounds = ball_reach(&ball, dt, gravity);
        let resting = *activity == Activity::Resting;
        let is_elsewhere = ball.layers() != DrapeLayers::of(layers);
        if mended || (resting && (ball.is_disturbed() || is_elsewhere || solver.changed)) {
            record.refused = false;
            *activity = Activity::Active;
            ball.bypass_change_detection().rouse();
        }
        if *activity == Activity::Active {
            let layers = DrapeLayers::of(layers);
            stir.stirrers.push(Stirrer { bounds, layers, touches: Touches::AllBodies });
        }
        if *activity == Activity::Resting {
            stir.balls.insert(entity, bounds);
        } else {
            if let Some(bounds) = stir.balls.remove(entity) {
                stir.leave(bounds, Touches::AllBodies);
            }
        }
    }
    for &entity in &attention.bodies {
        let Ok((mut activity, mut particles, sticks, mut state, settings, layers, detail)) =
            bodies.get_mut(entity)
        else {
            continue;
        };
        let state = &mut *state;
        let settings = settings.copied().unwrap_or(defaults.0).into();
        let settings = detail.map_or(settings, |detail| detail.limit(settings));
        let edited = particles.is_disturbed();
        if state.order == 0 {
            // A body that was not built by the plugin.
            state.order = order.next();
            state.extent = Extent::of(&particles, &sticks);
        } else if edited && particles.is_changed() {
            let bounds = grown(state.extent.bounds, state.settings.thickness);
            if *activity == Activity::Resting {
                stir.leave(bounds, Touches::of_body(&state.settings));
            }
            state.extent = Extent::of(&particles, &sticks);
        }
        let layers = DrapeLayers::of(layers);
        let rearranged = state.layers != layers
            || !same_settings(&state.settings, &settings)
            || (sticks.is_changed() && !sticks.is_added());
        state.settings = settings;
        state.layers = layers;
        let mended = state.refused && (rearranged || particles.is_changed());
        let resting = *activity == Activity::Resting;
        let bounds = grown(state.extent.bounds, settings.thickness);
        if mended || (resting && (edited || rearranged || solver.changed)) {
            state.refused = false;
            *activity = Activity::Active;
            particles.bypass_change_detection().rouse();
        }
        if *activity == Activity::Active {
            let touches = Touches::of_body(&state.settings);
            stir.stirrers.push(Stirrer { bounds: body_reach(state, dt, gravity), layers, touches });
        }
        if *activity == Activity::Resting {
            stir.bodies.insert(entity, bounds);
        } else {
            stir.bodies.remove(entity);
        }
    }
    for &(space, layers) in &stirred.0 {
        stir.bodies.find(space, &mut stir.found);
        stir.balls.find(space, &mut stir.found);
        stir.wake_found(Stirrer { bounds: space, layers, touches: Touches::AllBodies }, &mut may_rest);
    }
    let mut next = 0;
    while let Some(&who) = stir.stirrers.get(next) {
        next += 1;
        stir.balls.find(who.bounds, &mut stir.found);
        if who.touches != Touches::NoBodies {
            stir.bodies.find(who.bounds, &mut stir.found);
        }
        stir.wake_found(who, &mut may_rest);
    }
}
