//! Bodies and balls to check in a step: all that are active or have been changed.

use core::ops::Range;

use bevy::ecs::change_detection::ContiguousRef;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

use crate::ball::projectile::ProjectileState;
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::body::defaults::Defaults;
use crate::body::fabric::Fabric;
use crate::body::layers::DrapeLayers;
use crate::body::particles::{Particles, Sticks};
use crate::body::settings::SolverSettings;
use crate::body::surface::BodySurface;
use crate::body::tearable::Tearable;
use crate::change_detection::{collect_rows, is_any_changed};
use crate::environment::solver_environment::SolverEnvironment;

/// The bodies and balls to check in this step. An entity may be listed twice.
#[derive(Resource, Default)]
pub(crate) struct Candidates {
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    /// Entities that lost their own settings, surface, fabric, layers or `Tearable` since the last step, or were enabled.
    lost: Vec<Entity>,
    /// Boxes of bodies and balls that vanished since the last step.
    pub left: Vec<Bounds>,
}

/// Lists active bodies and balls, and those changed since the last step; all of them if gravity, wind or
/// defaults changed.
pub(crate) fn collect_candidates(
    bodies: Query<(
        Entity,
        Ref<Activity>,
        Ref<Particles>,
        Ref<Sticks>,
        Option<Ref<SolverSettings>>,
        Option<Ref<Fabric>>,
        Option<Ref<BodySurface>>,
        Option<Ref<DrapeLayers>>,
        Option<Ref<Tearable>>,
    )>,
    balls: Query<(Entity, Ref<Activity>, Ref<ProjectileState>, Option<Ref<DrapeLayers>>), Without<Particles>>,
    defaults: Defaults,
    solver: Res<SolverEnvironment>,
    mut candidates: ResMut<Candidates>,
) {
    let Candidates { bodies: bodies_seen, balls: balls_seen, lost, .. } = &mut *candidates;
    let is_all_concerned = defaults.is_changed() || solver.changed;
    bodies_seen.clear();
    for (entities, activities, particles, sticks, settings, fabrics, surfaces, layers, tearable) in
        bodies.contiguous_iter().into_iter().flatten()
    {
        let (activities, activity_ticks) = ContiguousRef::split(activities);
        let (_, particle_ticks) = ContiguousRef::split(particles);
        let (_, stick_ticks) = ContiguousRef::split(sticks);
        let setting_ticks = settings.map(|settings| ContiguousRef::split(settings).1);
        let fabric_ticks = fabrics.map(|fabrics| ContiguousRef::split(fabrics).1);
        let surface_ticks = surfaces.map(|surfaces| ContiguousRef::split(surfaces).1);
        let tearable_ticks = tearable.map(|tearable| ContiguousRef::split(tearable).1);
        let layer_ticks = layers.map(|layers| ContiguousRef::split(layers).1);
        let is_any = |rows: Range<usize>| {
            is_all_concerned
                || Activity::is_any_active(&activities[rows.clone()])
                || is_any_changed(&activity_ticks, rows.clone())
                || is_any_changed(&particle_ticks, rows.clone())
                || is_any_changed(&stick_ticks, rows.clone())
                || fabric_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows.clone()))
                || surface_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows.clone()))
                || setting_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows.clone()))
                || tearable_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows.clone()))
                || layer_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows))
        };
        collect_rows(entities, is_any, bodies_seen);
    }
    bodies_seen.extend(&*lost);
    balls_seen.clear();
    balls_seen.append(lost);
    for (entities, activities, states, layers) in balls.contiguous_iter().into_iter().flatten() {
        let (activities, activity_ticks) = ContiguousRef::split(activities);
        let (_, state_ticks) = ContiguousRef::split(states);
        let layer_ticks = layers.map(|layers| ContiguousRef::split(layers).1);
        let is_any = |rows: Range<usize>| {
            is_all_concerned
                || Activity::is_any_active(&activities[rows.clone()])
                || is_any_changed(&activity_ticks, rows.clone())
                || is_any_changed(&state_ticks, rows.clone())
                || layer_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows))
        };
        collect_rows(entities, is_any, balls_seen);
    }
}

/// Notes the box of a vanished body.
pub(crate) fn note_gone_body(
    gone: On<Remove<Particles>>,
    states: Query<&BodyState>,
    mut candidates: ResMut<Candidates>,
) {
    let bounds = states.get(gone.entity).map(BodyState::bounds);
    candidates.left.extend(bounds);
}

/// Notes the box of a vanished ball.
pub(crate) fn note_gone_ball(
    gone: On<Remove<ProjectileState>>,
    balls: Query<&ProjectileState>,
    mut candidates: ResMut<Candidates>,
) {
    candidates.left.extend(balls.get(gone.entity).map(|ball| ball.bounds_within_step(0.0, 0.0)));
}

/// Notes an entity that lost such a component.
pub(crate) fn note_lost_component<C: Component>(lost: On<Remove<C>>, mut candidates: ResMut<Candidates>) {
    candidates.lost.push(lost.entity);
}
