//! Obstacles: what cloth and balls collide with.

use core::ops::Range;

use bevy::ecs::change_detection::ContiguousRef;
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{BuildError, Layers, Placement, Shape};

use crate::body::layers::DrapeLayers;
use crate::change_detection::{collect_rows, is_any_changed};
use crate::clock::DrapeClock;
use crate::contact::events::ContactEvents;
use crate::environment::dynamic_obstacle::DynamicObstacle;
use crate::environment::dynamic_obstacle::ObstacleReaction;
use crate::environment::solver_environment::SolverEnvironment;
use crate::refusal::Refusals;
use crate::sleep::scene_manager::Bounds;

/// Something solid that cloth, ropes and balls collide with. Nothing pushes it back, unless it is a
/// [`DynamicObstacle`]. Its [`Transform`] says where it is, scale included; moving
/// it carries its velocity into the contact.
///
/// A move faster than 1500 m/s counts as a teleport, which carries none; so does any with [`TeleportObstacle`].
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Debug, Clone)]
#[require(Transform)]
pub struct Obstacle {
    /// The form, in the entity's coordinates.
    pub shape: ObstacleShape,
    /// Coulomb friction coefficient, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, which holds what does not slide yet; below that of friction it counts as that.
    pub static_friction: f32,
    /// Coefficient of restitution against balls: 0 (they do not bounce) to 1. The mean of this and the ball's counts.
    pub restitution: f32,
    /// Whether it moves nothing and only tells what touches it: see [`as_sensor`](Self::as_sensor).
    pub is_sensor: bool,
}

/// The form of an [`Obstacle`]: half-space, sphere, capsule, cuboid, the inside of a box, or any parry shape.
#[derive(Reflect, Clone, Debug, Deref)]
#[reflect(opaque)]
#[reflect(Debug, Clone)]
pub struct ObstacleShape(pub Shape);

impl Obstacle {
    /// An obstacle of `shape` with a friction of 0.5. Sizes are checked in the next step: what cannot be used is
    /// logged and left out.
    pub fn new(shape: Shape) -> Self {
        Self {
            shape: ObstacleShape(shape),
            friction: 0.5,
            static_friction: 0.0,
            restitution: 0.0,
            is_sensor: false,
        }
    }

    /// The half-space below the entity.
    pub fn ground() -> Self {
        Self::new(Shape::HalfSpace { normal: Vec3::Y })
    }

    /// A sphere of `radius` metres.
    pub fn sphere(radius: f32) -> Self {
        Self::new(Shape::Sphere { radius })
    }

    /// A capsule along the entity's Y axis: all points within `radius` metres of a segment of `length` metres.
    pub fn capsule(radius: f32, length: f32) -> Self {
        Self::new(Shape::Capsule { half_length: length * 0.5, radius })
    }

    /// A box with sides of `x`, `y` and `z` metres.
    pub fn cuboid(x: f32, y: f32, z: f32) -> Self {
        Self::new(Shape::Cuboid { half_extents: Vec3::new(x, y, z) * 0.5 })
    }

    /// The inside of a box with sides of `x`, `y` and `z` metres, which nothing leaves.
    pub fn container(x: f32, y: f32, z: f32) -> Self {
        Self::new(Shape::Container { half_extents: Vec3::new(x, y, z) * 0.5 })
    }

    /// Makes it a sensor: it moves nothing. With [`ContactEvents`] on it, or on what touches it, that is told.
    pub fn as_sensor(mut self) -> Self {
        self.is_sensor = true;
        self
    }

    /// Sets the friction coefficient.
    pub fn with_friction(mut self, friction: f32) -> Self {
        self.friction = friction;
        self
    }

    /// Sets the coefficient of static friction.
    pub fn with_static_friction(mut self, static_friction: f32) -> Self {
        self.static_friction = static_friction;
        self
    }

    /// Sets the coefficient of restitution.
    pub fn with_restitution(mut self, restitution: f32) -> Self {
        self.restitution = restitution;
        self
    }
}

/// Marks an [`Obstacle`] whose [`Transform`] is set to somewhere else and that is not to travel there: its next move carries
/// no velocity into contacts. The next step takes the mark off.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// fn open(mut commands: Commands, door: Single<Entity, With<Obstacle>>) {
///     commands.entity(*door).insert((Transform::from_xyz(3.0, 0.0, 0.0), TeleportObstacle));
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default)]
#[reflect(Component, Default, Debug, Clone)]
pub struct TeleportObstacle;

impl From<SharedShape> for Obstacle {
    fn from(shape: SharedShape) -> Self {
        Self::new(Shape::Parry(shape))
    }
}

/// The obstacles that the solver knows: their entities by slot, and their slots by entity.
#[derive(Default)]
pub(crate) struct KnownObstacles {
    entities: Vec<Entity>,
    /// The scales that they were built at.
    scales: Vec<Vec3>,
    /// Their numbers, in the order in which they came.
    orders: Vec<u64>,
    last_order: u64,
    slots: EntityHashMap<usize>,
}

