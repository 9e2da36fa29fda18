//! Measures the cost per particle of each kind of contact.
//!
//! A cloth lies on each shape. Steps with and without the contact start from the same state, in turns; the difference
//! of their times is the cost of the contact.

use std::error::Error;
use std::time::{Duration, Instant};

use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::{
    Ball, BallMaterial, Body, BodySettings, BuildError, ClothBuilder, Edge, Environment, Island, Obstacle,
    Obstacles, Placement, SelfContact, Shape, StepError, step,
};

use crate::measure::median::median_us;

/// Side of the cloth in metres.
const SIDE: f32 = 1.0;
/// Its thickness in metres.
const THICKNESS: f32 = 0.01;
/// Steps until it lies still.
const SETTLING: u32 = 180;

/// Arguments of `contacts`.
#[derive(Args, Clone, Debug)]
pub struct ContactArguments {
    /// Particles along a side of the cloth.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(4..=1024))]
    n: u32,
    /// Number of timed steps with and without the contact; the medians count.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    repeat: u32,
}

/// An island at rest with a contact, and the same without.
struct Case {
    name: &'static str,
    with: (Island, Environment),
    without: (Island, Environment),
}

/// Measures all kinds, and prints a table.
///
/// # Errors
/// If a scene cannot be made or stepped.
pub fn report(trials: &ContactArguments) -> Result<(), Box<dyn Error>> {
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header([
        "contact",
        "touching",
        "substeps",
        "step with, us",
        "without, us",
        "ns per particle and substep",
    ]);
    for case in cases(trials.n)? {
        let touching = case.with.0.body_contacts(0).count();
        let [with, without] = medians(&case, trials.repeat)?;
        let substeps = [&case.with, &case.without].map(|(island, _)| f64::from(island.substeps()));
        let particles = f64::from(trials.n * trials.n);
        table.add_row([
            case.name.to_string(),
            touching.to_string(),
            substeps[0].to_string(),
            format!("{with:.0}"),
            format!("{without:.0}"),
            format!("{:.2}", (with / substeps[0] - without / substeps[1]) * 1e3 / particles),
        ]);
    }
    println!("{table}");
    Ok(())
}

/// Medians of both steps of a case, in microseconds.
fn medians(case: &Case, repeat: u32) -> Result<[f64; 2], StepError> {
    let mut times: [Vec<Duration>; 2] = Default::default();
    let sides = [&case.with, &case.without];
    let mut islands = sides.map(|(island, _)| island.clone());
    for _ in 0..repeat {
        for ((times, (start, environment)), island) in times.iter_mut().zip(sides).zip(&mut islands) {
            // Into the same memory, which is warm.
            for (body, start) in island.bodies.iter_mut().zip(&start.bodies) {
                body.particles.clone_from(&start.particles);
            }
            island.balls.clone_from(&start.balls);
            let began = Instant::now();
            step(island, environment)?;
            times.push(began.elapsed());
        }
    }
    Ok(times.map(median_us))
}

/// A free, level cloth at this height in metres.
fn sheet(n: u32, height: f32, thickness: f32) -> Result<Body, BuildError> {
    let settings = BodySettings { thickness, drag: 3.0, ..BodySettings::default() };
    let corner = Vec3::new(-0.5 * SIDE, height, 0.5 * SIDE);
    ClothBuilder::new(SIDE, SIDE, n, n).placed(corner, Vec3::X, Vec3::NEG_Z).build(settings)
}

fn settle(island: &mut Island, environment: &Environment) -> Result<(), StepError> {
    (0..SETTLING).try_for_each(|_| step(island, environment))
}

fn cases(n: u32) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut cases = Vec::new();
    for (name, shape) in shapes() {
        // On its highest point; a container and a half-space have theirs at 0.
        let top = match &shape {
            Shape::HalfSpace { .. } | Shape::Container { .. } => 0.0,
            _ => -0.5,
        };
        let middle = if matches!(shape, Shape::Container { .. }) { 2.0 } else { top };
        let rotation = match shape {
            Shape::Capsule { .. } | Shape::TaperedCapsule { .. } => {
                Quat::from_rotation_z(core::f32::consts::FRAC_PI_2)
            }
            _ => Quat::IDENTITY,
        };
        let placement = Placement { translation: Vec3::Y * middle, rotation };
        cases.push(on_obstacle(name, Obstacle::new(shape, placement, 2.0)?, n, THICKNESS)?);
    }
    cases.push(over_a_rail(n)?);
    let environment = Environment::default();
    let settings = BodySettings { drag: 3.0, ..BodySettings::default() };
    let corner = Vec3::new(-0.5 * SIDE, 0.0, 0.5 * SIDE);
    let mut pinned = ClothBuilder::new(SIDE, SIDE, n, n).placed(corner, Vec3::X, Vec3::NEG_Z);
    for edge in [Edge::Top, Edge::Bottom] {
        pinned = pinned.pin_edge(edge);
    }
    let mut island = Island::of_body(pinned.build(settings)?);
    settle(&mut island, &environment)?;
    let material = BallMaterial { radius: 0.2, mass: 0.05, ..BallMaterial::default() };
    let mut with_ball = island.clone();
    with_ball.balls.push(Ball::new(material, Vec3::Y * 0.22, Vec3::ZERO)?);
    settle(&mut with_ball, &environment)?;
    let without = Island { balls: Vec::new(), ..with_ball.clone() };
    cases.push(Case {
        name: "ball on the cloth",
        with: (with_ball, environment.clone()),
        without: (without, environment),
    });
    cases.push(folded(n)?);
    Ok(cases)
}

