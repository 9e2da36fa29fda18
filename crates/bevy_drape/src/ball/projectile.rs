//! Cannon balls.

use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::{ball_bounds, ball_reach};
use drape_solver::{Ball, BallMaterial, BuildError};

use crate::body::activity::Activity;
use crate::body::body_state::CreationOrder;
use crate::environment::gravity::DrapeGravity;
use crate::environment::solver_environment::SolverEnvironment;
use crate::refusal::{Cause, Refusals};

/// A ball: flies, hits, rolls and comes to rest. Cloth acts back on it.
///
/// It starts at its [`Transform`]. From then on the plugin writes the transform; moving it by hand teleports the ball.
/// The simulated state is in [`ProjectileState`].
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, Activity)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Projectile {
    /// Radius in metres.
    pub radius: f32,
    /// Mass in kilograms.
    pub mass: f32,
    /// Velocity at the start in m/s.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_vector"))]
    pub velocity: Vec3,
    /// Drag of still air in 1/s.
    pub drag: f32,
    /// Coulomb friction coefficient. Two surfaces in contact use the mean of theirs.
    pub friction: f32,
    /// Coefficient of static friction, which holds until sliding begins; at least the friction coefficient counts.
    pub static_friction: f32,
    /// Coefficient of restitution against balls and obstacles: 0 (no bounce) to 1. Two surfaces in contact use the mean
    /// of theirs.
    pub restitution: f32,
    /// Rolling resistance: on level ground a rolling ball slows by `5/7 g` times this. A hard ball on a floor has
    /// 0.001 to 0.01, on grass 0.1.
    pub rolling_resistance: f32,
}

impl Default for Projectile {
    fn default() -> Self {
        let BallMaterial { radius, mass, drag, friction, static_friction, restitution, rolling_resistance } =
            BallMaterial::default();
        let velocity = Vec3::ZERO;
        Self { radius, mass, velocity, drag, friction, static_friction, restitution, rolling_resistance }
    }
}

impl Projectile {
    /// Launches the ball at `position` (metres) under `gravity` (m/s^2).
    pub(crate) fn launch(&self, position: Vec3, gravity: Vec3) -> Result<Ball, BuildError> {
        let material = BallMaterial {
            radius: self.radius,
            mass: self.mass,
            drag: self.drag,
            friction: self.friction,
            static_friction: self.static_friction,
            restitution: self.restitution,
            rolling_resistance: self.rolling_resistance,
        };
        Ball::launch(material, position, self.velocity, gravity, LAUNCH_SUBSTEP)
    }
}

/// Substep that a ball is launched for, in seconds. The solver adapts the ball to the real one.
const LAUNCH_SUBSTEP: f32 = 1.0 / 1024.0;

/// The simulated state of a [`Projectile`]: position, velocity, spin. Write to it to push or move the ball.
#[derive(Component, Reflect, Clone, Debug, Deref, DerefMut)]
#[reflect(opaque)]
#[reflect(Component, Debug, Clone)]
pub struct ProjectileState(pub Ball);

impl ProjectileState {
    /// Box around the ball.
    pub(crate) fn bounds(&self) -> Bounds {
        ball_bounds(self)
    }

    /// Box that the ball does not leave within a step of `dt` seconds.
    pub(crate) fn bounds_within_step(&self, dt: f32, gravity: f32) -> Bounds {
        ball_reach(self, dt, gravity)
    }
}

/// State of a ball that the plugin keeps from step to step.
#[derive(Component, Clone, Debug)]
pub(crate) struct ProjectileRecord {
    /// Order of creation, by which balls are sorted.
    pub order: u64,
    /// The transform that the plugin wrote last; another one found there is a teleport.
    pub written: Transform,
    /// True if the ball cannot be simulated; the log has the reason.
    pub refused: bool,
}

/// Builds balls that were inserted or changed since the last step, and refused ones that have moved.
pub(crate) fn build_projectiles(
    mut commands: Commands,
    projectiles: Query<
        (Entity, &Projectile, &Transform, &GlobalTransform),
        Or<(Changed<Projectile>, (Changed<GlobalTransform>, Without<ProjectileState>))>,
    >,
    gravity: Res<DrapeGravity>,
    solver: Res<SolverEnvironment>,
    mut order: ResMut<CreationOrder>,
    mut refusals: ResMut<Refusals>,
) {
    let gravity = gravity.or_last(solver.environment.gravity);
    for (entity, projectile, transform, global) in &projectiles {
        let built = if global.affine().is_finite() {
            let ball = projectile.launch(global.translation(), gravity);
            ball.map_err(|error| ("Projectile", Cause::from(error)))
        } else {
            Err(("Transform", "it must be finite".into()))
        };
        match built {
            Ok(mut ball) => {
                refusals.forget(entity);
                ball.set_rotation(global.rotation());
                let record = ProjectileRecord { order: order.next(), written: *transform, refused: false };
                commands.entity(entity).insert((ProjectileState(ball), record, Activity::Active));
            }
            Err((component, reason)) => {
                refusals.entity(entity, component, reason);
                commands.entity(entity).remove::<(ProjectileState, ProjectileRecord)>();
            }
        }
    }
}

/// Removes the simulated ball from an entity that loses its [`Projectile`].
pub(crate) fn remove_ball(removed: On<Remove<Projectile>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<(ProjectileState, ProjectileRecord, Activity)>();
}

/// Moves balls whose transform was changed by hand.
pub(crate) fn teleport_projectiles(
    mut balls: Query<
        (Entity, &mut Transform, &GlobalTransform, &mut ProjectileState, &mut ProjectileRecord),
        Changed<Transform>,
    >,
    mut refusals: ResMut<Refusals>,
) {
    for (entity, mut transform, global, mut ball, mut record) in &mut balls {
        if !(transform.is_finite() && global.affine().is_finite()) {
            refusals.entity(entity, "the new Transform", "it must be finite; the ball stays where it was");
            transform.set_if_neq(record.written);
            continue;
        }
        if transform.translation != record.written.translation {
            ball.set_position(global.translation());
        }
        if transform.rotation != record.written.rotation {
            ball.set_rotation(global.rotation());
        }
        record.written = *transform;
    }
}

/// Writes the transforms of balls.
pub(crate) fn write_projectile_transforms(
    mut balls: Query<
        (&ProjectileState, &Activity, &mut ProjectileRecord, &mut Transform, Option<&ChildOf>),
        Changed<ProjectileState>,
    >,
    parents: Query<&GlobalTransform>,
) {
    for (ball, activity, mut record, mut transform, child_of) in &mut balls {
        if *activity != Activity::Active || record.refused {
            continue;
        }
        let mut placed =
            Transform { translation: ball.position(), rotation: ball.rotation(), scale: transform.scale };
        if let Some(parent) = child_of.and_then(|child_of| parents.get(child_of.parent()).ok()) {
            let to_parent = parent.affine().inverse();
            placed.translation = to_parent.transform_point3(placed.translation);
            placed.rotation = parent.rotation().inverse() * placed.rotation;
        }
        // The transform of the parent may have a scale of zero, or not be finite.
        if placed.is_finite() {
            *transform = placed;
            record.written = placed;
        }
    }
}
