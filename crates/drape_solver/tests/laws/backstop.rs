//! Backstops: a sphere behind each particle's animated place, which the particle does not enter.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::{
    Backstop, Body, BodySettings, BuildError, Environment, Island, Obstacle, PoseDrive, Shape, step,
};

use crate::common::*;

const SUBSTEPS: [u32; 3] = [1, 4, 16];

/// A particle at `place` before a sphere of `radius` around the origin, whose top the animation has where `normal` points.
fn before_sphere(place: Vec3, normal: Vec3, radius: f32, substeps: u32) -> Body {
    let mut body = loose(&[place], BodySettings { substeps, ..bare() });
    body.particles
        .set_backstop(0, normal * radius, normal, Backstop { distance: 0.0, radius })
        .expect("valid");
    body
}

/// A sheet of a metre that hangs from its top edge, with all that an animated pose asks of it.
fn sheet(particles: u32, backstop: Backstop, limit: f32) -> Body {
    let mut body = hanging_sheet(particles);
    for i in 0..body.particles.len() {
        let place = body.particles.position(i);
        body.particles.set_backstop(i, place, Vec3::Z, backstop).expect("valid");
        body.particles.set_motion_limit(i, place, (2.0 - place.y) * limit);
        let drive = PoseDrive { angular_frequency: 3.0 * place.x.max(0.0), damping_ratio: 0.5 };
        body.particles.set_pose_drive(i, place, drive).expect("valid");
    }
    body
}

/// The animation at a time in seconds: it sways, and turns about by up to some 14 rad/s.
fn pose(place: Vec3, time: f32) -> (Vec3, Vec3) {
    let turn = Quat::from_rotation_y(2.0 * libm::sinf(7.0 * time));
    let sway = Vec3::new(libm::sinf(3.0 * time), 0.2 * libm::sinf(7.0 * time), 0.3 * libm::sinf(5.0 * time));
    (turn * place + sway, turn * Vec3::Z)
}

fn animate(body: &mut Body, rest: &[Vec3], time: f32) {
    for (i, place) in rest.iter().enumerate() {
        let (place, normal) = pose(*place, time);
        body.particles.set_pin_target(i, place);
        body.particles.set_limit_centre(i, place);
        body.particles.set_backstop_pose(i, place, normal);
        body.particles.set_drive_place(i, place);
    }
}

/// The greatest depth in metres of a free particle in its sphere, and its greatest distance beyond its limit.
fn excess(body: &Body) -> [f32; 2] {
    let free = (0..body.particles.len()).filter(|&i| !body.particles.is_pinned(i));
    free.fold([f32::NEG_INFINITY; 2], |[depth, beyond], i| {
        let place = body.particles.position(i);
        let (centre, backstop) = body.particles.backstop(i).expect("it has one");
        let (middle, reach) = body.particles.motion_limit(i).expect("it has one");
        [depth.max(backstop.radius - place.distance(centre)), beyond.max(place.distance(middle) - reach)]
    })
}

/// No particle is in its sphere at the end of a step, nor beyond its limit, while the animation turns about and a pole pushes.
#[test]
fn backstops_and_limits_hold_through_all_that_pulls_and_pushes() {
    let mut worst = [f32::NEG_INFINITY; 2];
    let mut touched = 0;
    for (distance, radius, limit) in [(0.0, 0.2, 1.0), (0.01, 0.05, 0.3), (0.02, 3.0, 0.2), (0.0, 10.0, 2.0)]
    {
        let mut island = Island::of_body(sheet(unless_miri(24, 5), Backstop { distance, radius }, limit));
        let rest = positions(&island.bodies[0]);
        let pole = obstacle(Shape::Capsule { half_length: 1.0, radius: 0.1 }, Vec3::new(0.3, 1.5, 0.15), 0.5);
        let environment = Environment { obstacles: vec![pole].into(), ..gravity(FRAME) };
        for index in 1..=unless_miri(240, 3) {
            animate(&mut island.bodies[0], &rest, index as f32 * FRAME);
            step(&mut island, &environment).expect("a good step");
            let [depth, beyond] = excess(&island.bodies[0]);
            worst = [worst[0].max(depth), worst[1].max(beyond)];
            let body = &island.bodies[0].particles;
            touched += (0..body.len())
                .filter(|&i| {
                    body.backstop(i).is_some_and(|(c, b)| body.position(i).distance(c) < b.radius + 1e-5)
                })
                .count();
        }
    }
    println!(
        "law: particles are at most {:.1e} m in their backstops, and {:.1e} m beyond limits",
        worst[0], worst[1]
    );
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5, "{worst:?}");
    assert!(touched > 1000 || cfg!(miri), "{touched}: nothing leant on its backstop");
}

