//! Rigid bodies of four particles: crates, stones, furniture.

use bevy::prelude::*;
use drape_solver::build::rigid_tetrahedron::placement_of;
use drape_solver::{BodySettings, BuildError, Placement, RigidTetrahedronBuilder};

use crate::body::activity::Activity;
use crate::body::fabric::Fabric;
use crate::body::particles::{BodyParts, Particles};
use crate::build::description::Description;

/// A rigid body of four particles and six sticks. It touches obstacles with the corners of a convex collision mesh
/// (S30).
///
/// The first step after insertion or a change builds its [`Particles`] and [`Sticks`](crate::body::particles::Sticks)
/// at its [`Transform`]; the centre of mass is the entity's origin. From then on the plugin writes translation and
/// rotation. Moving the `Transform` by hand teleports the body, which keeps its velocity.
///
/// Corners touch obstacles, edges and sides do not: give a long body corners along its edges. Cannon balls hit its
/// sticks. A body that moves by more than its own size per substep may pass through obstacles.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_drape::prelude::*;
/// use bevy_drape::build::RigidTetrahedron;
///
/// fn spawn_crate(mut commands: Commands) {
///     commands.spawn((RigidTetrahedron::cuboid(8.0, Vec3::splat(0.25)), Transform::from_xyz(0.0, 3.0, 0.0)));
/// }
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[require(Transform, RigidPlace)]
pub struct RigidTetrahedron {
    /// Mass in kilograms, above 0.
    pub mass: f32,
    /// Principal moments of inertia about the centre of mass in kg m^2, along the axes of the entity. Each is less than the
    /// sum of the others.
    pub inertia: Vec3,
    /// Corners of the collision mesh, in the entity's own coordinates, in metres.
    pub corners: Vec<Vec3>,
    /// Velocity at the start in m/s. Read once.
    pub velocity: Vec3,
    /// Angular velocity at the start in rad/s, in world axes. Read once.
    pub angular_velocity: Vec3,
}

impl Default for RigidTetrahedron {
    /// A crate of 10 kg, half a metre wide.
    fn default() -> Self {
        Self::cuboid(10.0, Vec3::splat(0.25))
    }
}

impl RigidTetrahedron {
    /// A solid box of even density, of `mass` kilograms and these half sides (metres).
    pub fn cuboid(mass: f32, half_extents: Vec3) -> Self {
        let builder = RigidTetrahedronBuilder::cuboid(mass, half_extents);
        Self {
            mass,
            inertia: builder.inertia(),
            corners: builder.collision_mesh().to_vec(),
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
        }
    }

    /// Continues the motion between two frames of an animation that are `dt` seconds apart: sets the velocity and
    /// angular velocity from `previous` to `current`, the place of the entity. With `dt` zero nothing changes.
    #[must_use]
    pub fn with_motion(self, previous: &Transform, current: &Transform, dt: f32) -> Self {
        let velocity = (current.translation - previous.translation) / dt;
        let angular_velocity = (current.rotation * previous.rotation.inverse()).to_scaled_axis() / dt;
        if velocity.is_finite() && angular_velocity.is_finite() {
            Self { velocity, angular_velocity, ..self }
        } else {
            self
        }
    }

    /// Returns the positions of its particles in its own coordinates.
    fn local_particles(&self) -> Result<[Vec3; 4], BuildError> {
        RigidTetrahedronBuilder::new(self.mass, self.inertia).particles()
    }

    fn builder(&self) -> RigidTetrahedronBuilder {
        RigidTetrahedronBuilder::new(self.mass, self.inertia).corners(self.corners.iter().copied())
    }
}

impl Description for RigidTetrahedron {
    const NAME: &'static str = "RigidTetrahedron";

    fn build(&self, _: &Fabric, transform: &GlobalTransform) -> Result<BodyParts, BuildError> {
        let (_, rotation, translation) = transform.to_scale_rotation_translation();
        let builder = self.builder().placed(Placement { translation, rotation });
        let body = builder.moving(self.velocity, self.angular_velocity).build(BodySettings::default())?;
        Ok((body.particles, body.topology))
    }
}

/// The transform that the plugin wrote or read last; another one found there is a teleport.
#[derive(Component, Clone, Copy, Debug, Default)]
#[component(clone_behavior = Ignore)]
pub(crate) struct RigidPlace(Option<Transform>);

impl RigidPlace {
    /// Notes a transform as the plugin's own.
    pub fn set(&mut self, transform: Transform) {
        self.0 = Some(transform);
    }

    /// Makes the place `origin` the origin of the coordinates.
    pub fn shift_origin(&mut self, origin: Vec3) {
        self.0.iter_mut().for_each(|place| place.translation -= origin);
    }
}

type RigidQuery<'w, 's> = Query<
    'w,
    's,
    (
        &'static RigidTetrahedron,
        &'static GlobalTransform,
        &'static mut Transform,
        &'static mut Particles,
        &'static mut RigidPlace,
    ),
>;

/// Teleports bodies whose transform was set by hand.
pub(crate) fn teleport_rigid_tetrahedra(mut bodies: RigidQuery) {
    for (body, global, transform, mut particles, mut place) in &mut bodies {
        let Some(known) = place.0 else { continue };
        let has_moved = transform.translation != known.translation || transform.rotation != known.rotation;
        if !(has_moved && global.affine().is_finite()) {
            continue;
        }
        let Ok(local) = body.local_particles() else { continue };
        place.0 = Some(*transform);
        let Some(from) = placement(local, &particles) else { continue };
        let (_, rotation, translation) = global.to_scale_rotation_translation();
        let turn = rotation * from.rotation.inverse();
        for i in 0..particles.len() {
            let [arm, velocity] = [particles.position(i) - from.translation, particles.velocity(i)];
            particles.set_position(i, translation + turn * arm);
            particles.set_velocity(i, turn * velocity);
        }
    }
}

fn placement(local: [Vec3; 4], particles: &Particles) -> Option<Placement> {
    if particles.len() != local.len() {
        return None;
    }
    placement_of(local, core::array::from_fn(|i| particles.position(i)))
}

/// Writes the transforms of active bodies.
pub(crate) fn write_rigid_tetrahedra(
    mut bodies: Query<(
        &RigidTetrahedron,
        &Particles,
        &Activity,
        &mut Transform,
        &mut RigidPlace,
        Option<&ChildOf>,
    )>,
    globals: Query<&GlobalTransform>,
) {
    for (body, particles, activity, mut transform, mut place, child_of) in &mut bodies {
        if *activity != Activity::Active && place.0.is_some() {
            continue;
        }
        let Ok(local) = body.local_particles() else { continue };
        let Some(Placement { translation, rotation }) = placement(local, particles) else { continue };
        let parent = child_of.and_then(|child_of| globals.get(child_of.parent()).ok());
        let world = Transform { translation, rotation, scale: Vec3::ONE };
        let own = parent.map_or(world, |parent| GlobalTransform::from(world).reparented_to(parent));
        let written = Transform { scale: transform.scale, ..own };
        if written.is_finite() {
            transform.set_if_neq(written);
            place.0 = Some(written);
        }
    }
}
