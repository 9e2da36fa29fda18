//! Obstacles of cloth itself in the place of an engine's bodies: nothing but cloth, ropes and balls moves them.

use bevy::prelude::*;
use bevy_drape::environment::CombineRule;
use bevy_drape::prelude::*;

/// Obstacles are static unless they have a mass.
pub const STATIC: () = ();
pub const DYNAMIC: () = ();

#[derive(Component)]
struct Friction(f32);

#[derive(Component)]
struct Restitution(f32);

#[derive(Component)]
struct Motion(Vec3, Vec3);

pub fn add_engine(app: &mut App) {
    app.add_observer(|of: On<Insert<Friction>>, mut all: Query<(&mut Obstacle, &Friction)>| {
        if let Ok((mut obstacle, friction)) = all.get_mut(of.entity) {
            obstacle.friction = friction.0;
            obstacle.friction_rule = CombineRule::Average;
        }
    });
    app.add_observer(|of: On<Insert<Restitution>>, mut all: Query<(&mut Obstacle, &Restitution)>| {
        if let Ok((mut obstacle, restitution)) = all.get_mut(of.entity) {
            obstacle.restitution = restitution.0;
            obstacle.restitution_rule = CombineRule::Average;
        }
    });
    app.add_observer(|of: On<Insert<Motion>>, mut all: Query<(&mut DynamicObstacle, &Motion)>| {
        if let Ok((mut obstacle, &Motion(velocity, spin))) = all.get_mut(of.entity) {
            (obstacle.velocity, obstacle.angular_velocity) = (velocity, spin);
        }
    });
}

pub fn add_bridge(_: &mut App) {}

pub fn set_gravity(app: &mut App, gravity: Vec3) {
    app.insert_resource(DrapeGravity(gravity));
}

pub fn cuboid(size: Vec3) -> Obstacle {
    Obstacle::cuboid(size.x, size.y, size.z)
}

/// A capsule along Y, with `length` metres between the middles of its round ends.
pub fn capsule(radius: f32, length: f32) -> Obstacle {
    Obstacle::capsule(radius, length)
}

/// Everything below the plane through the origin.
pub fn half_space() -> Obstacle {
    Obstacle::ground()
}

/// The mass in kilograms of a body, and its moment of inertia about each axis in kg m^2.
pub fn mass(mass: f32, moment: f32) -> impl Bundle {
    DynamicObstacle::new(mass, Vec3::splat(moment))
}

pub fn moving(velocity: Vec3, spin: Vec3) -> impl Bundle {
    Motion(velocity, spin)
}

pub fn friction(coefficient: f32) -> impl Bundle {
    Friction(coefficient)
}

/// A coefficient of which the mean with that of the other counts.
pub fn restitution(coefficient: f32) -> impl Bundle {
    Restitution(coefficient)
}

/// Velocity and angular velocity.
pub fn velocities(app: &App, body: Entity) -> [Vec3; 2] {
    let body = app.world().get::<DynamicObstacle>(body).expect("it is a body");
    [body.velocity, body.angular_velocity]
}

/// Obstacles of cloth itself never fall asleep.
pub fn sleepless() -> impl Bundle {}
