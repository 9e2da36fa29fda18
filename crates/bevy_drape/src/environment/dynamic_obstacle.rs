//! Obstacles that are pushed back: told what is done to them, or moved by it.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use drape_solver::{BuildError, RigidBody};

use crate::clock::DrapeClock;
use crate::environment::obstacle::{Obstacle, WakeRegions};
use crate::environment::solver_environment::{DrapeGravity, SolverEnvironment};
use crate::refusal::Refusals;
use crate::step::islands::Islands;

/// What cloth, ropes and balls did to an [`Obstacle`] in the last step: the exact opposite of all impulses that it gave
/// them. Add it to an obstacle that another physics engine moves, and hand the impulses to that engine after each step.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ObstacleReaction {
    /// Change of its momentum in newton seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub impulse: Vec3,
    /// Change of its angular momentum in newton metre seconds, in world axes, about the place of its origin at the end of
    /// the step.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub angular_impulse: Vec3,
}

/// An [`Obstacle`] that flies, falls, and is pushed back by what it touches. The plugin writes its [`Transform`], which
/// must not have a parent; moving it by hand puts it somewhere else.
///
/// It does not collide with other obstacles: for that, have a physics engine move it, by its [`ObstacleReaction`].
///
/// Linear and angular momentum are kept, and no contact gains energy, however light it is under however heavy a cloth: it
/// flies within the step, and gives way to each push as a ball does.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// # fn set_up(mut commands: Commands) {
/// commands.spawn((
///     Obstacle::cuboid(0.3, 0.3, 0.3),
///     DynamicObstacle { velocity: Vec3::Z * 5.0, ..DynamicObstacle::cuboid(2.0, Vec3::splat(0.3)) },
///     Transform::from_xyz(0.0, 1.0, -2.0),
/// ));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(ObstacleReaction)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DynamicObstacle {
    /// Mass in kilograms.
    pub mass: f32,
    /// Principal moments of inertia about the entity's axes, in kg m^2. Its centre of mass is the entity's origin.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub inertia: Vec3,
    /// Velocity in m/s.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub velocity: Vec3,
    /// Angular velocity in rad/s, in world axes.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub angular_velocity: Vec3,
    /// How much of [gravity](DrapeGravity) it feels: 1 all of it, 0 none.
    pub gravity_scale: f32,
}

impl DynamicObstacle {
    /// A solid sphere of `mass` kilograms and `radius` metres, at rest.
    pub fn sphere(mass: f32, radius: f32) -> Self {
        Self::new(mass, Vec3::splat(0.4 * mass * radius * radius))
    }

    /// A solid box of `mass` kilograms and sides of `size` metres, at rest.
    pub fn cuboid(mass: f32, size: Vec3) -> Self {
        let squared = size * size;
        Self::new(mass, (Vec3::splat(squared.element_sum()) - squared) * (mass / 12.0))
    }

    /// Of `mass` kilograms and with these principal moments of `inertia` (kg m^2), at rest.
    pub fn new(mass: f32, inertia: Vec3) -> Self {
        Self { mass, inertia, velocity: Vec3::ZERO, angular_velocity: Vec3::ZERO, gravity_scale: 1.0 }
    }

    fn body(&self) -> Result<RigidBody, BuildError> {
        let Self { mass, inertia, velocity, angular_velocity, gravity_scale } = *self;
        let fields = [
            ("velocity", velocity),
            ("angular_velocity", angular_velocity),
            ("gravity_scale", Vec3::splat(gravity_scale)),
        ];
        for (field, vector) in fields {
            if let Some(&value) = vector.to_array().iter().find(|value| !value.is_finite()) {
                return Err(BuildError::NotFinite { field, value });
            }
        }
        let mut body = RigidBody::new(mass, inertia)?;
        (body.velocity, body.angular_velocity) = (velocity, angular_velocity);
        Ok(body)
    }
}

/// Has dynamic obstacles fly through the coming step.
pub(crate) fn fly_dynamic_obstacles(
    obstacles: Query<(Entity, &DynamicObstacle), With<Obstacle>>,
    clock: Res<DrapeClock>,
    gravity: Res<DrapeGravity>,
    mut solver: ResMut<SolverEnvironment>,
    mut wake_regions: ResMut<WakeRegions>,
    mut refusals: ResMut<Refusals>,
    mut refused: Local<EntityHashSet>,
) {
    let gravity = if gravity.is_usable() { gravity.0 } else { solver.environment.gravity };
    let SolverEnvironment { environment, obstacles: known, .. } = &mut *solver;
    for (entity, dynamic) in &obstacles {
        let body = dynamic.body();
        match &body {
            Ok(_) if refused.remove(&entity) => refusals.forget(entity),
            Err(error) if refused.insert(entity) => refusals.entity(entity, "DynamicObstacle", error),
            _ => {}
        }
        let Some(slot) = known.slot(entity) else { continue };
        let obstacle = &mut environment.obstacles[slot];
        obstacle.set_rigid_body(body.ok());
        obstacle.fly(gravity * dynamic.gravity_scale, clock.delta());
        if obstacle.is_moving() {
            wake_regions.push(obstacle);
        }
    }
}

/// Tells obstacles what was done to them in this step, and puts those that fly where they have got.
pub(crate) fn give_reactions(
    mut reactions: Query<&mut ObstacleReaction>,
    mut dynamics: Query<(Entity, &mut DynamicObstacle, &mut Transform), With<Obstacle>>,
    islands: Res<Islands>,
    mut solver: ResMut<SolverEnvironment>,
) {
    let SolverEnvironment { environment, obstacles: known, .. } = &mut *solver;
    for mut reaction in &mut reactions {
        reaction.set_if_neq(ObstacleReaction::default());
    }
    for island in islands.live() {
        for reaction in &island.solver.reactions {
            if let Ok(mut sum) = reactions.get_mut(known.entity(reaction.obstacle)) {
                sum.impulse += reaction.impulse;
                sum.angular_impulse += reaction.angular_impulse;
            }
        }
        for moved in &island.solver.moved {
            environment.obstacles[moved.obstacle].land(moved);
        }
    }
    for (entity, mut dynamic, mut transform) in &mut dynamics {
        let Some(obstacle) = known.slot(entity).map(|slot| &environment.obstacles[slot]) else { continue };
        let (Some(body), place) = (obstacle.rigid_body(), obstacle.placement()) else { continue };
        let there = transform.with_translation(place.translation).with_rotation(place.rotation);
        // What does not move keeps the digits that it was given.
        if obstacle.is_moving() {
            transform.set_if_neq(there);
        }
        dynamic.set_if_neq(DynamicObstacle {
            velocity: body.velocity,
            angular_velocity: body.angular_velocity,
            ..*dynamic
        });
    }
}
