//! Brings obstacles into the solver.

use core::ops::Range;

use bevy::ecs::change_detection::ContiguousRef;
use bevy::prelude::*;
use drape_solver::Placement;

use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::change_detection::{collect_rows, is_any_changed};
use crate::clock::DrapeClock;
use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction};
use crate::environment::obstacle::{Obstacle, TeleportObstacle, built};
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::refusal::Refusals;

/// Brings obstacles into the solver: new ones, changed ones, moved ones; and takes out those that are gone. Looks at
/// none that has been left alone.
pub(crate) fn sync_obstacles(
    obstacles: Query<(
        Entity,
        Ref<Obstacle>,
        Ref<GlobalTransform>,
        Option<Ref<DrapeLayers>>,
        Has<ContactEvents>,
        Has<ObstacleReaction>,
        Has<TeleportObstacle>,
        Has<DynamicObstacle>,
    )>,
    mut commands: Commands,
    clock: Res<DrapeClock>,
    mut solver: ResMut<SolverEnvironment>,
    mut wake_regions: ResMut<WakeRegions>,
    mut changes: ResMut<ObstacleChanges>,
    mut refusals: ResMut<Refusals>,
) {
    wake_regions.0.clear();
    let SolverEnvironment { environment, obstacles: known, .. } = &mut *solver;
    let ObstacleChanges { gone, recheck, moving, seen } = &mut *changes;
    for entity in gone.drain(..).filter(|&entity| !obstacles.contains(entity)) {
        if let Some(slot) = known.slot(entity) {
            wake_regions.push(&environment.obstacles.swap_remove(slot));
            known.swap_remove(slot);
        }
    }
    seen.clear();
    for (entities, components, transforms, layers, ..) in obstacles.contiguous_iter().into_iter().flatten() {
        let (_, ticks) = ContiguousRef::split(components);
        let (_, transform_ticks) = ContiguousRef::split(transforms);
        let layer_ticks = layers.map(|layers| ContiguousRef::split(layers).1);
        let is_any = |rows: Range<usize>| {
            is_any_changed(&ticks, rows.clone())
                || is_any_changed(&transform_ticks, rows.clone())
                || layer_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows))
        };
        collect_rows(entities, is_any, seen);
    }
    // Each is looked at once: a second look would take a move for a halt.
    let is_unseen = |entity: Entity| {
        obstacles.get(entity).is_ok_and(|(_, obstacle, transform, layers, ..)| {
            let is_seen = obstacle.is_changed()
                || transform.is_changed()
                || layers.is_some_and(|layers| layers.is_changed());
            !is_seen
        })
    };
    recheck.retain(|entity| !moving.contains(entity));
    seen.extend(moving.drain(..).chain(recheck.drain(..)).filter(|&entity| is_unseen(entity)));
    for &entity in &*seen {
        let Ok((_, obstacle, transform, layers, reports, asks, is_teleport, is_dynamic)) =
            obstacles.get(entity)
        else {
            continue;
        };
        if is_teleport {
            commands.entity(entity).remove::<TeleportObstacle>();
        }
        let layers = DrapeLayers::of(layers.as_deref());
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let placement = Placement { translation, rotation };
        let slot = known.slot(entity);
        if !(placement.is_valid() && scale.is_finite()) {
            refusals.entity(
                entity,
                "Transform",
                "an obstacle's must be finite, with a scale above 0; it stays where it was",
            );
            if let Some(slot) = slot {
                let obstacle = &mut environment.obstacles[slot];
                obstacle.teleport(obstacle.placement());
            }
            continue;
        }
        let is_another = slot.is_none_or(|slot| {
            let built = &environment.obstacles[slot];
            !known.has_scale(slot, scale)
                || built.layers() != layers
                || built.reports_contacts() != reports
                || built.reports_reaction() != asks
                || built.rigid_body().is_some() && !is_dynamic
        });
        if obstacle.is_changed() || is_another {
            let built = built(&obstacle, scale, placement, layers, [reports, asks]);
            if let Some(slot) = slot {
                wake_regions.push(&environment.obstacles[slot]);
            }
            match (built, slot) {
                (Ok(built), slot) => {
                    refusals.forget(entity);
                    wake_regions.push(&built);
                    match slot {
                        Some(slot) => {
                            environment.obstacles[slot] = built;
                            known.set_scale(slot, scale);
                        }
                        None => {
                            environment.obstacles.push(built);
                            known.push(entity, scale);
                        }
                    }
                }
                (Err(error), slot) => {
                    refusals.entity(entity, "Obstacle", error);
                    if let Some(slot) = slot {
                        environment.obstacles.swap_remove(slot);
                        known.swap_remove(slot);
                    }
                }
            }
        } else if let Some(slot) = slot {
            let obstacle = &mut environment.obstacles[slot];
            if obstacle.placement() != placement || obstacle.is_moving() {
                if is_teleport {
                    wake_regions.push(obstacle);
                    obstacle.teleport(placement);
                } else {
                    obstacle.move_to(placement, clock.delta());
                }
                wake_regions.push(obstacle);
                if obstacle.is_moving() {
                    moving.push(entity);
                }
            }
        }
    }
}
