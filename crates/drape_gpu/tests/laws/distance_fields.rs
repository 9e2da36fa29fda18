//! Obstacles without a formula, which collide by a field of distances.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::shape::{Ball, SharedShape};
use drape_solver::parry3d::utils::Array2;
use drape_solver::{BodySettings, Environment, Obstacle, Placement, Shape};

use crate::common::*;

/// Thickness of the cloth in metres.
const THICKNESS: f32 = 0.01;

fn parry(shape: SharedShape) -> Shape {
    Shape::from_parry(shape).expect("a shape")
}

/// A closed mesh of a torus about the Y axis.
fn torus(ring: f32, tube: f32) -> Shape {
    let (around, across) = (48, 24);
    let turn = |i: u32, count: u32| (i as f32 * core::f32::consts::TAU / count as f32).sin_cos();
    let vertex = |i: u32| {
        let ((sine, cosine), (rise, out)) = (turn(i / across, around), turn(i % across, across));
        Vec3::new(cosine * (ring + tube * out), tube * rise, sine * (ring + tube * out))
    };
    let triangles = (0..around * across).flat_map(|i| {
        let (row, next) = (i / across * across, (i / across + 1) % around * across);
        let (column, beside) = (i % across, (i + 1) % across);
        [[row + column, row + beside, next + beside], [row + column, next + beside, next + column]]
    });
    let mesh = SharedShape::trimesh((0..around * across).map(vertex).collect(), triangles.collect());
    parry(mesh.expect("triangles"))
}

/// A closed mesh of an L: a wall on the left of a floor.
fn corner_piece() -> Shape {
    let outline = [[-0.5, -0.3], [0.5, -0.3], [0.5, -0.1], [-0.3, -0.1], [-0.3, 0.3], [-0.5, 0.3]];
    let vertices = [-0.5, 0.5].iter().flat_map(|&z| outline.map(|[x, y]| Vec3::new(x, y, z))).collect();
    let sides = (0..6).flat_map(|i| [[i, (i + 1) % 6, i + 6], [(i + 1) % 6, (i + 1) % 6 + 6, i + 6]]);
    let caps = [[0, 3, 1], [1, 3, 2], [0, 5, 3], [3, 5, 4]];
    let far_caps = caps.map(|[a, b, c]| [a + 6, c + 6, b + 6]);
    parry(SharedShape::trimesh(vertices, sides.chain(caps).chain(far_caps).collect()).expect("triangles"))
}

/// Hills of 0.1 m on a ground of so many metres.
fn hills(side: f32) -> Shape {
    let heights: Vec<f32> =
        (0..21 * 21).map(|i| ((i % 21) as f32 * 0.9).sin() * ((i / 21) as f32 * 0.7).sin()).collect();
    parry(SharedShape::heightfield(Array2::new(21, 21, heights), Vec3::new(side, 0.1, side)))
}

fn two_balls() -> Shape {
    let ball = |x: f32| (Shape::Sphere { radius: 0.25 }, Placement::at(Vec3::new(x, 0.0, 0.0)));
    Shape::compound(vec![ball(-0.2), ball(0.2)]).expect("a shape")
}

fn hull_of_ball() -> Shape {
    let (vertices, _) = Ball::new(0.4).to_trimesh(24, 12);
    parry(SharedShape::convex_hull(&vertices).expect("a hull"))
}

/// A 48th of the longest side.
fn cell(shape: &Shape) -> f32 {
    let (low, high) = shape.local_bounds();
    (high - low).max_element() / 48.0
}

