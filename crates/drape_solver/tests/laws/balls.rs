//! S18: cannon balls.

use drape_solver::glam::{DVec3, Quat, Vec3};
use drape_solver::motion::ballistics::position_at;
use drape_solver::{
    Ball, BallMaterial, BodySettings, ClothBuilder, Edge, Environment, Island, Obstacle, Placement, Shape,
};

use crate::common::*;

fn ground() -> Environment {
    Environment { obstacles: vec![Obstacle::ground()].into(), ..gravity(FRAME) }
}

/// S18: a launched ball is on the parabola at the end of every step, for all time steps and substeps.
#[test]
fn a_launched_ball_runs_on_the_parabola() {
    let (start, velocity) = (Vec3::new(0.0, 1.0, 12.0), Vec3::new(1.0, 6.0, -18.0));
    for dt in [1.0 / 30.0, FRAME, 1.0 / 144.0] {
        for launched_for in [dt, dt / 16.0, 1.0 / 1024.0] {
            let material = smooth(0.15, 2.0);
            let down = Vec3::NEG_Y * G;
            let ball = Ball::launch(material, start, velocity, down, launched_for).expect("valid");
            let mut island = Island::of_ball(ball);
            run_with(&mut island, &gravity(dt), 1.0, |island, index| {
                let time = f64::from(dt) * (index + 1) as f64;
                let expected = position_at(start.as_dvec3(), velocity.as_dvec3(), down.as_dvec3(), time);
                let error = (island.balls[0].position().as_dvec3() - expected).length();
                assert!(error < 1e-4, "{error} m off after {time} s in steps of {dt} s");
            });
        }
    }
}

/// S18: a rolling ball slows by `5/7 g` times its rolling resistance, and stops.
#[test]
fn a_rolling_ball_slows_by_its_rolling_resistance_and_stops() {
    for (resistance, speed) in [(0.05, 2.0), (0.02, 1.0), (0.1, 5.0)] {
        let material = BallMaterial { rolling_resistance: resistance, ..BallMaterial::default() };
        let mut ball = ball(material, Vec3::Y * material.radius, Vec3::X * speed);
        ball.set_spin(Vec3::NEG_Z * (speed / material.radius));
        let mut island = Island::of_ball(ball);
        let slowing = f64::from(5.0 / 7.0 * resistance * G);
        let time = 0.5 * f64::from(speed) / slowing;
        run(&mut island, &ground(), time as f32);
        let found = (f64::from(speed) - f64::from(island.balls[0].velocity().x)) / time;
        assert_close("deceleration", found, slowing, 0.03);
        run(&mut island, &ground(), 1.2 * time as f32);
        let ball = &island.balls[0];
        assert!(ball.velocity().length() < 1e-3 && ball.spin().length() < 1e-3, "at rest");
        let way = f64::from(speed * speed) / (2.0 * slowing);
        assert_close("way", ball.position().x.into(), way, 0.03);
    }
}

/// A sliding ball turns its slip into spin, and rolls on at five sevenths of its speed for any friction.
#[test]
fn a_sliding_ball_ends_rolling_at_five_sevenths() {
    for friction in [0.2, 0.5, 1.0] {
        let material = BallMaterial { friction, rolling_resistance: 0.0, ..BallMaterial::default() };
        let mut island = Island::of_ball(ball(material, Vec3::Y * material.radius, Vec3::X * 7.0));
        run(&mut island, &ground(), 3.0);
        let ball = &island.balls[0];
        assert_close("speed", ball.velocity().x.into(), 5.0, 0.01);
        let slip = ball.velocity() + ball.spin().cross(Vec3::NEG_Y * material.radius);
        assert!(slip.length() < 1e-2, "it rolls without slip: {slip}");
    }
}