/// What meets a sphere loses its velocity towards it, and keeps the rest: no friction, no restitution.
#[test]
fn a_particle_that_meets_a_backstop_keeps_its_velocity_along_it() {
    for substeps in SUBSTEPS {
        // Almost a plane.
        let mut body = before_sphere(Vec3::new(0.0, 20.5, 0.0), Vec3::Y, 20.0, substeps);
        body.particles.set_velocity(0, Vec3::new(2.0, -3.0, 0.0));
        let mut island = Island::of_body(body);
        let met = |island: &Island| particles(island).position(0).length() < 20.001;
        for _ in 0..20 {
            step(&mut island, &weightless(FRAME)).expect("a good step");
            if met(&island) {
                break;
            }
        }
        let velocity = particles(&island).velocity(0);
        assert!(cfg!(miri) || met(&island));
        let outward = particles(&island).position(0).normalize();
        assert!(velocity.dot(outward).abs() < 0.02, "{velocity} m/s");
        let expected = Vec3::new(2.0, -3.0, 0.0).reject_from_normalized(outward);
        assert!((velocity - expected).length() < 0.02, "{velocity} m/s, expected {expected}");
    }
}

/// A particle that slides from the top of a smooth sphere leaves it where it has fallen by a third of the radius, with the
/// velocity of that fall.
#[test]
fn a_particle_slides_off_a_smooth_sphere_after_a_third_of_its_radius() {
    for substeps in SUBSTEPS {
        let radius = 0.5;
        let start = Vec3::new(0.01, (radius * radius - 1e-4_f32).sqrt(), 0.0);
        let mut island = Island::of_body(before_sphere(start, Vec3::Y, radius, substeps));
        let mut left = None;
        run_with(&mut island, &gravity(1.0 / 240.0), 1.5, |island, _| {
            let place = particles(island).position(0);
            if place.length() > radius + 3e-7 && left.is_none() {
                left = Some((place.y / radius, particles(island).velocity(0).length_squared()));
            }
        });
        let (height, speed) = left.unwrap_or_default();
        println!("law: in {substeps} substeps it leaves at {height} r, at {} of g r", speed / (G * radius));
        assert!(cfg!(miri) || (height - 2.0 / 3.0).abs() < 0.02, "{height} r");
        assert!(cfg!(miri) || (speed / (G * radius) - 2.0 / 3.0).abs() < 0.05);
    }
}

/// A sphere that comes along with its animation pushes the particle at its own speed, and no faster.
#[test]
fn a_moving_backstop_pushes_at_its_own_speed() {
    for substeps in SUBSTEPS {
        let (radius, speed) = (0.3, 2.0);
        let mut island = Island::of_body(before_sphere(Vec3::Y * 0.5, Vec3::Y, radius, substeps));
        run_with_pose(&mut island, 30, |time| (Vec3::Y * (radius + speed * time), Vec3::Y));
        let velocity = particles(&island).velocity(0);
        assert!((velocity - Vec3::Y * speed).length() < 1e-3, "{velocity} m/s");
    }
}

/// Moves the only backstop, and steps without gravity.
fn run_with_pose(island: &mut Island, steps: usize, pose: impl Fn(f32) -> (Vec3, Vec3)) {
    for index in 1..=steps {
        let (place, normal) = pose(index as f32 * FRAME);
        island.bodies[0].particles.set_backstop_pose(0, place, normal);
        step(island, &weightless(FRAME)).expect("a good step");
    }
}

/// A particle that begins deep in its sphere is put out of it, not thrown.
#[test]
fn a_particle_that_begins_in_its_sphere_is_not_thrown() {
    for substeps in SUBSTEPS {
        let mut island = Island::of_body(before_sphere(Vec3::Y * 0.1, Vec3::Y, 0.3, substeps));
        run(&mut island, &weightless(FRAME), 0.2);
        assert!((particles(&island).position(0) - Vec3::Y * 0.3).length() < 1e-6);
        assert!(greatest_speed(&island) < 1e-6, "{} m/s", greatest_speed(&island));
    }
}

