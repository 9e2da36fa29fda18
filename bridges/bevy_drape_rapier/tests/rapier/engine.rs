//! Rapier, as the tests that all bridges share see it.

use bevy::prelude::*;
use bevy_drape_rapier::RapierDrapePlugin;
pub use bevy_drape_rapier::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};
use bevy_rapier3d::plugin::context::{RapierContextEntityLink, RapierRigidBodySet};
use bevy_rapier3d::plugin::{RapierConfiguration, RapierPhysicsPlugin};
use bevy_rapier3d::prelude::*;
pub use bevy_rapier3d::prelude::{
    Collider, ColliderDisabled, GravityScale, RigidBody, RigidBodyDisabled, Sensor,
};

pub const STATIC: RigidBody = RigidBody::Fixed;
pub const KINEMATIC: RigidBody = RigidBody::KinematicVelocityBased;
pub const DYNAMIC: RigidBody = RigidBody::Dynamic;

pub fn add_engine(app: &mut App) {
    app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule());
}

pub fn add_bridge(app: &mut App) {
    app.add_plugins(RapierDrapePlugin::default());
}

fn configuration(app: &mut App) -> Mut<'_, RapierConfiguration> {
    let world = app.world_mut();
    let mut all = world.query::<&mut RapierConfiguration>();
    all.single_mut(world).expect("there is one world")
}

pub fn set_gravity(app: &mut App, gravity: Vec3) {
    configuration(app).gravity = gravity;
}

pub fn pause(app: &mut App) {
    let mut configuration = configuration(app);
    configuration.physics_pipeline_active = !configuration.physics_pipeline_active;
}

pub fn cuboid(size: Vec3) -> Collider {
    Collider::cuboid(0.5 * size.x, 0.5 * size.y, 0.5 * size.z)
}

pub fn sphere(radius: f32) -> Collider {
    Collider::ball(radius)
}

/// A capsule along Y, with `length` metres between the middles of its round ends.
pub fn capsule(radius: f32, length: f32) -> Collider {
    Collider::capsule_y(0.5 * length, radius)
}

/// Everything below the plane through the origin.
pub fn half_space() -> Collider {
    Collider::halfspace(Vec3::Y).expect("a direction")
}

/// Each shape with its height above its middle, which is where its top is.
pub fn shapes() -> Vec<(&'static str, Collider, f32)> {
    let corners = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]].map(Vec3::from);
    let octahedron = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|p| p * 0.3);
    let voxels = [[-1, 0, -1], [-1, 0, 0], [0, 0, -1], [0, 0, 0]].map(IVec3::from);
    let part = |x| (Vec3::X * x, Quat::IDENTITY, cuboid(Vec3::new(0.3, 0.4, 0.6)));
    let trimesh = Collider::trimesh(corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]]);
    vec![
        ("sphere", Collider::ball(0.3), 0.3),
        ("cuboid", cuboid(Vec3::new(0.6, 0.4, 0.6)), 0.2),
        ("round cuboid", Collider::round_cuboid(0.25, 0.15, 0.25, 0.05), 0.2),
        ("capsule", Collider::capsule_y(0.15, 0.2), 0.35),
        ("cylinder", Collider::cylinder(0.2, 0.3), 0.2),
        ("cone", Collider::cone(0.25, 0.3), 0.25),
        ("compound", Collider::compound(vec![part(-0.16), part(0.16)]), 0.2),
        ("trimesh", trimesh.expect("it has faces"), 0.0),
        ("hull", Collider::convex_hull(&octahedron).expect("it has a volume"), 0.3),
        ("height field", Collider::heightfield(vec![0.0; 25], 5, 5, Vec3::new(2.0, 1.0, 2.0)), 0.0),
        ("voxels", Collider::voxels(Vec3::splat(0.2), &voxels), 0.2),
    ]
}

/// The mass in kilograms of a body, and its moment of inertia about each axis in kg m^2, whatever its colliders.
pub fn mass(mass: f32, moment: f32) -> impl Bundle {
    let properties = MassProperties { mass, principal_inertia: Vec3::splat(moment), ..default() };
    (ColliderMassProperties::Density(0.0), AdditionalMassProperties::MassProperties(properties))
}

/// The density of a collider in kg/m^3.
pub fn density(density: f32) -> impl Bundle {
    ColliderMassProperties::Density(density)
}

pub fn moving(velocity: Vec3, spin: Vec3) -> impl Bundle {
    Velocity { linear: velocity, angular: spin }
}

/// A body that drifts to rest without weight, and does not turn.
pub fn drifting() -> impl Bundle {
    let damping = Damping { linear_damping: 5.0, angular_damping: 0.0 };
    (GravityScale(0.0), damping, LockedAxes::ROTATION_LOCKED)
}

pub fn friction(coefficient: f32) -> impl Bundle {
    Friction::new(coefficient)
}

fn friction_by(coefficient: f32, combine_rule: CoefficientCombineRule) -> impl Bundle {
    Friction { coefficient, combine_rule }
}

/// A coefficient of which the mean with that of the other counts.
pub fn restitution(coefficient: f32) -> impl Bundle {
    Restitution::coefficient(coefficient)
}

pub fn friction_by_greater(coefficient: f32) -> impl Bundle {
    friction_by(coefficient, CoefficientCombineRule::Max)
}

pub fn friction_by_product(coefficient: f32) -> impl Bundle {
    friction_by(coefficient, CoefficientCombineRule::Multiply)
}

pub fn friction_by_smaller(coefficient: f32) -> impl Bundle {
    friction_by(coefficient, CoefficientCombineRule::Min)
}

pub fn layers(memberships: u32, filters: u32) -> impl Bundle {
    CollisionGroups::new(Group::from_bits_retain(memberships), Group::from_bits_retain(filters))
}

fn body(app: &App, body: Entity) -> &bevy_rapier3d::rapier::dynamics::RigidBody {
    let world = app.world();
    let link = world.get::<RapierContextEntityLink>(body).expect("it is in a world");
    let set = world.get::<RapierRigidBodySet>(link.0).expect("the world has bodies");
    let handle = world.get::<RapierRigidBodyHandle>(body).expect("it is a body");
    set.bodies.get(handle.0).expect("the body is there")
}

/// Velocity and angular velocity.
pub fn velocities(app: &App, entity: Entity) -> [Vec3; 2] {
    let body = body(app, entity);
    [body.linvel(), body.angvel()]
}

pub fn is_asleep(app: &App, entity: Entity) -> bool {
    body(app, entity).is_sleeping()
}

/// A body that never falls asleep.
pub fn sleepless() -> impl Bundle {
    Sleeping::disabled()
}