/// A sheet that falls on a shape is held by it, at its thickness but for a part of a cell: a quarter of one over edges and tips, a tenth on
/// round surfaces.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn nothing_passes_a_shape_without_a_formula() {
    let shapes = [
        ("cone", parry(SharedShape::cone(0.3, 0.45)), 0.25),
        ("hull", hull_of_ball(), 0.1),
        ("torus", torus(0.35, 0.12), 0.1),
        ("corner", corner_piece(), 0.25),
        ("two balls", two_balls(), 0.1),
        ("hills", hills(2.0), 0.25),
    ];
    for n in [20, 40] {
        for (name, shape, part) in &shapes {
            let rotation = if *name == "hills" { Quat::IDENTITY } else { Quat::from_rotation_y(0.4) };
            let place = Placement { translation: Vec3::new(0.5, -0.6, 0.5), rotation };
            let obstacles = vec![Obstacle::new(shape.clone(), place, 0.8).expect("valid")];
            let environment = Environment { obstacles: obstacles.into(), ..gravity() };
            let settings =
                BodySettings { substeps: 16, thickness: THICKNESS, friction: 0.8, ..BodySettings::default() };
            let (mut world, id) = world_of(&level(n, Vec3::ZERO, settings));
            let [mut deepest, mut last] = [f32::INFINITY; 2];
            let mut middle = 0.0;
            for _ in 0..8 {
                run(&mut world, &environment, 8);
                let inverse = place.rotation.inverse();
                let local = positions(&world, id).into_iter().map(|p| inverse * (p - place.translation));
                let local: Vec<Vec3> = local.collect();
                last = local.iter().map(|&p| shape.distance(p)).fold(f32::INFINITY, f32::min);
                deepest = deepest.min(last);
                middle = centre(&local).y;
            }
            let allowed = part * cell(shape);
            assert!(deepest > THICKNESS - allowed, "{n} on {name}: {deepest} m, {allowed} m allowed");
            assert!(last < THICKNESS + allowed, "{n} hovers over {name}: nearest at {last} m");
            // A sheet that passes falls for a second, by 5 m.
            assert!(middle > -0.8, "{n} fell past {name}: its middle is at {middle} m");
        }
    }
}

/// Cloth thicker than the margin of the lattice is held off as well: particles that fly to a small ball from all sides, in a body for one
/// workgroup and in a large one.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn thick_cloth_is_held_off_where_the_lattice_ends() {
    let (radius, thickness) = (0.05, 0.03);
    let (corners, _) = Ball::new(radius).to_trimesh(32, 16);
    let hull = parry(SharedShape::convex_hull(&corners).expect("a hull"));
    let environment = Environment {
        gravity: Vec3::ZERO,
        obstacles: vec![obstacle(hull.clone(), Vec3::ZERO, 1.0)].into(),
        ..gravity()
    };
    for count in [500, 2000] {
        // Evenly around the ball by the golden angle.
        let direction = |i: usize| {
            let height = 1.0 - (2 * i + 1) as f32 / count as f32;
            let (sine, cosine) = (i as f32 * 2.399_963).sin_cos();
            Vec3::new(cosine, 0.0, sine) * (1.0 - height * height).sqrt() + Vec3::Y * height
        };
        let starts: Vec<Vec3> = (0..count).map(|i| direction(i) * 0.3).collect();
        let settings = BodySettings { substeps: 8, thickness, friction: 1.0, ..bare() };
        let mut body = joined(&starts, &vec![1.0; count], &[], settings);
        (0..count).for_each(|i| body.particles.set_velocity(i, -direction(i)));
        let (mut world, id) = world_of(&body);
        run(&mut world, &environment, 30);
        for place in positions(&world, id) {
            let distance = hull.distance(place);
            // The normal turns a little from cell to cell, which leaves a part of the speed.
            let is_held = (0.95 * thickness..2.0 * thickness).contains(&distance);
            assert!(is_held, "{count}: {distance} m at {place}");
        }
    }
}

/// At the sides of a height field its distance leaps from below zero to above: a sheet that hangs over one is not thrown, but slaps against
/// it as against a block.
#[test]
#[ignore = "needs a graphics adapter: .ci/gpu"]
fn a_sheet_over_the_side_of_a_height_field_is_not_thrown() {
    for n in [20, 40] {
        let block = Shape::Cuboid { half_extents: Vec3::splat(0.5) };
        let [at_field, at_block] = [(hills(1.0), -0.12), (block, -0.55)].map(|(shape, height)| {
            let ground = obstacle(shape, Vec3::new(0.1, height, 0.5), 0.8);
            let environment = Environment { obstacles: vec![ground].into(), ..gravity() };
            let settings =
                BodySettings { substeps: 16, thickness: THICKNESS, friction: 0.8, ..BodySettings::default() };
            let (mut world, id) = world_of(&level(n, Vec3::ZERO, settings));
            let speed = |_| {
                run(&mut world, &environment, 1);
                world.read_status(id).expect("a body").expect("stepped").greatest_speed
            };
            (0..90).map(speed).fold(0.0, f32::max)
        });
        assert!(at_field < 1.3 * at_block, "{n}: thrown at {at_field} m/s, and by a block at {at_block} m/s");
    }
}
