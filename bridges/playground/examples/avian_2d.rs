//! Two dimensions, in Avian 2D: a character walks through a curtain in the plane, and a rope falls on a heap of balls and crates.
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml -p drape_playground --example avian_2d --features avian2d,window`;
//! `--headless` runs without a window, and `--picture FILE` draws a picture with `--features avian2d,render`.

use core::f32::consts::FRAC_PI_2;

use avian2d::prelude::*;
use bevy::prelude::*;
use bevy_drape::attach::PlaneLock;
use bevy_drape::prelude::*;
use bevy_drape_avian2d::Avian2dDrapePlugin;
use drape_examples::feature::{Feature, Paint, Verdict};
use drape_playground::{COAT, HEMP, STEEL, WOOD};

const FEATURE: Feature = Feature {
    title: "A curtain and a rope among the bodies of Avian 2D",
    controls: "",
    eye: Vec3::new(0.1, 1.5, 5.4),
    target: Vec3::new(0.1, 1.05, 0.0),
    picture_time: 2.6,
    build: |app| {
        app.add_plugins((PhysicsPlugins::default(), Avian2dDrapePlugin::default()))
            .insert_resource(Gravity(Vec2::NEG_Y * 9.81))
            .insert_resource(Verdict(judge))
            .add_systems(Startup, (spawn_fixtures, spawn_character, drop_heap, hang_cloth))
            .add_systems(FixedUpdate, turn_round);
    },
};

fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// The middle of the curtain, its size, and the way of the character to both sides, in metres.
const CURTAIN: Vec2 = Vec2::new(-1.3, 1.25);
const CURTAIN_SIZE: Vec2 = Vec2::new(0.9, 1.5);
const WAY: f32 = 1.0;
/// Speed of the character in m/s.
const WALK: f32 = 0.9;
/// The walls around the heap, at this distance from its middle, and their height, in metres.
const HEAP: f32 = 1.2;
const HALF_WIDTH: f32 = 0.75;
const WALL: f32 = 0.8;
/// Depth in metres at which a particle counts as inside a collider.
const INSIDE: f32 = 0.01;

#[derive(Component)]
struct Character;

#[derive(Component)]
struct Heaped;

/// A body that is drawn flat. Its prism is not drawn, as it has a mesh, if an empty one; in its place is an obstacle that touches
/// nothing.
fn flat(body: RigidBody, collider: Collider, looks: Obstacle, at: Transform, paint: Paint) -> impl Bundle {
    let is_cylinder = matches!(looks.shape, ObstacleShape::Cylinder { .. });
    let turn = Transform::from_rotation(Quat::from_rotation_x(if is_cylinder { FRAC_PI_2 } else { 0.0 }));
    let looks = (looks, DrapeLayers::new(0, 0), paint, turn);
    (body, collider, at, Mesh3d::default(), Visibility::default(), children![looks])
}

fn crate_of(body: RigidBody, size: Vec2, at: Transform, paint: Paint) -> impl Bundle {
    flat(body, Collider::rectangle(size.x, size.y), Obstacle::cuboid(size.x, size.y, 0.2), at, paint)
}

fn spawn_fixtures(mut commands: Commands) {
    commands.spawn((RigidBody::Static, Collider::half_space(Vec2::Y)));
    for side in [-1.0, 1.0] {
        let at = Transform::from_xyz(HEAP + side * HALF_WIDTH, 0.5 * WALL, 0.0);
        commands.spawn(crate_of(RigidBody::Static, Vec2::new(0.08, WALL), at, STEEL));
    }
    let rail = Transform::from_xyz(CURTAIN.x, CURTAIN.y + 0.5 * CURTAIN_SIZE.y + 0.06, 0.0);
    commands.spawn(crate_of(RigidBody::Static, Vec2::new(1.2, 0.06), rail, STEEL));
}

fn spawn_character(mut commands: Commands) {
    let looks = Obstacle::capsule(0.22, 0.6);
    let at = Transform::from_xyz(CURTAIN.x - WAY, 0.56, 0.0);
    let body = flat(RigidBody::Kinematic, Collider::capsule(0.22, 0.6), looks, at, COAT);
    commands.spawn((Character, body, LinearVelocity(Vec2::X * WALK)));
}

fn turn_round(mut characters: Query<(&Transform, &mut LinearVelocity), With<Character>>) {
    for (place, mut velocity) in &mut characters {
        let way = place.translation.x - CURTAIN.x;
        if way.abs() > WAY {
            velocity.x = -way.signum() * WALK;
        }
    }
}

fn drop_heap(mut commands: Commands) {
    for index in 0..9 {
        let (column, row) = ((index % 3) as f32 - 1.0, (index / 3) as f32);
        let at = Transform::from_xyz(HEAP + 0.4 * column, 0.3 + 0.45 * row, 0.0);
        if index % 2 == 0 {
            let at = at.with_rotation(Quat::from_rotation_z(0.4 * row));
            commands.spawn((Heaped, crate_of(RigidBody::Dynamic, Vec2::new(0.3, 0.26), at, WOOD)));
        } else {
            let looks = Obstacle::cylinder(0.16, 0.2);
            commands.spawn((Heaped, flat(RigidBody::Dynamic, Collider::circle(0.16), looks, at, STEEL)));
        }
    }
}

fn hang_cloth(mut commands: Commands) {
    let curtain = Cloth::new(CURTAIN_SIZE.x, CURTAIN_SIZE.y).with_spacing(0.05);
    // Nothing but the sticks to the left and up.
    let fabric = Fabric { shear_stiffness: 0.0, bend_stiffness: 0.0, ..default() };
    let (velvet, place) = (Paint::rgb(0.60, 0.13, 0.16), Transform::from_translation(CURTAIN.extend(0.0)));
    commands.spawn((curtain, fabric, PlaneLock::default(), velvet, place));
    let above = Vec3::new(HEAP, 2.3, 0.0);
    let rope = Rope::new(above - Vec3::X * 1.1, above + Vec3::X * 1.1, 80);
    let rope = (Rope { pin_start: false, ..rope }, RopeMesh::new(0.02), HEMP);
    commands.spawn((rope, PlaneLock::default()));
}

fn judge(world: &mut World) -> Result<String, String> {
    let mut bodies = world.query::<(&Collider, &Position, &Rotation, Has<Heaped>)>();
    let mut deepest = 0.0_f32;
    for at in world.query::<&Particles>().iter(world).flat_map(|body| body.positions()) {
        if at.z.abs() > 1e-3 || at.y < -INSIDE {
            return Err(format!("a particle is out of the plane or below the ground, at {at}"));
        }
        for (collider, place, rotation, _) in bodies.iter(world) {
            let (surface, is_inside) = collider.project_point(place.0, *rotation, at.truncate(), false);
            deepest = deepest.max(if is_inside { surface.distance(at.truncate()) } else { 0.0 });
        }
    }
    if deepest > INSIDE {
        return Err(format!("a particle is {deepest} m deep in a collider"));
    }
    let is_away = |at: &Position| (at.x - HEAP).abs() > HALF_WIDTH;
    if let Some((_, at, ..)) = bodies.iter(world).find(|(_, at, _, is_heaped)| *is_heaped && is_away(at)) {
        return Err(format!("a body has left the heap, to {}", at.0));
    }
    let mut ropes = world.query_filtered::<&Particles, With<Rope>>();
    let rope = ropes.single(world).map_err(|error| error.to_string())?;
    let highest = rope.positions().map(|at| at.y).fold(0.0, f32::max);
    if !(WALL..1.5).contains(&highest) {
        return Err(format!("the rope does not lie on the heap: it reaches {highest} m"));
    }
    Ok(format!(
        "particles are at most {:.1} mm inside; the rope lies on the heap, {highest:.2} m up",
        1e3 * deepest
    ))
}
