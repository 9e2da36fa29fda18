//! Apps, sheets and shapes of the tests.

use std::time::Duration;

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use bevy_drape_avian::AvianDrapePlugin;

/// Bevy's default fixed step.
pub const TIMESTEP: Duration = Duration::from_micros(15_625);

/// Avian and cloth.
pub fn app() -> App {
    let mut app = avian();
    app.add_plugins((DrapePlugins::default(), AvianDrapePlugin::default()));
    started(app)
}

/// Avian alone.
pub fn app_without_cloth() -> App {
    started(avian())
}

fn avian() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(TIMESTEP));
    app
}

fn started(mut app: App) -> App {
    app.finish();
    app.cleanup();
    app.update();
    app
}

pub fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds / TIMESTEP.as_secs_f32()).round() as usize {
        app.update();
    }
}

/// A square sheet that lies in the air `height` metres above the ground.
pub fn sheet(app: &mut App, height: f32) -> Entity {
    let lying = Transform::from_xyz(0.0, height, 0.0)
        .with_rotation(Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2));
    let cloth = Cloth::new(0.8, 0.8).with_particles(17, 17).with_pins(ClothPins::None);
    app.world_mut().spawn((cloth, lying)).id()
}

pub fn heights(app: &App, body: Entity) -> impl Iterator<Item = f32> {
    let particles = app.world().get::<Particles>(body).expect("the body is built");
    particles.positions().map(|p| p.y).collect::<Vec<_>>().into_iter()
}

pub fn least(app: &App, body: Entity) -> f32 {
    heights(app, body).fold(f32::INFINITY, f32::min)
}

pub fn greatest(app: &App, body: Entity) -> f32 {
    heights(app, body).fold(f32::NEG_INFINITY, f32::max)
}

/// Each shape with its height above its middle, which is where its top is.
pub fn shapes() -> Vec<(&'static str, Collider, f32)> {
    let corners = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]].map(Vec3::from);
    let octahedron = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|p| p * 0.3);
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
        ("voxels", Collider::voxels(Vec3::splat(0.2), &[IVec3::ZERO, IVec3::X, IVec3::Z]), 0.2),
    ]
}
