//! Wakes what is at rest.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use crate::activity::Activity;
use crate::attention::Attention;
use crate::clock::DrapeClock;
use crate::environment::SolverEnvironment;
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
        ),
    >,
    balls: Query<
        'w,
        's,
        (&'static mut Activity, &'static mut ProjectileState, &'static mut ProjectileRecord),
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
    /// Wakes what was found and does rest within `space`, so that it stirs itself.
    fn wake_found(&mut self, space: Bounds, touches: Touches, may_rest: &mut MayRest) {
        let (dt, gravity) = may_rest.pace();
        for entity in self.found.drain(..) {
            if let Ok((mut activity, mut ball, _)) = may_rest.balls.get_mut(entity) {
                let bounds = ball_reach(&ball, dt, gravity);
                if *activity == Activity::Resting && overlap(space, bounds) {
                    *activity = Activity::Active;
                    ball.bypass_change_detection().rouse();
                    self.balls.remove(entity);
                    self.stirrers.push(Stirrer { bounds, touches: Touches::AllBodies });
                }
            } else if let Ok((mut activity, mut particles, _, state, _)) = may_rest.bodies.get_mut(entity) {
                let bounds = grown(state.extent.bounds, state.settings.thickness);
                let own = Touches::of_body(&state.settings);
                let is_touched = touches == Touches::AllBodies || touches == own;
                if is_touched && *activity == Activity::Resting && overlap(space, bounds) {
                    *activity = Activity::Active;
                    particles.bypass_change_detection().rouse();
                    self.bodies.remove(entity);
                    self.stirrers.push(Stirrer { bounds, touches: own });
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
    attention: Res<Attention>,
    defaults: Res<DefaultSolverSettings>,
    stirred: Res<StirredSpace>,
    mut order: ResMut<CreationOrder>,
    mut stir: Local<Stir>,
) {
    let stir = &mut *stir;
    let (dt, gravity) = may_rest.pace();
    let MayRest { bodies, balls, solver, .. } = &mut may_rest;
    let is_stirred = |bounds: Bounds| stirred.0.iter().any(|&space| overlap(space, bounds));
    stir.stirrers.clear();
    for &entity in &attention.balls {
        let Ok((mut activity, mut ball, mut record)) = balls.get_mut(entity) else { continue };
        // A ball that was refused gets another chance when somebody has edited it.
        let mended = record.refused && ball.is_changed();
        let bounds = ball_reach(&ball, dt, gravity);
        let resting = *activity == Activity::Resting;
        if mended || (resting && (ball.is_disturbed() || solver.changed || is_stirred(bounds))) {
            record.refused = false;
            *activity = Activity::Active;
            ball.bypass_change_detection().rouse();
        }
        if *activity == Activity::Active {
            stir.stirrers.push(Stirrer { bounds, touches: Touches::AllBodies });
        }
        if *activity == Activity::Resting {
            stir.balls.insert(entity, bounds);
        } else {
            stir.balls.remove(entity);
        }
    }
    for &entity in &attention.bodies {
        let Ok((mut activity, mut particles, sticks, mut state, settings)) = bodies.get_mut(entity) else {
            continue;
        };
        let state = &mut *state;
        let settings = settings.copied().unwrap_or(defaults.0).into();
        let edited = particles.is_disturbed();
        if state.order == 0 {
            // A body that was not built by the plugin.
            state.order = order.next();
            state.extent = Extent::of(&particles);
        } else if edited && particles.is_changed() {
            state.extent = Extent::of(&particles);
        }
        let rearranged =
            !same_settings(&state.settings, &settings) || (sticks.is_changed() && !sticks.is_added());
        state.settings = settings;
        let mended = state.refused && (rearranged || particles.is_changed());
        let resting = *activity == Activity::Resting;
        let bounds = grown(state.extent.bounds, settings.thickness);
        if mended || (resting && (edited || rearranged || solver.changed || is_stirred(bounds))) {
            state.refused = false;
            *activity = Activity::Active;
            particles.bypass_change_detection().rouse();
        }
        if *activity == Activity::Active {
            let touches = Touches::of_body(&state.settings);
            stir.stirrers.push(Stirrer { bounds: body_reach(state, dt, gravity), touches });
        }
        if *activity == Activity::Resting {
            stir.bodies.insert(entity, bounds);
        } else {
            stir.bodies.remove(entity);
        }
    }
    for &space in &stirred.0 {
        stir.bodies.find(space, &mut stir.found);
        stir.balls.find(space, &mut stir.found);
        stir.wake_found(space, Touches::AllBodies, &mut may_rest);
    }
    let mut next = 0;
    while let Some(&Stirrer { bounds, touches }) = stir.stirrers.get(next) {
        next += 1;
        stir.balls.find(bounds, &mut stir.found);
        if touches != Touches::NoBodies {
            stir.bodies.find(bounds, &mut stir.found);
        }
        stir.wake_found(bounds, touches, &mut may_rest);
    }
}
