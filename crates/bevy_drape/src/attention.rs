//! What has to be looked at in a step: all but what rests or is culled and has been left alone.

use core::ops::Range;

use bevy::ecs::change_detection::ContiguousRef;
use bevy::prelude::*;

use crate::activity::Activity;
use crate::environment::SolverEnvironment;
use crate::particles::{Particles, Sticks};
use crate::projectile::ProjectileState;
use crate::scan::{collect_rows, is_any_changed};
use crate::settings::{DefaultSolverSettings, SolverSettings};

/// The bodies and balls to look at in this step. An entity may be listed twice.
#[derive(Resource, Default)]
pub(crate) struct Attention {
    pub bodies: Vec<Entity>,
    pub balls: Vec<Entity>,
    /// What has lost its own settings since the last step.
    lost_settings: Vec<Entity>,
}

/// Lists what is active and what was changed since the last step; all there is, if what concerns all has changed.
pub(crate) fn pay_attention(
    bodies: Query<(Entity, Ref<Activity>, Ref<Particles>, Ref<Sticks>, Option<Ref<SolverSettings>>)>,
    balls: Query<(Entity, Ref<Activity>, Ref<ProjectileState>), Without<Particles>>,
    defaults: Res<DefaultSolverSettings>,
    solver: Res<SolverEnvironment>,
    mut attention: ResMut<Attention>,
) {
    let Attention { bodies: bodies_seen, balls: balls_seen, lost_settings } = &mut *attention;
    let is_all_concerned = defaults.is_changed() || solver.changed;
    bodies_seen.clear();
    for (entities, activities, particles, sticks, settings) in bodies.contiguous_iter().into_iter().flatten()
    {
        let (activities, activity_ticks) = ContiguousRef::split(activities);
        let (_, particle_ticks) = ContiguousRef::split(particles);
        let (_, stick_ticks) = ContiguousRef::split(sticks);
        let setting_ticks = settings.map(|settings| ContiguousRef::split(settings).1);
        let is_any = |rows: Range<usize>| {
            is_all_concerned
                || Activity::is_any_active(&activities[rows.clone()])
                || is_any_changed(&activity_ticks, rows.clone())
                || is_any_changed(&particle_ticks, rows.clone())
                || is_any_changed(&stick_ticks, rows.clone())
                || setting_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows))
        };
        collect_rows(entities, is_any, bodies_seen);
    }
    bodies_seen.append(lost_settings);
    balls_seen.clear();
    for (entities, activities, states) in balls.contiguous_iter().into_iter().flatten() {
        let (activities, activity_ticks) = ContiguousRef::split(activities);
        let (_, state_ticks) = ContiguousRef::split(states);
        let is_any = |rows: Range<usize>| {
            is_all_concerned
                || Activity::is_any_active(&activities[rows.clone()])
                || is_any_changed(&activity_ticks, rows.clone())
                || is_any_changed(&state_ticks, rows)
        };
        collect_rows(entities, is_any, balls_seen);
    }
}

/// Notes a body that has no settings of its own any more.
pub(crate) fn note_lost_settings(lost: On<Remove, SolverSettings>, mut attention: ResMut<Attention>) {
    attention.lost_settings.push(lost.entity);
}