/// The place of a large sphere stays while its normal turns, by up to a fifth of a radian a step: what lies there is not touched.
/// A middle on its straight way would come 25 mm nearer.
#[test]
fn a_large_sphere_that_turns_about_the_animated_place_does_not_push() {
    for substeps in SUBSTEPS {
        let radius = 5.0;
        let mut island = Island::of_body(before_sphere(Vec3::Y * radius, Vec3::Y, radius, substeps));
        run_with_pose(&mut island, unless_miri(60, 3), |time| {
            (Vec3::Y * radius, Quat::from_rotation_x(libm::sinf(12.0 * time)) * Vec3::Y)
        });
        let off = particles(&island).position(0).distance(Vec3::Y * radius);
        // The rounding of the sphere's middle.
        assert!(off < 5e-3, "{off} m");
    }
}

/// A backstop that is not touched changes no bit.
#[test]
fn a_backstop_out_of_reach_changes_no_bit() {
    let plain = Backstop { distance: 5.0, radius: 1.0 };
    let mut islands = [sheet(16, plain, 1.0), sheet(16, plain, 1.0)].map(Island::of_body);
    islands[1].bodies[0].particles.clear_backstops();
    for _ in 0..unless_miri(60, 2) {
        islands.iter_mut().for_each(|island| step(island, &gravity(FRAME)).expect("a good step"));
    }
    assert_eq!(hash(&islands[0]), hash(&islands[1]));
}

/// Aboard a ship in uniform motion a particle slides around its backstop as on land.
#[test]
fn a_backstop_in_uniform_motion_is_as_one_at_rest() {
    let after = |velocity: Vec3| {
        let mut island = Island::of_body(before_sphere(Vec3::new(0.05, 0.6, 0.0), Vec3::Y, 0.5, 4));
        island.bodies[0].particles.set_velocity(0, velocity + Vec3::NEG_Y * 2.0);
        let steps = unless_miri(30, 2);
        run_with_pose(&mut island, steps, |time| (Vec3::Y * 0.5 + velocity * time, Vec3::Y));
        particles(&island).position(0) - velocity * (FRAME * steps as f32)
    };
    let off = after(Vec3::new(3.0, -2.0, 5.0)).distance(after(Vec3::ZERO));
    assert!(off < 1e-4, "{off} m off");
}

/// A limit too short to leave the sphere holds; one that is long enough holds together with the backstop.
#[test]
fn a_limit_within_the_sphere_wins() {
    for (reach, is_out) in [(0.05, false), (0.15, true)] {
        let mut body = loose(&[Vec3::ZERO], bare());
        let backstop = Backstop { distance: -0.1, radius: 0.2 };
        body.particles.set_backstop(0, Vec3::ZERO, Vec3::Y, backstop).expect("valid");
        body.particles.set_motion_limit(0, Vec3::ZERO, reach);
        let mut island = Island::of_body(body);
        run(&mut island, &gravity(FRAME), 1.0);
        let [depth, beyond] = excess(&island.bodies[0]);
        assert!(beyond < 1e-6, "{beyond} m beyond the limit");
        assert_eq!(depth < 1e-6, is_out, "{depth} m");
    }
}

/// A whole step and its stages one by one give the same bits, on every instruction set.
#[test]
fn bits_depend_neither_on_instructions_nor_on_the_way_stages_are_run() {
    assert_same_on_all(|isa, take_step| {
        let backstop = Backstop { distance: 0.01, radius: 0.4 };
        let mut island = Island { isa, ..Island::of_body(sheet(unless_miri(64, 6), backstop, 0.3)) };
        let rest = positions(&island.bodies[0]);
        let floor = vec![Obstacle::ground(), obstacle(Shape::Sphere { radius: 0.2 }, Vec3::Y * 1.5, 0.5)];
        let environment = Environment { obstacles: floor.into(), ..gravity(FRAME) };
        for index in 1..=unless_miri(40, 2) {
            animate(&mut island.bodies[0], &rest, index as f32 * FRAME);
            take_step(&mut island, &environment);
        }
        hash(&island)
    });
}

