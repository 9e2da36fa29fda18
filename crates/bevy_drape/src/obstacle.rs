//! Obstacles: what cloth and balls collide with.

use bevy::prelude::*;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{Placement, Shape};

use crate::clock::DrapeClock;
use crate::environment::SolverEnvironment;
use crate::refusal::Refusals;

/// Something solid that cloth, ropes and balls collide with and that nothing pushes back. Its [`Transform`] says
/// where it is, scale included; moving it carries its velocity into the contact.
///
/// A move faster than 300 m/s counts as a teleport, which carries none.
#[derive(Component, Reflect, Clone, Debug)]
#[reflect(Component, Debug, Clone)]
#[require(Transform)]
pub struct Obstacle {
    /// The form, in the entity's coordinates.
    pub shape: ObstacleShape,
    /// Coulomb friction coefficient, 0 or more. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
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
        Self { shape: ObstacleShape(shape), friction: 0.5 }
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

    /// Sets the friction coefficient.
    pub fn with_friction(mut self, friction: f32) -> Self {
        self.friction = friction;
        self
    }
}

impl From<SharedShape> for Obstacle {
    fn from(shape: SharedShape) -> Self {
        Self::new(Shape::Parry(shape))
    }
}

/// What the plugin keeps about an obstacle between steps.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct ObstacleRecord {
    scale: Vec3,
}

impl ObstacleRecord {
    /// Whether the obstacle was built at this scale. The scale that is read from a matrix wavers in its last digits
    /// as the obstacle turns; that is no change of shape.
    fn has_scale(self, scale: Vec3) -> bool {
        (scale - self.scale).abs().cmple(1e-4 * self.scale.abs()).all()
    }
}

/// Boxes of what appeared, vanished, changed or moves in this step: bodies at rest there wake up.
#[derive(Resource, Default)]
pub(crate) struct StirredSpace(pub Vec<(Vec3, Vec3)>);

/// Brings obstacles into the solver: new ones, changed ones, moved ones; and takes out those that are gone.
pub(crate) fn sync_obstacles(
    mut commands: Commands,
    obstacles: Query<(Entity, Ref<Obstacle>, Ref<GlobalTransform>, Option<&ObstacleRecord>)>,
    clock: Res<DrapeClock>,
    mut solver: ResMut<SolverEnvironment>,
    mut stirred: ResMut<StirredSpace>,
    mut refusals: ResMut<Refusals>,
) {
    stirred.0.clear();
    let SolverEnvironment { environment, obstacles: entities, .. } = &mut *solver;
    remove_missing(entities, &mut environment.obstacles, &mut stirred, |entity| obstacles.contains(entity));
    let any_moves = environment.obstacles.iter().any(drape_solver::Obstacle::is_moving);
    for (entity, obstacle, transform, record) in &obstacles {
        if !(any_moves || obstacle.is_changed() || transform.is_changed()) {
            continue;
        }
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let placement = Placement { translation, rotation };
        let slot = entities.iter().position(|&known| known == entity);
        if !(placement.is_valid() && scale.is_finite()) {
            refusals.entity(entity, "Transform", "an obstacle's must be finite; it stays where it was");
            if let Some(slot) = slot {
                let known = &mut environment.obstacles[slot];
                known.teleport(known.placement());
            }
            continue;
        }
        let reshaped = transform.is_changed()
            && (slot.is_none() || record.is_none_or(|record| !record.has_scale(scale)));
        if obstacle.is_changed() || reshaped {
            let built = obstacle
                .shape
                .scaled(scale)
                .and_then(|shape| drape_solver::Obstacle::new(shape, placement, obstacle.friction));
            commands.entity(entity).try_insert(ObstacleRecord { scale });
            if built.is_ok() {
                refusals.forget(entity);
            }
            match (built, slot) {
                (Ok(built), Some(slot)) => {
                    stirred.0.push(environment.obstacles[slot].swept_bounds());
                    stirred.0.push(built.swept_bounds());
                    environment.obstacles[slot] = built;
                }
                (Ok(built), None) => {
                    stirred.0.push(built.swept_bounds());
                    environment.obstacles.push(built);
                    entities.push(entity);
                }
                (Err(error), slot) => {
                    refusals.entity(entity, "Obstacle", error);
                    if let Some(slot) = slot {
                        stirred.0.push(environment.obstacles[slot].swept_bounds());
                        environment.obstacles.remove(slot);
                        entities.remove(slot);
                    }
                }
            }
        } else if let Some(slot) = slot {
            let known = &mut environment.obstacles[slot];
            if known.placement() != placement || known.is_moving() {
                known.move_to(placement, clock.delta());
                stirred.0.push(known.swept_bounds());
            }
        }
    }
}

fn remove_missing(
    entities: &mut Vec<Entity>,
    obstacles: &mut Vec<drape_solver::Obstacle>,
    stirred: &mut StirredSpace,
    exists: impl Fn(Entity) -> bool,
) {
    let mut slot = 0;
    while slot < entities.len() {
        if exists(entities[slot]) {
            slot += 1;
        } else {
            stirred.0.push(obstacles[slot].swept_bounds());
            entities.remove(slot);
            obstacles.remove(slot);
        }
    }
}
