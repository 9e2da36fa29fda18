//! The boxes that bodies and balls can reach within a step.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use drape_solver::world::bounds::Bounds;

use crate::ball::projectile::ProjectileState;
use crate::body::body_state::BodyState;
use crate::body::particles::{Particles, Sticks};
use crate::clock::DrapeClock;
use crate::environment::gravity::DrapeGravity;
use crate::environment::solver_environment::SolverEnvironment;
use crate::environment::wind::Wind;

/// Tells where cloth, ropes, soft bodies and balls can be within the coming step, whatever their activity. Ask in
/// [`DrapeSystems::PlaceObstacles`](crate::schedule::DrapeSystems::PlaceObstacles): an obstacle far from all boxes can be
/// [disabled](bevy::ecs::entity_disabling::Disabled), and costs nothing then. It must be an entity of its own, as nothing that
/// is disabled is drawn or moved. If it is enabled elsewhere, write its [`GlobalTransform`] with its [`Transform`].
///
/// ```
/// # use bevy::ecs::entity_disabling::Disabled;
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::reach::DrapeReach;
/// use bevy_drape::schedule::DrapeSchedule;
///
/// /// A rock that is an obstacle only while something is within a metre of it. It is drawn by another entity.
/// #[derive(Component)]
/// struct Rock {
///     radius: f32,
/// }
///
/// fn switch(reach: DrapeReach, rocks: Query<(Entity, &Rock, &Transform), Allow<Disabled>>, mut commands: Commands) {
///     for (entity, rock, transform) in &rocks {
///         let near = rock.radius + 1.0;
///         if reach.boxes().any(|bounds| bounds.distance_to(transform.translation) < near) {
///             commands.entity(entity).remove::<Disabled>();
///         } else {
///             commands.entity(entity).insert(Disabled);
///         }
///     }
/// }
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, DrapePlugins::default()));
/// # app.world_mut().spawn((Rock { radius: 2.0 }, Obstacle::sphere(2.0)));
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
    wind: Res<'w, Wind>,
    solver: Res<'w, SolverEnvironment>,
}

impl DrapeReach<'_, '_> {
    /// The boxes, one for each body and ball, and for obstacles that keep the wind off it. Pins that anything but the transform of their
    /// body moves can leave them.
    pub fn boxes(&self) -> impl Iterator<Item = Bounds> + '_ {
        let dt = self.clock.delta();
        let gravity = self.gravity.or_last(self.solver.environment.gravity).length();
        let bodies = self.bodies.iter().map(move |(particles, sticks, state, transform)| {
            let bounds = state.extent_now(particles, sticks).reach(&state.settings, dt, gravity);
            let bounds = bounds.grown(particles.pulled_way(dt));
            match transform.map(GlobalTransform::affine) {
                Some(affine) if affine != state.anchor && !state.pins.is_empty() => {
                    // Pins do not follow a transform that is not finite.
                    let with_pins = bounds.joined(moved(bounds, affine * state.anchor.inverse()));
                    if with_pins.is_finite() { with_pins } else { bounds }
                }
                _ => bounds,
            }
        });
        let wind = drape_solver::Wind::from(*self.wind);
        let wind = if wind.validate().is_ok() { wind } else { self.solver.environment.wind };
        let shelter_way = wind.shelter_way().unwrap_or_default();
        let with_upwind = move |bounds: Bounds| {
            bounds.joined(Bounds::new(bounds.low + shelter_way, bounds.high + shelter_way))
        };
        let balls = self.balls.iter().map(move |ball| ball.bounds_within_step(dt, gravity));
        bodies.map(with_upwind).chain(balls)
    }
}

/// The box around a box that is moved.
fn moved(bounds: Bounds, motion: bevy::math::Affine3A) -> Bounds {
    let corner =
        |i: u8| Vec3::select(BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), bounds.low, bounds.high);
    let corners = (0..8).map(|i| motion.transform_point3(corner(i)));
    corners.fold(Bounds::EMPTY, |all, corner| all.joined(Bounds::new(corner, corner)))
}