impl KnownObstacles {
    /// The entity of an obstacle of the solver.
    pub fn entity(&self, slot: usize) -> Entity {
        self.entities[slot]
    }

    pub fn slot(&self, entity: Entity) -> Option<usize> {
        self.slots.get(&entity).copied()
    }

    /// The numbers and entities of all obstacles by slot.
    pub fn orders_and_entities(&self) -> impl Iterator<Item = (u64, Entity)> + '_ {
        self.orders.iter().copied().zip(self.entities.iter().copied())
    }

    /// The scale that an obstacle was built at.
    pub fn scale(&self, slot: usize) -> Vec3 {
        self.scales[slot]
    }

    /// Gives the next obstacle the number after `last`.
    pub fn go_on_from(&mut self, last: u64) {
        self.last_order = last;
    }

    /// Knows these instead of all others, each with its number and scale.
    pub fn replace(&mut self, obstacles: Vec<(u64, Entity, Vec3)>) {
        *self = Self { last_order: self.last_order, ..Self::default() };
        for (order, entity, scale) in obstacles {
            self.push_with(order, entity, scale);
        }
    }

    fn push(&mut self, entity: Entity, scale: Vec3) {
        self.push_with(self.last_order + 1, entity, scale);
    }

    fn push_with(&mut self, order: u64, entity: Entity, scale: Vec3) {
        self.last_order = self.last_order.max(order);
        self.slots.insert(entity, self.entities.len());
        self.entities.push(entity);
        self.scales.push(scale);
        self.orders.push(order);
    }

    /// Takes one out; the last takes its slot.
    fn swap_remove(&mut self, slot: usize) {
        self.slots.remove(&self.entities.swap_remove(slot));
        self.scales.swap_remove(slot);
        self.orders.swap_remove(slot);
        if let Some(moved) = self.entities.get(slot) {
            self.slots.insert(*moved, slot);
        }
    }

    /// Whether the obstacle was built at this scale. The scale that is read from a matrix wavers in its last digits
    /// as the obstacle turns; that is no change of shape.
    fn has_scale(&self, slot: usize, scale: Vec3) -> bool {
        let known = self.scales[slot];
        (scale - known).abs().cmple(1e-4 * known.abs()).all()
    }
}

/// Obstacles that have to be looked at in the next step though their components do not tell.
#[derive(Resource, Default)]
pub(crate) struct ObstacleChanges {
    /// Those that were despawned, disabled or lost their [`Obstacle`].
    gone: Vec<Entity>,
    /// Those that were enabled, or gained or lost a component that matters.
    recheck: Vec<Entity>,
    /// Those that moved in the last step, and may have stopped.
    moving: Vec<Entity>,
    /// Those to look at.
    seen: Vec<Entity>,
}

impl ObstacleChanges {
    /// Notes which have moved in the last step.
    pub fn set_moving(&mut self, moving: Vec<Entity>) {
        self.moving = moving;
    }
}

pub(crate) fn note_gone_obstacle(gone: On<Remove, Obstacle>, mut changes: ResMut<ObstacleChanges>) {
    changes.gone.push(gone.entity);
}

pub(crate) fn note_disabled_obstacle(disabled: On<Add, Disabled>, mut changes: ResMut<ObstacleChanges>) {
    changes.gone.push(disabled.entity);
}

/// Has an entity looked at in the next step, in case it is an obstacle.
pub(crate) fn recheck_obstacle<E: EntityEvent, C: Component>(
    event: On<E, C>,
    mut changes: ResMut<ObstacleChanges>,
) {
    changes.recheck.push(event.event_target());
}

/// Boxes and layers of what appeared, vanished, changed or moves in this step: bodies at rest there wake up, if they could
/// touch it.
#[derive(Resource, Default)]
pub(crate) struct WakeRegions(pub Vec<(Bounds, Layers)>);

impl WakeRegions {
    pub fn push(&mut self, obstacle: &drape_solver::Obstacle) {
        self.0.push((obstacle.swept_bounds(), obstacle.layers()));
    }
}

/// The solver's obstacle; `reports` are contacts and reactions.
pub(crate) fn built(
    obstacle: &Obstacle,
    scale: Vec3,
    placement: Placement,
    layers: Layers,
    [reports_contacts, reports_reaction]: [bool; 2],
) -> Result<drape_solver::Obstacle, BuildError> {
    let built = drape_solver::Obstacle::new(obstacle.shape.scaled(scale)?, placement, obstacle.friction)?
        .with_static_friction(obstacle.static_friction)?
        .with_restitution(obstacle.restitution)?
        .with_layers(layers);
    let built = if obstacle.is_sensor { built.as_sensor() } else { built };
    let built = if reports_contacts { built.reporting_contacts() } else { built };
    Ok(if reports_reaction { built.reporting_reaction() } else { built })
}

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
                            known.scales[slot] = scale;
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
