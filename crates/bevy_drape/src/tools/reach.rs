//! The boxes that bodies and balls can reach within a step.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;
use drape_solver::world::extent::Extent;

use crate::ball::projectile::ProjectileState;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::clock::DrapeClock;
use crate::environment::gravity::DrapeGravity;
use crate::environment::solver_environment::SolverEnvironment;

/// Tells where cloth, ropes, soft bodies and balls can be within the coming step, whatever their activity. Ask in
/// [`DrapeSystems::PlaceObstacles`](crate::schedule::DrapeSystems::PlaceObstacles): an obstacle far from all boxes can be
/// [disabled](bevy::ecs::entity_disabling::Disabled), and costs nothing then.
///
/// ```
/// # use bevy::ecs::entity_disabling::Disabled;
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::reach::DrapeReach;
/// use bevy_drape::schedule::DrapeSchedule;
///
/// /// A lift of 2 m that is an obstacle only while something is within a metre of it.
/// #[derive(Component)]
/// struct Lift;
///
/// fn switch(reach: DrapeReach, lift: Single<(Entity, &Transform), (With<Lift>, Allow<Disabled>)>, mut commands: Commands) {
///     let (entity, transform) = *lift;
///     let is_near = reach.boxes().any(|bounds| bounds.distance_to(transform.translation) < 3.0);
///     if is_near {
///         commands.entity(entity).remove::<Disabled>();
///     } else {
///         commands.entity(entity).insert(Disabled);
///     }
/// }
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, DrapePlugins::default()));
/// # app.world_mut().spawn((Lift, Obstacle::cuboid(2.0, 2.0, 2.0)));
/// app.add_systems(DrapeSchedule, switch.in_set(DrapeSystems::PlaceObstacles));
/// # app.update();
/// ```
#[derive(SystemParam)]
pub struct DrapeReach<'w, 's> {
    bodies: Query<
        'w,
        's,
        (&'static Particles, &'static Sticks, &'static BodyState, Option<&'static GlobalTransform>),
    >,
    balls: Query<'w, 's, &'static ProjectileState>,
    clock: Res<'w, DrapeClock>,
    gravity: Res<'w, DrapeGravity>,
    solver: Res<'w, SolverEnvironment>,
}

impl DrapeReach<'_, '_> {
    /// The boxes, one for each body and ball. Pins that anything but the transform of their body moves can leave them.
    pub fn boxes(&self) -> impl Iterator<Item = Bounds> + '_ {
        let dt = self.clock.delta();
        let gravity = self.gravity.or_last(self.solver.environment.gravity).length();
        let bodies = self.bodies.iter().map(move |(particles, sticks, state, transform)| {
            // The kept extent is that of the last step.
            let extent = if particles.is_disturbed() || state.order == 0 {
                Extent::of(particles, sticks)
            } else {
                state.extent
            };
            let bounds = extent.reach(&state.settings, dt, gravity);
            match transform.map(GlobalTransform::affine) {
                Some(affine) if affine != state.anchor && !state.pins.is_empty() => {
                    bounds.joined(moved(bounds, affine * state.anchor.inverse()))
                }
                _ => bounds,
            }
        });
        bodies.chain(self.balls.iter().map(move |ball| ball.bounds_within_step(dt, gravity)))
    }
}

/// The box around a box that is moved.
fn moved(bounds: Bounds, motion: bevy::math::Affine3A) -> Bounds {
    let corner =
        |i: u8| Vec3::select(BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), bounds.low, bounds.high);
    let corners = (0..8).map(|i| motion.transform_point3(corner(i)));
    corners.fold(Bounds::EMPTY, |all, corner| all.joined(Bounds::new(corner, corner)))
}
