//! Obstacles that are pushed back.

use bevy::prelude::*;
use drape_solver::{BuildError, RigidBody};

/// Impulse of cloth, ropes and balls on an [`Obstacle`](crate::environment::obstacle::Obstacle) in the last step: the
/// exact opposite of all impulses that it gave them. Add this to an obstacle that another physics engine moves, and
/// pass the impulses to that engine after each step.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ObstacleReaction {
    /// Change of its momentum in newton seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub impulse: Vec3,
    /// Change of its angular momentum in newton metre seconds, in world axes, about its origin at the end of the step.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub angular_impulse: Vec3,
    /// True if anything that was awake was near a [`DynamicObstacle`] in the last step, whether or not it touched it.
    pub is_near: bool,
}

/// An [`Obstacle`](crate::environment::obstacle::Obstacle) that flies, falls, and is pushed back by everything that it
/// touches. The plugin writes its [`Transform`]; the entity must not have a parent. Moving it by hand teleports it.
///
/// It does not collide with other obstacles. For that, let a physics engine move it, with a [`PlannedPlacement`].
///
/// Contacts conserve linear and angular momentum and never gain energy, even between a light obstacle and a heavy
/// cloth: the obstacle moves within the step and yields to each push, as a ball does.
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
#[reflect(Component, Default, Debug, Clone, PartialEq)]
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
    /// Factor on [gravity](crate::environment::gravity::DrapeGravity): 1 for all of it, 0 for none.
    pub gravity_scale: f32,
    /// World axes, x, y and z, along which neither contacts nor gravity move it.
    pub locked_translation: [bool; 3],
    /// World axes about which no contact turns it.
    pub locked_rotation: [bool; 3],
}

impl Default for DynamicObstacle {
    /// A solid box of one kilogram with sides of one metre, at rest.
    fn default() -> Self {
        Self::cuboid(1.0, Vec3::ONE)
    }
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

    /// A body of `mass` kilograms with these principal moments of `inertia` (kg m^2), at rest.
    pub fn new(mass: f32, inertia: Vec3) -> Self {
        Self {
            mass,
            inertia,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            gravity_scale: 1.0,
            locked_translation: [false; 3],
            locked_rotation: [false; 3],
        }
    }

    pub(crate) fn body(&self) -> Result<RigidBody, BuildError> {
        let Self { mass, inertia, velocity, angular_velocity, gravity_scale, .. } = *self;
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
        let [translation, rotation] = [self.locked_translation, self.locked_rotation].map(BVec3::from_array);
        let mut body = RigidBody::new(mass, inertia)?.with_locked_axes(translation, rotation);
        (body.velocity, body.angular_velocity) = (velocity, angular_velocity);
        Ok(body)
    }
}

/// The place to which another physics engine has moved a [`DynamicObstacle`] in the coming step. The obstacle flies there
/// once more, from the place of its [`Transform`], through all cloth, ropes and balls in its way, which push it aside.
///
/// Write three things before each step: the place where the obstacle starts, if it is not where the last step left it,
/// to its [`Transform`]; the place where the engine has put it to this; and the velocities that it has there to the
/// [`DynamicObstacle`]. Gravity and all other forces are the engine's. If the impulses of its [`ObstacleReaction`] are
/// not zero after the step, hand [`Transform`] and velocities back to the engine.
///
/// ```text
/// engine's step    Transform  ------------------>  PlannedPlacement
/// cloth's step     Transform  -----.  hit
///                                   `-------->  Transform, back to the engine
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct PlannedPlacement {
    /// Place of the origin, in metres.
    pub translation: Vec3,
    /// Rotation of the axes.
    pub rotation: Quat,
}
