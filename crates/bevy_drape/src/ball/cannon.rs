//! Cannons.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::cannon::{Cannon, FireCannon};
//!
//! fn setup(mut commands: Commands, mut fire: MessageWriter<FireCannon>) {
//!     let cannon = Cannon { elevation: 0.2, muzzle_speed: 25.0, ..default() };
//!     let cannon = commands.spawn((cannon, Transform::from_xyz(0.0, 0.5, 8.0))).id();
//!     fire.write(FireCannon { cannon });
//! }
//! # App::new().add_message::<FireCannon>().add_systems(Startup, setup).update();
//! ```

use bevy::prelude::*;
use drape_solver::motion::ballistics;

use crate::ball::projectile::Projectile;
use crate::pending_messages::Pending;
use crate::refusal::Refusals;

/// Shoots [`Projectile`]s when a [`FireCannon`] message names it.
///
/// At elevation and azimuth zero it shoots along the entity's `forward` (-Z).
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct Cannon {
    /// Angle above the entity's horizon in radians.
    pub elevation: f32,
    /// Angle about the entity's Y axis in radians, growing to the left.
    pub azimuth: f32,
    /// Speed of the ball in m/s as it leaves the muzzle.
    pub muzzle_speed: f32,
    /// Distance from the entity to the muzzle, along the barrel, in metres.
    pub barrel_length: f32,
    /// The ball that is shot. The shot sets its velocity.
    pub ball: Projectile,
}

impl Default for Cannon {
    fn default() -> Self {
        Self {
            elevation: 0.0,
            azimuth: 0.0,
            muzzle_speed: 20.0,
            barrel_length: 0.0,
            ball: Projectile::default(),
        }
    }
}

impl Cannon {
    /// Unit vector along the barrel, in the entity's coordinates.
    pub fn direction(&self) -> Vec3 {
        ballistics::direction(f64::from(self.elevation), f64::from(self.azimuth)).as_vec3()
    }

    /// Position of the muzzle in the world, for a cannon at `transform`.
    pub fn muzzle(&self, transform: &GlobalTransform) -> Vec3 {
        transform.translation() + transform.rotation() * self.direction() * self.barrel_length
    }
}

/// Asks a cannon to fire in the coming step.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct FireCannon {
    /// The entity with the [`Cannon`].
    pub cannon: Entity,
}

/// Sent when a cannon has fired.
#[derive(Message, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct CannonFired {
    /// The entity with the [`Cannon`].
    pub cannon: Entity,
    /// The ball that was shot.
    pub projectile: Entity,
}

/// Spawns the balls of the cannons that were asked to fire.
pub(crate) fn fire_cannons(
    mut commands: Commands,
    mut requests: ResMut<Pending<FireCannon>>,
    mut fired: MessageWriter<CannonFired>,
    cannons: Query<(&Cannon, &GlobalTransform)>,
    mut refusals: ResMut<Refusals>,
) {
    for FireCannon { cannon: entity } in requests.waiting.drain(..) {
        // A despawned cannon does not fire.
        let Ok((cannon, transform)) = cannons.get(entity) else {
            continue;
        };
        let velocity = transform.rotation() * cannon.direction() * cannon.muzzle_speed;
        let muzzle = cannon.muzzle(transform);
        let ball = Projectile { velocity, ..cannon.ball };
        if !transform.affine().is_finite() {
            refusals.entity(entity, "Transform", "a cannon's must be finite");
            continue;
        }
        if !(velocity.is_finite() && muzzle.is_finite()) {
            refusals.entity(entity, "Cannon", "angles, muzzle speed and barrel length must be finite");
            continue;
        }
        if let Err(error) = ball.launch(muzzle, Vec3::ZERO) {
            refusals.entity(entity, "Cannon", error);
            continue;
        }
        refusals.forget(entity);
        let transform = Transform::from_translation(muzzle);
        // The ball flies in this very step, which needs the global transform.
        let bundle = (ball, transform, GlobalTransform::from(transform));
        let projectile = commands.spawn(bundle).id();
        fired.write(CannonFired { cannon: entity, projectile });
    }
}
