//! The cost of the broad phase: many cloths among many obstacles, stepped by the plugin.
//!
//! Obstacles stand on a square grid, so that more of them take more room; cloths hang at random places among them. The
//! number of obstacles near a cloth is therefore independent of their total, and the time of a step should grow with
//! the number of cloths alone.

use std::error::Error;

use bevy::prelude::{Entity, Transform, UVec2, Vec2};
use bevy_drape::prelude::{Cloth, Obstacle, Particles};
use bevy_drape::schedule::StepTimes;
use bevy_drape::sleep::SceneManager;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use drape_solver::glam::Vec3;
use drape_solver::{Obstacles, Placement, Shape};

use crate::failure::Failure;
use crate::measure::median::median_us;
use crate::random::Random;
use crate::solvers::plugin;

/// Distance between obstacles, and their radius, in metres.
const SPACING: f32 = 1.0;
const RADIUS: f32 = 0.4;
/// Side of a cloth in metres, and particles along it.
const SIDE: f32 = 0.5;
const PARTICLES: u32 = 8;
/// Height of the middles of the cloths, in metres; those of the obstacles are at 0.
const HEIGHT: f32 = 0.3;
/// Steps before timing begins.
const WARM_UP: u32 = 60;

/// Arguments of `broad`.
#[derive(Args, Clone, Debug)]
pub struct BroadArguments {
    /// Numbers of obstacles.
    #[arg(long, value_delimiter = ',', default_values_t = [10, 100, 1000, 10_000])]
    obstacles: Vec<u32>,
    /// Numbers of cloths.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 10, 100, 1000])]
    cloths: Vec<u32>,
    /// One obstacle in so many moves in each step; 0 for none.
    #[arg(long, default_value_t = 0)]
    one_moves_in: u32,
    /// Steps that are timed; the medians count.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
}

/// Times of a step of one scene, in microseconds.
struct BroadCost {
    obstacles: u32,
    cloths: u32,
    /// Pairs of a cloth and an obstacle near it.
    pairs: usize,
    step: f64,
    /// The part of it that is collision detection.
    detect: f64,
}

/// Measures all scenes, and prints a table.
///
/// # Errors
/// If a scene cannot be stepped.
pub fn report(field: &BroadArguments) -> Result<(), Box<dyn Error>> {
    let mut costs = Vec::new();
    for &cloths in &field.cloths {
        for &obstacles in &field.obstacles {
            costs.push(measure(obstacles, cloths, field)?);
        }
    }
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    table.set_header(["obstacles", "cloths", "pairs near", "step, us", "search, us", "us per cloth"]);
    for cost in &costs {
        let BroadCost { obstacles, cloths, pairs, step, detect } = cost;
        let per_cloth = step / f64::from(*cloths);
        table.add_row([
            obstacles.to_string(),
            cloths.to_string(),
            pairs.to_string(),
            format!("{step:.1}"),
            format!("{detect:.1}"),
            format!("{per_cloth:.2}"),
        ]);
    }
    println!("{table}");
    println!("Slope of the time of a step, logarithm against logarithm:");
    for &cloths in &field.cloths {
        let of_same = costs.iter().filter(|cost| cost.cloths == cloths);
        let points: Vec<_> = of_same.map(|cost| (f64::from(cost.obstacles), cost.step)).collect();
        print_slope(&format!("by obstacles, {cloths} cloths"), &points);
    }
    for &obstacles in &field.obstacles {
        let of_same = costs.iter().filter(|cost| cost.obstacles == obstacles);
        let points: Vec<_> = of_same.map(|cost| (f64::from(cost.cloths), cost.step)).collect();
        print_slope(&format!("by cloths, {obstacles} obstacles"), &points);
    }
    Ok(())
}

fn print_slope(what: &str, points: &[(f64, f64)]) {
    if points.len() > 1 {
        println!("  {what}: {:.3}", slope(points));
    }
}

/// Slope of the line of least squares through the logarithms.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs = || points.iter().map(|(x, y)| (x.ln(), y.ln()));
    let count = points.len() as f64;
    let mean_x = logs().map(|(x, _)| x).sum::<f64>() / count;
    let mean_y = logs().map(|(_, y)| y).sum::<f64>() / count;
    let covariance: f64 = logs().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = logs().map(|(x, _)| (x - mean_x) * (x - mean_x)).sum();
    covariance / variance
}

fn measure(obstacles: u32, cloths: u32, field: &BroadArguments) -> Result<BroadCost, Failure> {
    let mut app = plugin::app(1)?;
    app.world_mut().resource_mut::<SceneManager>().sleeping = false;
    let side = f64::from(obstacles).sqrt().ceil() as u32;
    let place = |i: u32| Vec3::new((i % side) as f32, 0.0, (i / side) as f32) * SPACING;
    let mut solid = Obstacles::new();
    let mut spawned: Vec<Entity> = Vec::new();
    for i in 0..obstacles {
        let entity = (Obstacle::sphere(RADIUS), Transform::from_translation(place(i)));
        spawned.push(app.world_mut().spawn(entity).id());
        let shape = Shape::Sphere { radius: RADIUS };
        solid.push(drape_solver::Obstacle::new(shape, Placement::at(place(i)), 0.5)?);
    }
    let mut random = Random::new(1);
    let (width, depth) = (side as f32 * SPACING, obstacles.div_ceil(side) as f32 * SPACING);
    let mut bodies = Vec::new();
    for _ in 0..cloths {
        let x = random.between(0.0, f64::from(width)) as f32 - 0.5 * SPACING;
        let z = random.between(0.0, f64::from(depth)) as f32 - 0.5 * SPACING;
        let cloth = Cloth { size: Vec2::splat(SIDE), particles: UVec2::splat(PARTICLES), ..Cloth::default() };
        bodies.push(app.world_mut().spawn((cloth, Transform::from_xyz(x, HEIGHT, z))).id());
    }
    let (mut steps, mut searches) = (Vec::new(), Vec::new());
    for step in 0..WARM_UP + field.steps {
        if field.one_moves_in > 0 {
            let sway = 0.1 * (step as f32 * 0.1).sin();
            for (i, &entity) in spawned.iter().enumerate().step_by(field.one_moves_in as usize) {
                if let Some(mut transform) = app.world_mut().get_mut::<Transform>(entity) {
                    transform.translation = place(i as u32) + Vec3::X * sway;
                }
            }
        }
        app.update();
        if step >= WARM_UP {
            let times = app.world().resource::<StepTimes>();
            steps.push(times.step);
            searches.push(times.detect_collisions);
        }
    }
    let mut near = Vec::new();
    for &body in &bodies {
        if let Some(particles) = app.world().get::<Particles>(body) {
            let (low, high) = particles.bounds();
            solid.near(low, high, &mut near);
        }
    }
    let (step, detect) = (median_us(steps), median_us(searches));
    Ok(BroadCost { obstacles, cloths, pairs: near.len(), step, detect })
}
