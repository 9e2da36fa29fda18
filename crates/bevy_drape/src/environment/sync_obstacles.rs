//! Brings obstacles into the solver.

use core::ops::Range;

use bevy::ecs::change_detection::ContiguousRef;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::{BuildError, Layers, Obstacles, Placement};

use crate::body::contact_events::ContactEvents;
use crate::body::layers::DrapeLayers;
use crate::change_detection::{collect_rows, for_rows, is_any_changed};
use crate::clock::DrapeClock;
use crate::environment::dynamic_obstacle::{DynamicObstacle, ObstacleReaction};
use crate::environment::known_obstacles::KnownObstacles;
use crate::environment::obstacle::{Obstacle, TeleportObstacle, built};
use crate::environment::obstacle_changes::ObstacleChanges;
use crate::environment::obstacle_shape::ShapeFromMesh;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wake_regions::WakeRegions;
use crate::refusal::Refusals;

/// Obstacles, and everything about them that the solver needs.
type ObstacleQuery<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        Ref<'static, Obstacle>,
        Ref<'static, GlobalTransform>,
        Option<Ref<'static, DrapeLayers>>,
        Option<Ref<'static, ShapeFromMesh>>,
        Has<ContactEvents>,
        Has<ObstacleReaction>,
        Has<TeleportObstacle>,
        Has<DynamicObstacle>,
    ),
>;

/// Obstacles, the solver's, and everything that their changes affect.
#[derive(SystemParam)]
pub(crate) struct Syncing<'w, 's> {
    obstacles: ObstacleQuery<'w, 's>,
    commands: Commands<'w, 's>,
    clock: Res<'w, DrapeClock>,
    solver: ResMut<'w, SolverEnvironment>,
    wake_regions: ResMut<'w, WakeRegions>,
    refusals: ResMut<'w, Refusals>,
}

/// Brings new and changed obstacles into the solver, and removes despawned and disabled ones. Lists those that only move.
pub(crate) fn sync_obstacles(
    mut syncing: Syncing,
    disabled: Query<(), (With<Obstacle>, With<Disabled>)>,
    mut changes: ResMut<ObstacleChanges>,
) {
    syncing.wake_regions.0.clear();
    for entity in changes.gone.drain(..) {
        if !syncing.obstacles.contains(entity) {
            syncing.sync().remove(entity, disabled.contains(entity));
        }
    }
    let known = &syncing.solver.obstacles;
    let is_any_enabled = changes.recheck.iter().any(|&entity| known.order_of_disabled(entity).is_some());
    collect_outdated(&syncing.obstacles, &mut changes);
    let ObstacleChanges { moving, outdated, .. } = &mut *changes;
    if is_any_enabled {
        // They come in the order of their numbers, wherever their entities are.
        outdated.sort_by_key(|&entity| known.order_of_disabled(entity).unwrap_or(u64::MAX));
    }
    moving.extend(outdated.iter().filter(|&&entity| syncing.update(entity)));
}

/// Lists the obstacles that were added or changed since the last step, those that moved in it and may have stopped, and those
/// to recheck; apart from them, those that have only moved.
fn collect_outdated(obstacles: &ObstacleQuery, changes: &mut ObstacleChanges) {
    let ObstacleChanges { recheck, moving, outdated, moved, .. } = changes;
    outdated.clear();
    moved.clear();
    for (entities, components, transforms, layers, .., is_dynamic) in
        obstacles.contiguous_iter().into_iter().flatten()
    {
        let (_, ticks) = ContiguousRef::split(components);
        let (transforms, transform_ticks) = ContiguousRef::split(transforms);
        let layer_ticks = layers.map(|layers| ContiguousRef::split(layers).1);
        let is_moved = |rows: Range<usize>| is_any_changed(&transform_ticks, rows);
        let is_outdated = |rows: Range<usize>| {
            is_any_changed(&ticks, rows.clone())
                || is_dynamic && is_moved(rows.clone())
                || layer_ticks.as_ref().is_some_and(|ticks| is_any_changed(ticks, rows))
        };
        collect_rows(entities, is_outdated, outdated);
        for_rows(entities.len(), is_moved, |row| {
            if !is_outdated(row..row + 1) {
                moved.push((entities[row], transforms[row]));
            }
        });
    }
    // Each is listed once: a second update would stop a moving obstacle.
    let is_listed = |entity: Entity| {
        obstacles.get(entity).is_ok_and(|(_, obstacle, transform, layers, .., is_dynamic)| {
            obstacle.is_changed()
                || is_dynamic && transform.is_changed()
                || layers.is_some_and(|layers| layers.is_changed())
        })
    };
    let mut rechecked = EntityHashSet::default();
    recheck.retain(|&entity| !is_listed(entity) && rechecked.insert(entity));
    moved.retain(|(entity, _)| !rechecked.contains(entity));
    // Those that move on come in the order of the last step.
    let mut next = 0;
    moving.retain(|&entity| {
        let moves_on = moved.get(next).is_some_and(|&(moved, _)| moved == entity);
        next += usize::from(moves_on);
        let is_moved = || obstacles.get(entity).is_ok_and(|(_, _, transform, ..)| transform.is_changed());
        !(moves_on || rechecked.contains(&entity) || is_moved() || is_listed(entity))
    });
    outdated.extend(moving.drain(..).chain(recheck.drain(..)));
}

