//! Avian, as the tests that all bridges share see it.

use avian3d::prelude::*;
pub use avian3d::prelude::{Collider, ColliderDisabled, GravityScale, RigidBody, RigidBodyDisabled, Sensor};
use bevy::prelude::*;
use bevy_drape_avian::AvianDrapePlugin;
pub use bevy_drape_avian::{BodyObstacle, ColliderObstacle, NoObstacle, ObstacleOf};

pub const STATIC: RigidBody = RigidBody::Static;
pub const KINEMATIC: RigidBody = RigidBody::Kinematic;
pub const DYNAMIC: RigidBody = RigidBody::Dynamic;

pub fn add_engine(app: &mut App) {
    app.add_plugins(PhysicsPlugins::default());
}

pub fn add_bridge(app: &mut App) {
    app.add_plugins(AvianDrapePlugin::default());
}

pub fn set_gravity(app: &mut App, gravity: Vec3) {
    app.insert_resource(Gravity(gravity));
}

pub fn pause(app: &mut App) {
    let mut time = app.world_mut().resource_mut::<Time<Physics>>();
    if time.is_paused() {
        time.unpause();
    } else {
        time.pause();
    }
}

pub fn cuboid(size: Vec3) -> Collider {
    Collider::cuboid(size.x, size.y, size.z)
}

pub fn sphere(radius: f32) -> Collider {
    Collider::sphere(radius)
}

/// A capsule along Y, with `length` metres between the middles of its round ends.
pub fn capsule(radius: f32, length: f32) -> Collider {
    Collider::capsule(radius, length)
}

/// Everything below the plane through the origin.
pub fn half_space() -> Collider {
    Collider::half_space(Vec3::Y)
}

/// Each shape with its height above its middle, which is where its top is.
pub fn shapes() -> Vec<(&'static str, Collider, f32)> {
    let corners = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]].map(Vec3::from);
    let octahedron = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|p| p * 0.3);
    let voxels = [[-1, 0, -1], [-1, 0, 0], [0, 0, -1], [0, 0, 0]].map(IVec3::from);
    let part = |x| (Vec3::X * x, Quat::IDENTITY, Collider::cuboid(0.3, 0.4, 0.6));
    vec![
        ("sphere", Collider::sphere(0.3), 0.3),
        ("cuboid", Collider::cuboid(0.6, 0.4, 0.6), 0.2),
        ("round cuboid", Collider::round_cuboid(0.5, 0.3, 0.5, 0.05), 0.2),
        ("capsule", Collider::capsule(0.2, 0.3), 0.35),
        ("cylinder", Collider::cylinder(0.3, 0.4), 0.2),
        ("cone", Collider::cone(0.3, 0.5), 0.25),
        ("compound", Collider::compound(vec![part(-0.16), part(0.16)]), 0.2),
        ("trimesh", Collider::trimesh(corners.to_vec(), vec![[0, 2, 1], [0, 3, 2]]), 0.0),
        ("hull", Collider::convex_hull(&octahedron).expect("it has a volume"), 0.3),
        ("height field", Collider::heightfield(vec![vec![0.0; 5]; 5], Vec3::new(2.0, 1.0, 2.0)), 0.0),
        ("voxels", Collider::voxels(Vec3::splat(0.2), &voxels), 0.2),
    ]
}

/// The mass in kilograms of a body, and its moment of inertia about each axis in kg m^2, whatever its colliders.
pub fn mass(mass: f32, moment: f32) -> impl Bundle {
    (Mass(mass), AngularInertia::new(Vec3::splat(moment)), NoAutoMass, NoAutoAngularInertia)
}

/// The density of a collider in kg/m^3.
pub fn density(density: f32) -> impl Bundle {
    ColliderDensity(density)
}

pub fn moving(velocity: Vec3, spin: Vec3) -> impl Bundle {
    (LinearVelocity(velocity), AngularVelocity(spin))
}

/// A body that drifts to rest without weight, and does not turn.
pub fn drifting() -> impl Bundle {
    (GravityScale(0.0), LinearDamping(5.0), LockedAxes::ROTATION_LOCKED)
}

pub fn friction(coefficient: f32) -> impl Bundle {
    Friction::new(coefficient)
}

/// A coefficient of which the mean with that of the other counts.
pub fn restitution(coefficient: f32) -> impl Bundle {
    Restitution::new(coefficient)
}

pub fn friction_by_greater(coefficient: f32) -> impl Bundle {
    Friction::new(coefficient).with_combine_rule(CoefficientCombine::Max)
}

pub fn friction_by_product(coefficient: f32) -> impl Bundle {
    Friction::new(coefficient).with_combine_rule(CoefficientCombine::Multiply)
}

pub fn friction_by_smaller(coefficient: f32) -> impl Bundle {
    Friction::new(coefficient).with_combine_rule(CoefficientCombine::Min)
}

pub fn layers(memberships: u32, filters: u32) -> impl Bundle {
    CollisionLayers::new(LayerMask(memberships), LayerMask(filters))
}

/// Velocity and angular velocity.
pub fn velocities(app: &App, body: Entity) -> [Vec3; 2] {
    let body = app.world().entity(body);
    let velocity = body.get::<LinearVelocity>().expect("it is a body");
    [velocity.0, body.get::<AngularVelocity>().expect("it is a body").0]
}

pub fn is_asleep(app: &App, body: Entity) -> bool {
    app.world().entity(body).contains::<Sleeping>()
}

/// A body that never falls asleep.
pub fn sleepless() -> impl Bundle {
    SleepingDisabled
}
