//! A parachute of cloth carries a crate of Avian to the ground: canopy and lines are one mesh, tied to the crate.
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml -p drape_playground --example parachute --features avian,window`;
//! `--headless` runs without a window, and `--picture FILE` draws a picture with `--features avian,render`.

use core::f32::consts::{FRAC_PI_3, TAU};

use avian3d::prelude::*;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::render::WeldedVertices;
use bevy_drape_avian::AvianDrapePlugin;
use drape_examples::feature::{Feature, Paint, Verdict};
use drape_playground::{WOOD, paint_obstacle};

const FEATURE: Feature = Feature {
    title: "A parachute, and its crate in Avian",
    controls: "",
    eye: Vec3::new(9.5, 5.0, 26.0),
    target: Vec3::new(3.0, 8.4, 0.0),
    picture_time: 3.8,
    build: |app| {
        app.add_plugins((PhysicsPlugins::default(), AvianDrapePlugin::default()))
            // A breeze, as faces feel nothing of air that stands quite still. A cup catches more of it than a plate.
            .insert_resource(Wind { drag_coefficient: 1.6, ..Wind::new(Vec3::X) })
            .insert_resource(Verdict(judge))
            .init_resource::<Descent>()
            .add_observer(paint_obstacle)
            .add_systems(Startup, spawn)
            .add_systems(FixedLast, watch);
    },
};

fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Side of the crate in metres, its mass in kg, and its height at first.
const SIDE: f32 = 0.8;
const MASS: f32 = 40.0;
const START: f32 = 20.0;
/// Panels of the canopy, and the pieces of each, and of the line at its seam.
const GORES: u32 = 24;
const PIECES: u32 = 7;
/// The canopy is a part of a sphere of this radius in metres, with its vent and its skirt at these angles.
const RADIUS: f32 = 3.4;
const VENT: f32 = 0.06;
const SKIRT: f32 = FRAC_PI_3;
/// Height of the skirt above the middle of the crate, in metres.
const CLEARANCE: f32 = 7.0;
/// Every other gore, and the lines.
const COLOURS: [[f32; 4]; 3] = [[0.55, 0.04, 0.03, 1.0], [0.92, 0.90, 0.84, 1.0], [0.20, 0.19, 0.17, 1.0]];

/// Each line: a vertex of the mesh at the skirt, one at the crate, and the length between them in metres.
#[derive(Component, Default)]
struct Lines(Vec<(usize, usize, f32)>);

#[derive(Component)]
struct Crate;

/// Speed in m/s shortly before landing, and the shortest and the longest line in parts of their lengths.
#[derive(Resource, Default)]
struct Descent(f32, [f32; 2]);

/// Canopy and lines around the crate, sewn of strips of triangles: vertices in one place become one particle.
fn parachute() -> (Mesh, Lines) {
    let (mut places, mut colours, mut corners) = (Vec::<Vec3>::new(), Vec::new(), Vec::new());
    let mut sew = |strip: Vec<Vec3>, colour: u32| {
        let first = places.len() as u32;
        let turned = |i: u32| [i + 1 - i % 2, i + i % 2, i + 2];
        corners.extend((0..strip.len() as u32 - 2).flat_map(turned).map(|corner| first + corner));
        places.extend(strip);
        colours.resize(places.len(), COLOURS[colour as usize]);
        places.len() - 1
    };
    let around = |seam: u32| Quat::from_rotation_y(TAU * (seam as f32 + 0.5) / GORES as f32);
    let on_canopy = |seam: u32, piece: u32| {
        let (sin, cos) = ops::sin_cos(VENT + (SKIRT - VENT) * piece as f32 / PIECES as f32);
        around(seam) * Vec3::new(RADIUS * sin, CLEARANCE + RADIUS * (cos - ops::cos(SKIRT)), 0.0)
    };
    let mut lines = Lines::default();
    for seam in 0..GORES {
        let rows = (0..=PIECES).flat_map(|piece| [seam + 1, seam].map(|seam| on_canopy(seam, piece)));
        let skirt = sew(rows.collect(), seam % 2);
        // A narrow tape to the edge of the crate. Tied to a point inside, the canopy would fall through the crate.
        let from = on_canopy(seam, PIECES);
        let to = (from * Vec3::new(1.0, 0.0, 1.0) / from.x.abs().max(from.z.abs()) + Vec3::Y) * 0.505 * SIDE;
        let middle = (1..PIECES).map(|link| from.lerp(to, link as f32 / PIECES as f32));
        let aside = around(seam) * Vec3::Z * 0.015;
        let sides = middle.flat_map(|place| [place - aside, place + aside]);
        let end = sew([from].into_iter().chain(sides).chain([to]).collect(), 2);
        lines.0.push((skirt, end, from.distance(to)));
    }
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colours)
        .with_inserted_indices(Indices::U32(corners));
    (mesh.with_computed_normals(), lines)
}

fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    commands.spawn((RigidBody::Static, Collider::half_space(Vec3::Y)));
    let place = Transform::from_xyz(0.0, START, 0.0);
    let body = (RigidBody::Dynamic, Collider::cuboid(SIDE, SIDE, SIDE), Mass(MASS));
    let load = commands.spawn((Crate, body, place, WOOD)).id();
    let (mesh, lines) = parachute();
    let paint = ClothPaint { pins: None, ..default() };
    let pins = lines.0.iter().map(|line| line.1 as u32).collect();
    let cloth = (ClothMesh { paint, pins, ..default() }, Mesh3d(meshes.add(mesh)), Paint::rgb(1.0, 1.0, 1.0));
    let fabric = Fabric { areal_density: 0.12, bend_stiffness: 0.02, ..default() };
    let settings = SolverSettings { substeps: 16, ..default() };
    // The ends of the lines follow the crate, and pull at it.
    commands.spawn((cloth, fabric, settings, Attachment::pinned(load), lines, place));
}

fn watch(
    load: Single<(&Transform, &LinearVelocity), With<Crate>>,
    parachute: Single<(&Particles, &WeldedVertices, &Lines)>,
    mut descent: ResMut<Descent>,
) {
    let (particles, welded, Lines(lines)) = *parachute;
    if (2.0..4.0).contains(&load.0.translation.y) {
        let place = |vertex| welded.particle(vertex).map_or(Vec3::MAX, |i| particles.position(i));
        let parts = lines.iter().map(|&(from, to, length)| place(from).distance(place(to)) / length);
        let range = parts.fold([f32::MAX, 0.0], |[low, high], part| [low.min(part), high.max(part)]);
        *descent = Descent(-load.1.y, range);
    }
}

fn judge(world: &mut World) -> Result<String, String> {
    let &Descent(speed, [short, long]) = world.resource();
    let mut loads = world.query_filtered::<(&Position, &LinearVelocity), With<Crate>>();
    let (&Position(at), &LinearVelocity(motion)) = loads.single(world).map_err(|error| error.to_string())?;
    let particles = world.query::<&Particles>().single(world).map_err(|error| error.to_string())?;
    let range = |[low, high]: [f32; 2], place: Vec3| [low.min(place.y), high.max(place.y)];
    let [low, high] = particles.positions().fold([f32::MAX, 0.0], range);
    let free = (0..particles.len()).filter(|&i| !particles.is_pinned(i));
    let mass = MASS + free.map(|i| 1.0 / particles.inverse_mass(i)).sum::<f32>();
    // At terminal speed the drag on the area of the mouth, 1/2 rho C_d A v^2, is as great as the weight.
    let drag = 2.0 * mass * 9.81 / (1.2 * Circle::new(RADIUS * ops::sin(SKIRT)).area() * speed * speed);
    let finding = format!(
        "{mass:.1} kg come down at {speed:.2} m/s, with a drag coefficient of {drag:.2}; lines are {short:.4} to {long:.4} \
         of their lengths; the crate lies at {at:.2}, the canopy from {low:.3} m to {high:.2} m above the ground"
    );
    let is_carried = (0.7..1.5).contains(&drag) && short > 0.99 && long < 1.01;
    let is_down = (at.y - 0.5 * SIDE).abs() < 0.02 && motion.length() < 0.1 && low > 0.0 && high < 2.0;
    if is_carried && is_down { Ok(finding) } else { Err(finding) }
}
