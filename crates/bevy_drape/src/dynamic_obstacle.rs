//! Obstacles that are pushed back: told what is done to them, or moved by it.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use drape_solver::{BuildError, Placement, RigidBody};

use crate::clock::DrapeClock;
use crate::environment::{DrapeGravity, SolverEnvironment};
use crate::islands::Islands;
use crate::obstacle::Obstacle;
use crate::refusal::Refusals;

/// What cloth, ropes and balls did to an [`Obstacle`] in the last step: the exact opposite of all impulses that it gave
/// them. Add it to an obstacle that another physics engine moves, and hand the impulses to that engine after each step.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ObstacleReaction {
    /// Change of its momentum in newton seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))]
    pub impulse: Vec3,
    /// Change of its angular momentum in newton metre seconds, in world axes, about the place of its origin at the end of
    /// the step.
    #[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))]
    pub angular_impulse: Vec3,
}

/// An [`Obstacle`] that flies, falls, and is pushed back by what it touches. The plugin writes its [`Transform`], which
/// must not have a parent; moving it by hand as well is a push without momentum.
///
/// It does not collide with other obstacles: for that, have a physics engine move it, by its [`ObstacleReaction`].
///
/// Linear and angular momentum are kept. The coupling is explicit, once a step: in the step of a hit it holds like an
/// obstacle without end of mass. No energy is gained where it weighs, as felt at the point of contact, at least as much as what it stops in one step
/// (a free cloth that it catches, a ball), or `(1 + e) / (1 - e)` times as much where they bounce with a restitution of `e`. Lighter
/// ones under heavy cloth may be thrown off; a shorter fixed step helps, as less is stopped in each.
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
    #[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))]
    pub inertia: Vec3,
    /// Velocity in m/s.
    #[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))]
    pub velocity: Vec3,
    /// Angular velocity in rad/s, in world axes.
    #[cfg_attr(feature = "serde", serde(with = "crate::snapshot::vector"))]
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

/// Puts dynamic obstacles where they are at the end of this step.
pub(crate) fn move_dynamic_obstacles(
    mut obstacles: Query<(Entity, &mut DynamicObstacle, &mut Transform), With<Obstacle>>,
    clock: Res<DrapeClock>,
    gravity: Res<DrapeGravity>,
    solver: Res<SolverEnvironment>,
    mut refusals: ResMut<Refusals>,
    mut refused: Local<EntityHashSet>,
) {
    let gravity = if gravity.is_usable() { gravity.0 } else { solver.environment.gravity };
    let dt = clock.delta();
    for (entity, mut dynamic, mut transform) in &mut obstacles {
        let mut body = match dynamic.body() {
            Ok(body) => {
                if refused.remove(&entity) {
                    refusals.forget(entity);
                }
                body
            }
            Err(error) => {
                refusals.entity(entity, "DynamicObstacle", error);
                refused.insert(entity);
                continue;
            }
        };
        let from = Placement { translation: transform.translation, rotation: transform.rotation };
        if !from.is_valid() {
            continue;
        }
        body.accelerate(gravity * dynamic.gravity_scale, dt);
        let to = body.advance(from, dt);
        if to != from && to.is_valid() {
            (transform.translation, transform.rotation) = (to.translation, to.rotation);
        }
        let moved =
            DynamicObstacle { velocity: body.velocity, angular_velocity: body.angular_velocity, ..*dynamic };
        dynamic.set_if_neq(moved);
    }
}

/// Tells obstacles what was done to them in this step, and gives it to those that it moves.
pub(crate) fn give_reactions(
    mut obstacles: Query<(&mut ObstacleReaction, Option<&mut DynamicObstacle>)>,
    islands: Res<Islands>,
    solver: Res<SolverEnvironment>,
) {
    for (mut reaction, _) in &mut obstacles {
        reaction.set_if_neq(ObstacleReaction::default());
    }
    for island in islands.live() {
        for reaction in &island.solver.reactions {
            let entity = solver.obstacles.entity(reaction.obstacle);
            let Ok((mut sum, dynamic)) = obstacles.get_mut(entity) else { continue };
            sum.impulse += reaction.impulse;
            sum.angular_impulse += reaction.angular_impulse;
            let Some(mut dynamic) = dynamic else { continue };
            let Ok(mut body) = dynamic.body() else { continue };
            body.receive(reaction, solver.environment.obstacles[reaction.obstacle].placement());
            (dynamic.velocity, dynamic.angular_velocity) = (body.velocity, body.angular_velocity);
        }
    }
}