/// A body continues identically after its state was saved and restored.
#[test]
fn a_restored_body_goes_on_with_the_same_bits() {
    let backstop = Backstop { distance: 0.01, radius: 0.4 };
    assert_goes_on_when_restored(
        [sheet(12, backstop, 0.2), sheet(12, Backstop { distance: 0.3, radius: 0.1 }, 0.7)],
        animate,
    );
}

/// Backstops and drives stay with their particles when the cloth is cut, and when the body is teleported.
#[test]
fn pieces_keep_their_backstops_and_drives() {
    let mut body = sheet(12, Backstop { distance: 0.01, radius: 0.4 }, 0.1);
    let blade = [Vec3::new(0.05, 3.0, -1.0), Vec3::new(0.05, 3.0, 1.0), Vec3::new(0.05, -3.0, 0.0)];
    let of = |body: &Body, i: usize| (body.particles.backstop(i), body.particles.pose_drive(i));
    let known: Vec<_> = (0..body.particles.len()).map(|i| of(&body, i)).collect();
    let torn = body.cut(&[blade]).expect("valid").expect("in two");
    let pieces = torn.pieces.iter().map(|piece| (&piece.body, &piece.origins));
    for (piece, origins) in pieces.chain([(&body, &torn.origins)]) {
        for (i, &origin) in origins.iter().enumerate() {
            assert_eq!(of(piece, i), known[origin as usize]);
        }
    }
}

/// A teleport turns places and normals with the particles.
#[test]
fn a_teleported_body_keeps_its_backstops_and_drives() {
    let mut body = sheet(8, Backstop { distance: 0.01, radius: 0.4 }, 0.1);
    let [from, to] = [(Vec3::ZERO, 0.0), (Vec3::new(30.0, 2.0, -9.0), 2.0)].map(|(translation, angle)| {
        drape_solver::Placement { translation, rotation: Quat::from_rotation_x(angle) }
    });
    let distances = |body: &Body| -> Vec<[f32; 2]> {
        let of = |i: usize| {
            let place = body.particles.position(i);
            let driven = body.particles.pose_drive(i).map_or(0.0, |(to, _)| to.distance(place));
            [body.particles.backstop(i).expect("it has one").0.distance(place), driven]
        };
        (0..body.particles.len()).map(of).collect()
    };
    let before = distances(&body);
    body.particles.teleport(&from, &to);
    for (now, before) in distances(&body).iter().zip(&before) {
        assert!((now[0] - before[0]).abs() < 1e-5 && (now[1] - before[1]).abs() < 1e-5);
    }
    // It moves nothing in the next step either, once the sheet hangs still in its plane.
    let place = body.particles.position(20);
    let mut island = Island::of_body(body);
    step(&mut island, &weightless(FRAME)).expect("a good step");
    assert!(particles(&island).position(20).distance(place) < 1e-4);
}

#[test]
fn impossible_backstops_are_refused() {
    let mut body = loose(&[Vec3::ZERO], bare());
    let good = Backstop { distance: 0.0, radius: 1.0 };
    for bad in [
        Backstop { radius: -0.1, ..good },
        Backstop { radius: f32::NAN, ..good },
        Backstop { radius: f32::INFINITY, ..good },
        Backstop { distance: f32::NAN, ..good },
    ] {
        assert!(body.particles.set_backstop(0, Vec3::ZERO, Vec3::Y, bad).is_err(), "{bad:?}");
    }
    for (place, normal) in [(Vec3::ZERO, Vec3::ZERO), (Vec3::ZERO, Vec3::NAN), (Vec3::NAN, Vec3::Y)] {
        let error = body.particles.set_backstop(0, place, normal, good).expect_err("no pose");
        assert!(matches!(error, BuildError::NotPositive { .. } | BuildError::NotFinite { .. }));
    }
    assert!(!body.particles.follows_pose());
    // A pose that is not finite is found by the step.
    body.particles.set_backstop(0, Vec3::ZERO, Vec3::Y, good).expect("valid");
    body.particles.set_backstop_pose(0, Vec3::NAN, Vec3::Y);
    assert!(step(&mut Island::of_body(body), &weightless(FRAME)).is_err());
}
