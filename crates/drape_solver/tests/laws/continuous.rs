//! Continuous collision: fast bodies do not pass through thin ones between two steps.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::parry3d::math::Pose;
use drape_solver::parry3d::shape::SharedShape;
use drape_solver::parry3d::utils::Array2;
use drape_solver::{BodySettings, ClothBuilder, Island, Placement, Shape, StructuralSolve, step};

use crate::common::*;

fn parry(shape: SharedShape) -> Shape {
    Shape::from_parry(shape).expect("a valid shape")
}

/// Two triangles in the plane z = 0, `half` metres to each side: a sheet without any thickness.
fn open_mesh(half: f32) -> Shape {
    let corner = |x: f32, y: f32| Vec3::new(x * half, y * half, 0.0);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    parry(SharedShape::trimesh(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("triangles"))
}

fn thin_cuboid() -> Shape {
    Shape::Cuboid { half_extents: Vec3::new(1.0, 1.0, 0.001) }
}

fn in_two_parts() -> Shape {
    let part = SharedShape::cuboid(0.5, 1.0, 0.001);
    let at = |x: f32| Pose::from_translation(Vec3::X * x);
    parry(SharedShape::compound(vec![(at(-0.5), part.clone()), (at(0.5), part)]))
}

fn thrown_ball(radius: f32, at: Vec3, velocity: Vec3) -> Island {
    Island { balls: vec![ball(smooth(radius, 0.1), at, velocity)], ..Island::default() }
}

/// Balls at 20, 60 and 200 m/s against sheets, plates and a wire: they stay on their side.
#[test]
fn a_fast_ball_passes_no_thin_obstacle() {
    let wire = Shape::Capsule { half_length: 1.0, radius: 0.002 };
    let needle = Shape::TaperedCapsule { half_length: 1.0, bottom_radius: 0.001, top_radius: 0.003 };
    for shape in [open_mesh(1.0), thin_cuboid(), in_two_parts(), wire, needle] {
        for speed in [20.0, 60.0, 200.0] {
            for offset in [0.0, 0.3, 0.77] {
                let mut island = thrown_ball(0.03, Vec3::new(0.01, 0.1, 1.0 + offset), Vec3::NEG_Z * speed);
                let mut environment = weightless(FRAME);
                environment.obstacles = vec![obstacle(shape.clone(), Vec3::ZERO, 0.0)].into();
                let steps = (4.0 / (speed * FRAME)).ceil() as usize + 1;
                for _ in 0..steps {
                    step(&mut island, &environment).expect("a good step");
                    let ball = &island.balls[0];
                    // The wire deflects the ball, which flies on past it.
                    let is_thin = matches!(shape, Shape::Capsule { .. } | Shape::TaperedCapsule { .. });
                    let is_beside = ball.position().x.abs() > 0.02 && is_thin;
                    let z = ball.position().z;
                    assert!(
                        z > 0.0 || is_beside,
                        "{shape:?} at {speed} m/s from {offset}: {}",
                        ball.position()
                    );
                }
            }
        }
    }
}

/// Two balls meet head on at 200 m/s each. They do not pass through each other.
#[test]
fn fast_balls_do_not_pass_through_each_other() {
    for offset in [0.5, 1.0, 1.66, 2.9] {
        let mut island = thrown_ball(0.03, Vec3::Z * offset, Vec3::NEG_Z * 200.0);
        island.balls.push(ball(smooth(0.03, 0.1), Vec3::new(0.01, 0.0, -offset), Vec3::Z * 200.0));
        for _ in 0..4 {
            step(&mut island, &weightless(FRAME)).expect("a good step");
            let [one, other] = [0, 1].map(|i| island.balls[i].position());
            let is_beside = (one - other).truncate().length() > 0.05;
            assert!(one.z > other.z || is_beside, "from {offset}: {one} and {other}");
        }
    }
}

/// A step in which obstacles move 20 m.
const LONG_STEP: f32 = 0.1;

/// The obstacles that move, and the half width of each across its path.
fn racing() -> Vec<(Shape, f32)> {
    let plate = Shape::Cuboid { half_extents: Vec3::new(1.5, 1.5, 0.001) };
    vec![
        (Shape::Sphere { radius: 0.3 }, 0.28),
        // Cloth may slide along its flanks.
        (Shape::Capsule { half_length: 0.3, radius: 0.1 }, 0.09),
        (Shape::TaperedCapsule { half_length: 0.3, bottom_radius: 0.15, top_radius: 0.1 }, 0.09),
        (Shape::Cuboid { half_extents: Vec3::splat(0.25) }, 0.24),
        (plate, 1.4),
        (open_mesh(0.4), 0.39),
        (parry(SharedShape::convex_hull(&cube(0.25)).expect("a hull")), 0.24),
    ]
}

fn cube(half: f32) -> Vec<Vec3> {
    (0..8)
        .map(|i| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| half * (2.0 * bit as f32 - 1.0))))
        .collect()
}