/// A ball rolls down an incline with `5/7 g sin`, less rolling resistance.
#[test]
fn a_ball_rolls_down_an_incline_by_five_sevenths_of_gravity() {
    for resistance in [0.0, 0.05] {
        let angle = 15.0_f32.to_radians();
        let rotation = Quat::from_rotation_z(-angle);
        let placement = Placement { rotation, ..Placement::default() };
        let plane = Obstacle::new(Shape::HalfSpace { normal: Vec3::Y }, placement, 0.5).expect("valid");
        let material = BallMaterial { rolling_resistance: resistance, ..BallMaterial::default() };
        let start = rotation * Vec3::Y * material.radius;
        let mut island = Island::of_ball(ball(material, start, Vec3::ZERO));
        run(&mut island, &Environment { obstacles: vec![plane].into(), ..gravity(FRAME) }, 1.0);
        let found = island.balls[0].velocity().dot(rotation * Vec3::X);
        let expected = 5.0 / 7.0 * G * (angle.sin() - resistance * angle.cos());
        assert_close("acceleration", found.into(), expected.into(), 0.01);
    }
}

/// Spin alone drives a ball off, and a ball that spins on the spot comes to rest.
#[test]
fn spin_drives_a_ball_and_whirling_ends() {
    let material = BallMaterial { rolling_resistance: 0.0, ..BallMaterial::default() };
    let mut spinning = ball(material, Vec3::Y * material.radius, Vec3::ZERO);
    spinning.set_spin(Vec3::NEG_Z * 70.0);
    let mut island = Island::of_ball(spinning);
    run(&mut island, &ground(), 3.0);
    // Angular momentum about the ground keeps 2/5 m r^2 w = 7/5 m r v.
    assert_close(
        "speed",
        island.balls[0].velocity().x.into(),
        f64::from(2.0 / 7.0 * 70.0 * material.radius),
        0.01,
    );

    let material = BallMaterial::default();
    let mut whirling = ball(material, Vec3::Y * material.radius, Vec3::ZERO);
    whirling.set_spin(Vec3::Y * 10.0);
    let mut island = Island::of_ball(whirling);
    run(&mut island, &ground(), 3.0);
    assert!(island.balls[0].spin().length() < 1e-3);
    assert!(island.balls[0].position().with_y(0.0).length() < 1e-3);
}

/// The orientation of a ball in flight follows its spin.
#[test]
fn orientation_follows_spin() {
    let mut spinning = ball(smooth(0.2, 1.0), Vec3::ZERO, Vec3::ZERO);
    spinning.set_spin(Vec3::new(0.0, 3.0, 0.0));
    let mut island = Island::of_ball(spinning);
    run(&mut island, &weightless(FRAME), 0.5);
    let expected = Quat::from_rotation_y(1.5);
    assert!(island.balls[0].rotation().angle_between(expected) < 1e-3);
    assert_eq!(island.balls[0].spin(), Vec3::new(0.0, 3.0, 0.0), "nothing brakes it in the air");
}

/// A ball thrown on the ground does not bounce: restitution is zero.
#[test]
fn a_ball_does_not_bounce() {
    let material = smooth(0.15, 2.0);
    let mut island = Island::of_ball(ball(material, Vec3::Y * 1.0, Vec3::new(3.0, -8.0, 0.0)));
    let mut landed = false;
    let environment = Environment { obstacles: vec![ice()].into(), ..gravity(FRAME) };
    run_with(&mut island, &environment, 2.0, |island, _| {
        let height = island.balls[0].position().y;
        landed |= height < material.radius + 1e-4;
        assert!(height > material.radius - 1e-5);
        assert!(!landed || height < material.radius + 1e-4, "it bounced to {height} m");
    });
    assert!(landed);
    assert!((island.balls[0].velocity().x - 3.0).abs() < 1e-4, "no friction, so it slides on");
}

/// Balls in the box of S5 stay inside by their radius.
#[test]
fn balls_stay_inside_the_box() {
    let walls = obstacle(Shape::Container { half_extents: Vec3::ONE }, Vec3::ZERO, 0.3);
    let environment = Environment { obstacles: vec![walls].into(), ..gravity(FRAME) };
    let mut dice = Dice::new(3);
    let mut island = Island::default();
    for k in 0..8 {
        let corner = Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) - 0.5;
        island.balls.push(ball(
            BallMaterial { radius: 0.1, ..BallMaterial::default() },
            corner,
            dice.vector(10.0),
        ));
    }
    run_with(&mut island, &environment, 4.0, |island, _| {
        for ball in &island.balls {
            assert!(ball.position().abs().max_element() < 0.9 + 5e-3, "{}", ball.position());
        }
    });
    for ball in &island.balls {
        assert!(ball.velocity().length() < 0.2, "at rest: {}", ball.velocity());
    }
}