impl Syncing<'_, '_> {
    /// Moves an obstacle of which nothing else has changed; true if it moves in this step. `is_near` tells if anything is
    /// within so many metres of a place.
    pub fn move_one(
        &mut self,
        entity: Entity,
        transform: &GlobalTransform,
        is_near: impl FnOnce(f32, Vec3) -> bool,
    ) -> bool {
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let placement = Placement { translation, rotation };
        self.sync().move_out_of_reach(entity, scale, placement, is_near) || self.update(entity)
    }

    /// Builds, rebuilds or moves an obstacle; true if it moves in this step.
    fn update(&mut self, entity: Entity) -> bool {
        let Ok((
            _,
            obstacle,
            transform,
            layers,
            from_mesh,
            reports_contacts,
            reports_reaction,
            is_teleport,
            is_dynamic,
        )) = self.obstacles.get(entity)
        else {
            return false;
        };
        if is_teleport {
            self.commands.entity(entity).remove::<TeleportObstacle>();
        }
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let state = ObstacleState {
            entity,
            obstacle: &obstacle,
            from_mesh: from_mesh.as_deref(),
            is_changed: obstacle.is_changed() || from_mesh.as_ref().is_some_and(DetectChanges::is_changed),
            scale,
            placement: Placement { translation, rotation },
            layers: DrapeLayers::of(layers.as_deref()),
            reports: [reports_contacts, reports_reaction],
            is_teleport,
            is_dynamic,
        };
        ObstacleSync::new(&mut self.solver, &mut self.wake_regions, &mut self.refusals, &self.clock)
            .update(&state)
    }

    fn sync(&mut self) -> ObstacleSync<'_> {
        ObstacleSync::new(&mut self.solver, &mut self.wake_regions, &mut self.refusals, &self.clock)
    }
}

/// An obstacle as its entity describes it now.
struct ObstacleState<'a> {
    entity: Entity,
    obstacle: &'a Obstacle,
    from_mesh: Option<&'a ShapeFromMesh>,
    /// True if its shape or another field was added or changed since the last step.
    is_changed: bool,
    scale: Vec3,
    placement: Placement,
    layers: Layers,
    /// True for reports of contacts, and of reactions.
    reports: [bool; 2],
    is_teleport: bool,
    is_dynamic: bool,
}

impl ObstacleState<'_> {
    /// The solver's obstacle; none while its mesh has not loaded.
    fn built(&self) -> Result<Option<drape_solver::Obstacle>, BuildError> {
        let shape = self.obstacle.shape.solid(self.from_mesh)?;
        let build =
            |shape| built(self.obstacle, &shape, self.scale, self.placement, self.layers, self.reports);
        shape.map(build).transpose()
    }
}

/// The solver's obstacles, and everything that their changes affect.
struct ObstacleSync<'a> {
    built: &'a mut Obstacles,
    known: &'a mut KnownObstacles,
    wake_regions: &'a mut WakeRegions,
    refusals: &'a mut Refusals,
    /// Length of the step in seconds.
    dt: f32,
}