/// True if `position` is in front of an obstacle that has moved to z = 20 m, or beside its path of half width `half`.
fn is_in_front(position: Vec3, half: f32) -> bool {
    position.z > 20.0 || position.x.abs().max(position.y.abs()) > half
}

/// An obstacle that moves 20 m in one step sweeps balls in its path along.
#[test]
fn a_racket_leaves_no_ball_behind() {
    for (shape, half) in racing() {
        for turn in [0.0, 0.4] {
            for place in [2.0, 7.3, 19.0] {
                let at = Vec3::new(0.3 * half, -0.4 * half, place);
                let mut island = thrown_ball(0.03, at, Vec3::ZERO);
                let mut environment = weightless(LONG_STEP);
                let start = Placement { rotation: Quat::from_rotation_z(-turn), ..Placement::default() };
                environment.obstacles = vec![obstacle(shape.clone(), Vec3::ZERO, 0.0)].into();
                environment.obstacles[0].teleport(start);
                environment.obstacles[0].move_to(Placement::at(Vec3::Z * 20.0), LONG_STEP);
                step(&mut island, &environment).expect("a good step");
                let position = island.balls[0].position();
                assert!(
                    is_in_front(position, half),
                    "{shape:?} turned by {turn} left it at {position}, from {place}"
                );
            }
        }
    }
}

/// A loose sheet across the path, with `count` particles to a side.
fn sheet_at(count: u32, size: f32, z: f32, structural: StructuralSolve) -> Island {
    let settings = BodySettings { thickness: 0.005, substeps: 8, structural, ..BodySettings::default() };
    let sheet = ClothBuilder::new(size, size, count, count)
        .placed(Vec3::new(-0.5 * size + 0.013, 0.5 * size + 0.017, z), Vec3::X, Vec3::NEG_Y)
        .build(settings);
    Island::of_body(sheet.expect("a valid sheet"))
}

/// Points spread over a face, as weights of its corners.
fn spread() -> Vec<[f32; 3]> {
    const PARTS: u32 = 6;
    let weight = |part: u32| part as f32 / PARTS as f32;
    let rows = (0..=PARTS).flat_map(|i| (0..=PARTS - i).map(move |j| (i, j)));
    rows.map(|(i, j)| [weight(PARTS - i - j), weight(i), weight(j)]).collect()
}

/// These points on all faces of the island's first body, each with its face.
fn points(island: &Island) -> impl Iterator<Item = (usize, Vec3)> {
    let body = &island.bodies[0];
    let spread = spread();
    body.topology.faces().iter().enumerate().flat_map(move |(index, face)| {
        let [a, b, c] = face.map(|i| body.particles.position(i as usize));
        spread.clone().into_iter().map(move |[u, v, w]| (index, a * u + b * v + c * w))
    })
}