/// A sheet in the XZ plane at height 0, pinned all round.
fn drum(cells: u32, spacing: f32) -> Island {
    let last = cells;
    let size = spacing * cells as f32;
    let sheet = ClothBuilder::new(size, size, cells + 1, cells + 1)
        .placed(Vec3::new(-size / 2.0, 0.0, -size / 2.0), Vec3::X, Vec3::Z)
        .pin_where(|column, row, _| column == 0 || row == 0 || column == last || row == last)
        .build(BodySettings::default())
        .expect("valid");
    Island::of_body(sheet)
}

/// Targets in a cell of the sheet: a particle, edges, the middles of both kinds of faces, the diagonal.
const OFFSETS: [(f32, f32); 6] = [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.33, 0.33), (0.67, 0.33)];

/// S18: the faces of a sheet hold a dropped ball that is far smaller than the particle spacing. The sheet is 4 % wider than its frame,
/// and sags: on a taut one the ball would roll over the rim.
#[test]
fn a_small_ball_dropped_on_a_sheet_does_not_slip_between_particles() {
    let spacing = 0.1;
    for (u, v) in OFFSETS {
        for radius in [0.02, 0.04] {
            let mut island = drum(8, spacing);
            let sheet = &mut island.bodies[0].particles;
            (0..sheet.len()).for_each(|i| sheet.set_position(i, sheet.position(i) / 1.04));
            let start = Vec3::new(u * spacing, 0.3, v * spacing);
            let material = BallMaterial { radius, mass: 0.05, ..BallMaterial::default() };
            island.balls.push(ball(material, start, Vec3::ZERO));
            run(&mut island, &gravity(FRAME), 3.0);
            let height = island.balls[0].position().y;
            assert!(height > -0.25, "radius {radius} at ({u}, {v}) fell through: {height}");
            assert!(island.balls[0].velocity().length() < 0.5, "it lies in the sheet");
        }
    }
}

/// S18: they also hold it when it is shot at the speeds of the demo, straight and at an angle.
#[test]
fn a_small_ball_shot_at_a_sheet_does_not_slip_between_particles() {
    let spacing = 0.1;
    for (u, v) in OFFSETS {
        for speed in [12.0, 25.0] {
            for aslant in [Vec3::ZERO, Vec3::new(0.5, 0.0, 0.2)] {
                let radius = 0.03;
                let mut island = drum(8, spacing);
                let direction = (Vec3::NEG_Y + aslant).normalize();
                let target = Vec3::new(u * spacing, 0.0, v * spacing);
                let material = BallMaterial { radius, mass: 0.05, ..BallMaterial::default() };
                island.balls.push(ball(material, target - direction * 0.5, direction * speed));
                run_with(&mut island, &weightless(FRAME), 0.4, |island, _| {
                    let ball = &island.balls[0];
                    // The sheet can bulge, but not by more than its own size.
                    assert!(ball.position().y > -0.35, "{speed} m/s at ({u}, {v}): {}", ball.position());
                });
                let ball = &island.balls[0];
                assert!(ball.velocity().y > -0.5, "{speed} m/s at ({u}, {v}): still {}", ball.velocity());
            }
        }
    }
}

/// S18: a sheet pinned all round stops a cannon ball or throws it back.
#[test]
fn a_cannon_ball_is_stopped_by_a_pinned_sheet() {
    let aims = each_with(OFFSETS, [8.0, 15.0, 25.0]);
    for ((u, v), speed) in aims {
        let mut island = drum(16, 0.0625);
        let start = Vec3::new(u * 0.0625, 0.6, v * 0.0625);
        island.balls.push(ball(BallMaterial::default(), start, Vec3::NEG_Y * speed));
        run_with(&mut island, &weightless(FRAME), 1.0, |island, _| {
            assert!(island.balls[0].position().y > -0.6, "({u}, {v}): {}", island.balls[0].position());
        });
        let velocity = island.balls[0].velocity();
        assert!(velocity.y > -0.5, "({u}, {v}): {velocity}");
        assert!(velocity.length() < speed, "no energy is made, but {velocity}");
    }
}

