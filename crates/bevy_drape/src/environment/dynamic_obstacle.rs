//! Obstacles that are pushed back: told what is done to them, or moved by it.

use bevy::prelude::*;
use drape_solver::{BuildError, RigidBody};

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

    pub(crate) fn body(&self) -> Result<RigidBody, BuildError> {
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