/// After one step of 20 m, all particles of the sheet that were in the path are in front of the obstacle, and so are all
/// points of its faces. With lines a fine sheet may be stretched around a pole by ten times for a moment, a few faces across it.
#[test]
fn what_moves_far_in_a_step_leaves_no_cloth_behind() {
    let sheets: Vec<_> = each_with([41, 4], BOTH).collect();
    for ((shape, half), (count, structural)) in each_with(racing(), sheets) {
        for (turn, place) in each_with([0.0, 0.4], [2.0, 7.3, 19.0]) {
            let mut island = sheet_at(count, 2.0, place, structural);
            let is_in_way = |p: Vec3| p.x.abs().max(p.y.abs()) < 0.6 * half;
            let starts: Vec<Vec3> = particles(&island).positions().collect();
            let met: Vec<bool> = points(&island).map(|(_, point)| is_in_way(point)).collect();
            assert!(met.contains(&true));
            let mut environment = weightless(LONG_STEP);
            environment.obstacles = vec![obstacle(shape.clone(), Vec3::ZERO, 0.0)].into();
            let start = Placement { rotation: Quat::from_rotation_z(-turn), ..Placement::default() };
            environment.obstacles[0].teleport(start);
            environment.obstacles[0].move_to(Placement::at(Vec3::Z * 20.0), LONG_STEP);
            step(&mut island, &environment).expect("a good step");
            let case =
                format!("{shape:?} turned by {turn}, {count} particles a side at {place} m, {structural:?}");
            for (at, start) in particles(&island).positions().zip(starts) {
                assert!(!is_in_way(start) || is_in_front(at, half), "{case}: a particle is left at {at}");
            }
            let ends: Vec<Vec3> =
                points(&island).zip(met).filter(|end| end.1).map(|((_, at), _)| at).collect();
            let left = ends.iter().filter(|&&at| !is_in_front(at, half)).count();
            let most = if count == 41 && structural == StructuralSolve::Lines { ends.len() / 10 } else { 0 };
            assert!(left <= most, "{case}: {left} of {} points are left", ends.len());
        }
    }
}

/// A free sheet thrown at up to 100 m/s at triangles without any thickness.
#[test]
fn a_fast_cloth_passes_no_triangles() {
    let heights = Array2::new(9, 9, vec![0.0; 81]);
    let field = SharedShape::heightfield(heights, Vec3::new(4.0, 1.0, 4.0));
    for (shape, rotation) in
        [(open_mesh(2.0), Quat::IDENTITY), (parry(field), Quat::from_rotation_x(std::f32::consts::FRAC_PI_2))]
    {
        for count in [31, 4] {
            for speed in [10.0, 40.0, 100.0] {
                let mut island = sheet_at(count, 1.0, 1.3, StructuralSolve::default());
                let body = &mut island.bodies[0].particles;
                (0..body.len()).for_each(|i| body.set_velocity(i, Vec3::NEG_Z * speed));
                let mut environment = weightless(FRAME);
                environment.obstacles = vec![obstacle(shape.clone(), Vec3::ZERO, 0.3)].into();
                environment.obstacles[0].teleport(Placement { rotation, ..Placement::default() });
                run_with(&mut island, &environment, 0.25, |island, index| {
                    for (face, p) in points(island) {
                        let is_over = p.x.abs().max(p.y.abs()) < 1.9;
                        assert!(
                            p.z > -1e-3 || !is_over,
                            "{shape:?}, {count} a side at {speed} m/s: face {face} at {p} in step {index}"
                        );
                    }
                });
            }
        }
    }
}

/// A particle flies low over a floor into a wall of the same mesh. The nearest point at the start of the step is on the
/// floor, but the wall stops it.
#[test]
fn a_fast_particle_is_stopped_by_the_wall_and_not_by_the_floor_that_is_nearer() {
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let corners = vec![
        corner(-3.0, 0.0, -1.0),
        corner(-3.0, 0.0, 1.0),
        corner(1.0, 0.0, -1.0),
        corner(1.0, 0.0, 1.0),
        corner(1.0, 2.0, -1.0),
        corner(1.0, 2.0, 1.0),
    ];
    let triangles = vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]];
    let mesh = parry(SharedShape::trimesh(corners, triangles).expect("triangles"));
    for speed in [20.0, 60.0, 150.0] {
        for height in [0.02, 0.1] {
            let settings = BodySettings { thickness: 0.005, ..bare() };
            let mut body = loose(&[Vec3::new(-0.3, height, 0.1)], settings);
            body.particles.set_velocity(0, Vec3::X * speed);
            let mut island = Island::of_body(body);
            let mut environment = weightless(FRAME);
            environment.obstacles = vec![obstacle(mesh.clone(), Vec3::ZERO, 0.0)].into();
            run_with(&mut island, &environment, 0.2, |island, index| {
                let x = particles(island).position(0).x;
                assert!(x < 1.0, "{speed} m/s at {height} m: at {x} m in step {index}");
            });
        }
    }
}