/// A cloth of this thickness in metres at rest on an obstacle that reaches up to 0.
fn on_obstacle(
    name: &'static str,
    obstacle: Obstacle,
    n: u32,
    thickness: f32,
) -> Result<Case, Box<dyn Error>> {
    let environment = Environment { obstacles: [obstacle].into(), ..Environment::default() };
    let mut island = Island::of_body(sheet(n, thickness + 0.001, thickness)?);
    settle(&mut island, &environment)?;
    let bare = Environment { obstacles: Obstacles::new(), ..environment.clone() };
    Ok(Case { name, without: (island.clone(), bare), with: (island, environment) })
}

/// A cloth so thin that its faces touch the rail over which it hangs.
fn over_a_rail(n: u32) -> Result<Case, Box<dyn Error>> {
    let rail = Shape::Capsule { half_length: 0.6, radius: 0.1 };
    let rotation = Quat::from_rotation_z(core::f32::consts::FRAC_PI_2);
    let obstacle = Obstacle::new(rail, Placement { translation: Vec3::Y * -0.1, rotation }, 2.0)?;
    on_obstacle("faces on a rail", obstacle, n, 0.001)
}

/// A cloth that was dropped on its edge.
fn folded(n: u32) -> Result<Case, Box<dyn Error>> {
    let thickness = 0.5 * SIDE / n as f32;
    let settings =
        BodySettings { thickness, self_contact: SelfContact::On, drag: 1.0, ..BodySettings::default() };
    let cloth = ClothBuilder::new(SIDE, SIDE, n, n)
        .placed(Vec3::new(0.0, SIDE, 0.0), Vec3::X, Vec3::new(0.0, -0.995, 0.0998))
        .build(settings)?;
    let mut island = Island::of_body(cloth);
    let environment = Environment { obstacles: [Obstacle::ground()].into(), ..Environment::default() };
    settle(&mut island, &environment)?;
    let mut without = island.clone();
    without.bodies[0].settings.self_contact = SelfContact::Off;
    Ok(Case { name: "itself", with: (island, environment.clone()), without: (without, environment) })
}

/// One shape of each kind, about a metre wide, with its top half a metre above its centre.
fn shapes() -> Vec<(&'static str, Shape)> {
    let cube: Vec<Vec3> =
        (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5).collect();
    let (vertices, faces) = bumps();
    let mut shapes = vec![
        ("half-space", Shape::HalfSpace { normal: Vec3::Y }),
        ("ball", Shape::Sphere { radius: 0.5 }),
        ("capsule", Shape::Capsule { half_length: 0.6, radius: 0.5 }),
        ("tapered capsule", Shape::TaperedCapsule { half_length: 0.6, bottom_radius: 0.5, top_radius: 0.4 }),
        ("cuboid", Shape::Cuboid { half_extents: Vec3::new(0.6, 0.5, 0.6) }),
        ("container", Shape::Container { half_extents: Vec3::splat(2.0) }),
    ];
    shapes.extend(SharedShape::convex_hull(&cube).map(|hull| ("convex hull", Shape::Parry(hull))));
    shapes
        .extend(SharedShape::trimesh(vertices, faces).ok().map(|mesh| ("triangle mesh", Shape::Parry(mesh))));
    shapes
}

/// A mesh of 800 triangles like an egg box.
fn bumps() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const SIDE: u32 = 21;
    let vertex = |i: u32| {
        let (x, z) = ((i % SIDE) as f32 * 0.06 - 0.6, (i / SIDE) as f32 * 0.06 - 0.6);
        Vec3::new(x, 0.48 + 0.02 * (12.0 * x).sin() * (12.0 * z).sin(), z)
    };
    let mut faces = Vec::new();
    for row in 0..SIDE - 1 {
        for column in 0..SIDE - 1 {
            let i = row * SIDE + column;
            faces.push([i, i + SIDE, i + 1]);
            faces.push([i + 1, i + SIDE, i + SIDE + 1]);
        }
    }
    ((0..SIDE * SIDE).map(vertex).collect(), faces)
}
