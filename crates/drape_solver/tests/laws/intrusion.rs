//! Initial overlaps, such as an obstacle that appears inside a cloth, or a body in the ground: they are resolved, and throw
//! nothing.

use drape_solver::glam::Vec3;
use drape_solver::{
    BallMaterial, BodySettings, ClothBuilder, Edge, Environment, Island, Obstacle, Placement, Shape,
    StructuralSolve,
};

use crate::common::*;

/// A particle that starts in the ground comes out within the step, and does not jump.
#[test]
fn a_particle_that_starts_in_the_ground_is_put_on_it_and_not_thrown() {
    for (substeps, iterations) in [(1, 1), (8, 2), (16, 1)] {
        let settings = BodySettings { substeps, iterations, ..bare() };
        let mut island = Island::of_body(loose(&[Vec3::Y * -0.4], settings));
        let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
        run(&mut island, &environment, FRAME);
        assert!(particles(&island).position(0).y.abs() < 1e-5, "on the ground after the first step");
        run_with(&mut island, &environment, 0.5, |island, _| {
            let height = particles(island).position(0).y;
            assert!(height < 1e-3, "thrown to {height} m, {substeps} substeps");
        });
    }
}

/// A ball that starts in the ground comes out, and does not jump.
#[test]
fn a_ball_that_starts_in_the_ground_is_put_on_it_and_not_thrown() {
    let material = BallMaterial::default();
    let mut island = Island::of_ball(ball(material, Vec3::Y * -0.05, Vec3::ZERO));
    let environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    run_with(&mut island, &environment, 1.0, |island, _| {
        let height = island.balls[0].position().y;
        assert!((height - material.radius).abs() < 1e-3, "the centre is at {height} m");
        assert!(island.balls[0].velocity().length() < 0.1);
    });
}

/// Two balls that start in one place separate slowly.
#[test]
fn balls_that_start_in_one_another_are_parted_gently() {
    let material = smooth(0.2, 1.0);
    let mut island = Island::of_ball(ball(material, Vec3::ZERO, Vec3::ZERO));
    island.balls.push(ball(material, Vec3::X * 0.1, Vec3::ZERO));
    run(&mut island, &weightless(FRAME), FRAME);
    let apart = island.balls[0].position().distance(island.balls[1].position());
    assert!(apart > 0.4 - 1e-4, "parted within the step, but {apart} m");
    for ball in &island.balls {
        assert!(ball.velocity().length() < 1e-3, "thrown at {} m/s", ball.velocity());
    }
}

/// A ball that starts inside a curtain separates from it slowly.
#[test]
fn a_ball_that_starts_in_a_curtain_does_not_shoot_it_away() {
    let mut island = Island::of_body(curtain(StructuralSolve::default()));
    let material = BallMaterial { radius: 0.15, mass: 2.0, ..BallMaterial::default() };
    island.balls.push(ball(material, Vec3::new(0.01, -0.5, 0.02), Vec3::ZERO));
    let environment = weightless(FRAME);
    run_with(&mut island, &environment, 1.0, |island, _| {
        assert!(greatest_speed(island) < 15.0, "{} m/s", greatest_speed(island));
        assert!(island.balls[0].velocity().length() < 0.5, "{}", island.balls[0].velocity());
    });
}

fn curtain(structural: StructuralSolve) -> drape_solver::Body {
    ClothBuilder::new(1.5, 1.5, 25, 25)
        .placed(Vec3::new(-0.75, 0.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings { structural, ..BodySettings::default() })
        .expect("valid")
}

/// Greatest speed in m/s in the second after a sphere of 0.3 m appears at `centre` in a hanging curtain, and the final speed.
fn after_appearing(centre: Vec3, by_teleport: bool, structural: StructuralSolve) -> (f32, f32, Island) {
    let mut island = Island::of_body(curtain(structural));
    let mut environment = gravity(FRAME);
    environment.obstacles = vec![obstacle(Shape::Sphere { radius: 0.3 }, Vec3::Y * 100.0, 0.3)].into();
    run(&mut island, &environment, 0.5);
    if by_teleport {
        environment.obstacles[0].teleport(Placement::at(centre));
    } else {
        environment.obstacles[0].move_to(Placement::at(centre), FRAME);
    }
    let mut fastest = 0.0_f32;
    run_with(&mut island, &environment, 1.0, |island, _| {
        fastest = fastest.max(greatest_speed(island));
        for position in particles(island).positions() {
            assert!(position.distance(centre) > 0.3 - 1e-3, "inside at {position}");
            assert!(position.z.abs() < 1.3, "thrown out of its place to {position}");
        }
    });
    (fastest, greatest_speed(&island), island)
}

/// An obstacle that appears in a hanging curtain, by a teleport or by a move too far for motion, only pushes it aside.
#[test]
fn a_teleported_obstacle_does_not_throw_the_cloth() {
    for centre in [Vec3::new(0.03, -0.9, 0.1), Vec3::new(0.2, -0.6, -0.08), Vec3::new(0.0, -1.2, 0.25)] {
        for (by_teleport, structural) in each_with([true, false], BOTH) {
            let (fastest, at_end, island) = after_appearing(centre, by_teleport, structural);
            assert!(fastest < 20.0, "{fastest} m/s at {centre}");
            // The hem of the curtain, which falls back, reaches 5.4 m/s, and its corners more.
            let most = if structural == StructuralSolve::Lines { 8.0 } else { 6.0 };
            assert!(at_end < most, "{at_end} m/s after a second");
            assert!(stretch(&island).max < 0.2, "{centre}: {:?}", stretch(&island));
        }
    }
}

/// If the sphere's centre is exactly in the plane of the cloth, the cloth cannot get around it, but does not burst either.
/// Its faces are pulled across the sphere and pushed off it, so it never quite calms down.
#[test]
fn an_obstacle_that_appears_exactly_in_the_cloths_plane_does_not_burst_it() {
    for (structural, most) in [(StructuralSolve::Sweeps, 20.0), (StructuralSolve::Lines, 45.0)] {
        let (fastest, at_end, _) = after_appearing(Vec3::new(0.0, -0.75, 0.0), true, structural);
        assert!(fastest < 100.0 && at_end < most, "{fastest} m/s, and {at_end} m/s after a second");
    }
}

/// Ground that appears above a sheet lifts it onto itself.
#[test]
fn ground_that_rises_at_once_lifts_a_sheet_without_throwing_it() {
    let sheet = ClothBuilder::new(1.0, 1.0, 17, 17)
        .placed(Vec3::Y * 0.005, Vec3::X, Vec3::Z)
        .build(BodySettings::default())
        .expect("valid");
    let mut island = Island::of_body(sheet);
    let mut environment = Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) };
    run(&mut island, &environment, 0.2);
    environment.obstacles[0].teleport(Placement::at(Vec3::Y * 0.3));
    run_with(&mut island, &environment, 1.0, |island, _| {
        for position in particles(island).positions() {
            assert!((position.y - 0.305).abs() < 2e-3, "{position}");
        }
    });
}
