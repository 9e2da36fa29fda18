//! Culls bodies outside the play area, and sleeping ones far from every viewer.

use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

use crate::ball::projectile::{ProjectileRecord, ProjectileState};
use crate::body::activity::Activity;
use crate::body::body_state::BodyState;
use crate::sleep::candidates::Candidates;
use crate::sleep::scene_manager::SceneManager;
use crate::viewer::View;

/// Culls bodies and balls that left the play area or rest far from every viewer, and brings them back in sight.
pub(crate) fn cull(
    mut commands: Commands,
    mut bodies: Query<(&mut Activity, &BodyState)>,
    mut balls: Query<(&mut Activity, &ProjectileState, &ProjectileRecord), Without<BodyState>>,
    everything: Query<(Entity, Has<BodyState>), With<Activity>>,
    mut view: View,
    manager: Res<SceneManager>,
    mut candidates: ResMut<Candidates>,
    mut places: Local<Vec<Vec3>>,
) {
    let is_new_view = view.is_new();
    let candidates = &mut *candidates;
    if is_new_view || manager.is_changed() {
        candidates.bodies.clear();
        candidates.balls.clear();
        for (entity, is_body) in &everything {
            if is_body {
                candidates.bodies.push(entity);
            } else {
                candidates.balls.push(entity);
            }
        }
    }
    places.clear();
    places.extend(view.places());
    let rules = manager.rules();
    let next = |activity: Activity, bounds: Bounds, refused: bool, still_for: f32| -> Activity {
        rules.after_culling(activity.into(), bounds, refused, still_for, &places).into()
    };
    for &body in &candidates.bodies {
        let Ok((mut activity, state)) = bodies.get_mut(body) else { continue };
        let next = next(*activity, state.extent.bounds, state.refused, state.context.still_for());
        activity.set_if_neq(next);
    }
    for &ball in &candidates.balls {
        let Ok((mut activity, state, record)) = balls.get_mut(ball) else { continue };
        let bounds = state.bounds();
        if manager.despawn_lost_balls && !record.refused && rules.is_lost(bounds) {
            commands.entity(ball).despawn();
        } else {
            let next = next(*activity, bounds, record.refused, state.still_for());
            activity.set_if_neq(next);
        }
    }
}