impl<'a> ObstacleSync<'a> {
    fn new(
        solver: &'a mut SolverEnvironment,
        wake_regions: &'a mut WakeRegions,
        refusals: &'a mut Refusals,
        clock: &DrapeClock,
    ) -> Self {
        let SolverEnvironment { environment, obstacles: known, .. } = solver;
        Self { built: &mut environment.obstacles, known, wake_regions, refusals, dt: clock.delta() }
    }

    /// Moves an obstacle that nothing is near, and returns true; it may stop in the next step. Leaves another one as it is.
    fn move_out_of_reach(
        &mut self,
        entity: Entity,
        scale: Vec3,
        placement: Placement,
        is_near: impl FnOnce(f32, Vec3) -> bool,
    ) -> bool {
        let slot = self.known.slot(entity).filter(|&slot| self.known.has_scale(slot, scale));
        let Some(slot) = slot else { return false };
        let built = &self.built[slot];
        let way = placement.translation.distance(built.placement().translation);
        if is_near(built.radius() + way, placement.translation) || !placement.is_valid() {
            return false;
        }
        self.built.move_out_of_reach(slot, placement, self.dt);
        true
    }

    /// Removes an obstacle, and wakes bodies that rest on it.
    fn remove(&mut self, entity: Entity, is_disabled: bool) {
        let Some(slot) = self.known.slot(entity) else {
            if !is_disabled {
                self.known.forget_disabled(entity);
            }
            return;
        };
        self.wake_regions.push(&self.built.swap_remove(slot));
        if is_disabled {
            self.known.disable(slot);
        } else {
            self.known.swap_remove(slot);
        }
    }

    /// Builds, rebuilds or moves an obstacle; true if it moves in this step.
    fn update(&mut self, state: &ObstacleState) -> bool {
        let slot = self.known.slot(state.entity);
        if !(state.placement.is_valid() && state.scale.is_finite()) {
            self.refusals.entity(
                state.entity,
                "Transform",
                "an obstacle's must be finite, with a scale above 0; it stays where it was",
            );
            if let Some(slot) = slot {
                let obstacle = &mut self.built[slot];
                obstacle.teleport(obstacle.placement());
            }
            return false;
        }
        match slot {
            Some(slot) if !state.is_changed && self.is_built_as(slot, state) => self.move_to(slot, state),
            _ => {
                self.rebuild(slot, state);
                false
            }
        }
    }

    /// True if the obstacle in `slot` differs from `state` in its placement only.
    fn is_built_as(&self, slot: usize, state: &ObstacleState) -> bool {
        let built = &self.built[slot];
        self.known.has_scale(slot, state.scale)
            && built.layers() == state.layers
            && [built.reports_contacts(), built.reports_reaction()] == state.reports
            && (state.is_dynamic || built.rigid_body().is_none())
            && (state.from_mesh.is_some() || !state.obstacle.shape.is_from_mesh())
    }

    fn rebuild(&mut self, slot: Option<usize>, state: &ObstacleState) {
        let &ObstacleState { entity, scale, .. } = state;
        if let Some(slot) = slot {
            self.wake_regions.push(&self.built[slot]);
        }
        match (state.built(), slot) {
            (Ok(Some(built)), slot) => {
                self.refusals.forget(entity);
                self.wake_regions.push(&built);
                match slot {
                    Some(slot) => {
                        self.built[slot] = built;
                        self.known.set_scale(slot, scale);
                    }
                    None => {
                        self.built.push(built);
                        self.known.push(entity, scale);
                    }
                }
            }
            (missing, slot) => {
                if let Err(error) = missing {
                    self.refusals.entity(entity, "Obstacle", error);
                }
                if let Some(slot) = slot {
                    self.built.swap_remove(slot);
                    self.known.swap_remove(slot);
                }
            }
        }
    }

    /// Moves an obstacle evenly over the step, or at once; true if it moves in this step.
    fn move_to(&mut self, slot: usize, state: &ObstacleState) -> bool {
        let obstacle = &mut self.built[slot];
        if obstacle.placement() == state.placement && !obstacle.is_moving() && !obstacle.is_out_of_reach() {
            return false;
        }
        if state.is_teleport {
            self.wake_regions.push(obstacle);
            obstacle.teleport(state.placement);
        } else {
            obstacle.move_to(state.placement, self.dt);
        }
        self.wake_regions.push(obstacle);
        obstacle.is_moving()
    }
}