/// S18: at the demo's speeds the ball does not go through the demo's curtain at any target: right after the hit all cloth in
/// the ball's path is in front of it, and has slowed it.
#[test]
fn a_cannon_ball_does_not_go_through_a_curtain() {
    for ((substeps, iterations), structural) in each_with([(8, 2), (4, 1)], BOTH) {
        for speed in [12.0, 18.0, 25.0] {
            for (x, y) in [(0.0, 1.8), (0.03, 2.1), (-1.0, 1.7), (0.02, 2.5), (1.2, 2.6)] {
                let settings =
                    BodySettings { substeps, iterations, structural, drag: 2.0, ..BodySettings::default() };
                let curtain = ClothBuilder::new(4.0, 3.0, 64, 48)
                    .placed(Vec3::new(-2.0, 3.3, 0.0), Vec3::X, Vec3::NEG_Y)
                    .pin_edge(Edge::Top);
                let mut island = Island::of_body(curtain.build(settings).expect("valid"));
                let material = BallMaterial::default();
                island.balls.push(ball(material, Vec3::new(x, y, 0.5), Vec3::NEG_Z * speed));
                let mut since_touch = 0;
                run_with(&mut island, &gravity(FRAME), 0.2, |island, _| {
                    since_touch += i32::from(since_touch > 0 || !island.touches.is_empty());
                    if !(1..=4).contains(&since_touch) {
                        return;
                    }
                    let centre = island.balls[0].position();
                    for position in particles(island).positions() {
                        let away = position - centre;
                        let beside = away.truncate().length() > 0.8 * material.radius;
                        assert!(beside || away.z < 0.0, "{speed} m/s at ({x}, {y}): {away} behind the ball");
                    }
                });
                assert!(since_touch > 5, "it must have hit");
                let after = island.balls[0].velocity().length();
                assert!(after < 0.9 * speed, "{after} m/s of {speed} m/s at ({x}, {y})");
                let stretch = stretch(&island).max;
                assert!(stretch < 1.5, "{stretch}");
            }
        }
    }
}

/// The links of a rope across its path catch a ball, not only the particles.
#[test]
fn a_rope_catches_a_ball_between_its_particles() {
    let rope = drape_solver::RopeBuilder::new(Vec3::X * -1.0, Vec3::X, 11)
        .linear_density(0.5)
        .pin_start()
        .pin_end()
        .build(BodySettings::default())
        .expect("valid");
    for x in [0.0, 0.1, 0.05] {
        let mut island = Island::of_body(rope.clone());
        let material = BallMaterial { radius: 0.04, mass: 0.1, ..smooth(0.04, 0.1) };
        island.balls.push(ball(material, Vec3::new(x, 0.2, 0.0), Vec3::NEG_Y * 3.0));
        run(&mut island, &weightless(FRAME), 0.5);
        assert!(island.balls[0].position().y > -0.2, "at {x}: {}", island.balls[0].position());
    }
}

/// The closed form and the solver agree on the point at which a shot from the elevation formula comes down.
#[test]
fn a_shot_at_the_solved_elevation_meets_its_target() {
    let (distance, height, speed) = (12.0, 1.3, 18.0);
    let elevation = drape_solver::motion::ballistics::elevation_for(distance, height, speed, f64::from(G))
        .expect("in range");
    let velocity = drape_solver::motion::ballistics::direction(elevation, 0.0) * speed;
    let down = Vec3::NEG_Y * G;
    let launched = Ball::launch(smooth(0.15, 2.0), Vec3::ZERO, velocity.as_vec3(), down, FRAME);
    let mut island = Island::of_ball(launched.expect("valid"));
    let time = distance / -velocity.z;
    let target = DVec3::new(0.0, height, -distance);
    let mut nearest = f64::INFINITY;
    run_with(&mut island, &gravity(1.0 / 2000.0), time as f32 + 0.1, |island, _| {
        nearest = nearest.min(island.balls[0].position().as_dvec3().distance(target));
    });
    assert!(nearest < 0.01, "{nearest} m away");
}
