//! A moving frame carries the cloth along without disturbing it.

use drape_solver::glam::{Quat, Vec3};
use drape_solver::state::measure;
use drape_solver::{
    Body, BodySettings, ClothBuilder, Edge, Environment, FrameMotion, Isa, Island, Placement, Shape,
    StateHasher, step,
};

use crate::common::*;

fn sheet(particles: u32) -> Body {
    ClothBuilder::new(1.0, 1.0, particles, particles)
        .placed(Vec3::new(-0.5, 2.0, 0.0), Vec3::X, Vec3::NEG_Y)
        .pin_edge(Edge::Top)
        .build(BodySettings::default())
        .expect("valid")
}

/// Placement of a character that runs and turns, at `time` in seconds.
fn character(time: f32) -> Placement {
    Placement {
        translation: Vec3::new(4.0 * libm::sinf(2.0 * time), 0.0, 3.0 * time),
        rotation: Quat::from_rotation_y(2.0 * libm::sinf(3.0 * time)),
    }
}

/// The position in the world of a point that is fixed to the character.
fn worn(place: &Placement, local: Vec3) -> Vec3 {
    place.rotation * local + place.translation
}

/// Runs a sheet on a rail that a character carries. `share` of the character's motion is the motion of the frame.
fn run(share: f32, steps: usize, mut take_step: impl FnMut(&mut Island, &Environment)) -> Island {
    let mut island = Island::of_body(sheet(unless_miri(33, 6)));
    let rest: Vec<Vec3> = island.bodies[0].particles.positions().collect();
    for index in 1..=steps {
        let [from, to] = [index - 1, index].map(|i| character(i as f32 * FRAME));
        let particles = &mut island.bodies[0].particles;
        for (i, &place) in rest.iter().enumerate() {
            particles.set_pin_target(i, worn(&to, place));
        }
        particles.move_frame(FrameMotion::between(&from, &to).scaled(share, share));
        take_step(&mut island, &gravity(FRAME));
    }
    island
}

fn whole(island: &mut Island, environment: &Environment) {
    step(island, environment).expect("a good step");
}

/// If the frame has all of the motion, a cloth hangs as on a character that stands still.
#[test]
fn a_cloth_that_inherits_nothing_hangs_as_on_one_who_stands() {
    let steps = unless_miri(180, 2);
    let hanging = {
        let mut island = Island::of_body(sheet(unless_miri(33, 6)));
        (0..steps).for_each(|_| whole(&mut island, &gravity(FRAME)));
        island
    };
    let mut off = [0.0_f32; 2];
    for (off, share) in off.iter_mut().zip([1.0, 0.0]) {
        let island = run(share, steps, whole);
        let place = character(steps as f32 * FRAME);
        let there = hanging.bodies[0].particles.positions().map(|local| worn(&place, local));
        let here = island.bodies[0].particles.positions();
        *off = here.zip(there).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    }
    println!("law: carried along, a cloth is {:.2e} m off; else {:.2} m", off[0], off[1]);
    assert!(off[0] < 0.01, "{} m off", off[0]);
    assert!(off[1] > 0.2 || cfg!(miri), "{} m off", off[1]);
}

/// The motion of the frame adds no velocity, and a lone particle goes where the frame goes.
#[test]
fn a_loose_particle_goes_with_the_frame() {
    for (substeps, velocity) in [(1, Vec3::ZERO), (7, Vec3::new(0.3, -1.0, 2.0))] {
        let settings = BodySettings { substeps, ..bare() };
        let start = Vec3::new(1.0, 2.0, -0.5);
        let mut body = loose(&[start], settings);
        body.particles.set_velocity(0, velocity);
        let mut island = Island::of_body(body);
        for index in 1..=60 {
            let [from, to] = [index - 1, index].map(|i| character(i as f32 * FRAME));
            island.bodies[0].particles.move_frame(FrameMotion::between(&from, &to));
            step(&mut island, &weightless(FRAME)).expect("a good step");
        }
        let place = character(1.0);
        let particles = &island.bodies[0].particles;
        // In the frame the particle flies straight on.
        let expected = worn(&place, start + velocity);
        assert!(particles.position(0).distance(expected) < 1e-3, "{}", particles.position(0));
        assert!(particles.velocity(0).distance(place.rotation * velocity) < 1e-3);
    }
}

/// A cloth on a wagon whose motion is that of the frame does not slip, and friction does not push it.
#[test]
fn friction_sees_the_motion_of_the_frame() {
    let settings = BodySettings { substeps: 8, friction: 0.5, ..bare() };
    let body = loose(&[Vec3::new(0.0, 0.51, 0.0)], BodySettings { thickness: 0.01, ..settings });
    let mut island = Island::of_body(body);
    let waggon = obstacle(Shape::Cuboid { half_extents: Vec3::new(2.0, 0.5, 2.0) }, Vec3::ZERO, 0.5);
    let mut environment = Environment { obstacles: vec![waggon].into(), ..gravity(FRAME) };
    let mut place = Placement::default();
    for _ in 0..120 {
        let next = Placement::at(place.translation + Vec3::X * 3.0 * FRAME);
        environment.obstacles[0].move_to(next, FRAME);
        island.bodies[0].particles.move_frame(FrameMotion::between(&place, &next));
        step(&mut island, &environment).expect("a good step");
        place = next;
    }
    let particles = &island.bodies[0].particles;
    let slip = particles.position(0).x - place.translation.x;
    assert!(slip.abs() < 1e-3, "slipped {slip} m");
    assert!(particles.velocity(0).length() < 1e-2, "{}", particles.velocity(0));
}

/// A teleport moves everything, and changes nothing else.
#[test]
fn a_teleport_throws_nothing() {
    let mut island = Island::of_body(sheet(16));
    for i in 0..island.bodies[0].particles.len() {
        let place = island.bodies[0].particles.position(i);
        island.bodies[0].particles.set_motion_limit(i, place, 0.3);
    }
    let mut other = island.clone();
    let to = Placement { translation: Vec3::new(100.0, 20.0, -300.0), rotation: Quat::from_rotation_y(2.0) };
    for index in 0..unless_miri(60, 2) {
        if index == 20 {
            other.bodies[0].particles.teleport(&Placement::default(), &to);
        }
        whole(&mut island, &gravity(FRAME));
        whole(&mut other, &gravity(FRAME));
    }
    let [here, there] = [&island, &other].map(|island| &island.bodies[0].particles);
    for i in 0..here.len() {
        assert!(there.position(i).distance(worn(&to, here.position(i))) < 2e-3);
        assert!(there.velocity(i).distance(to.rotation * here.velocity(i)) < 0.05);
    }
    let stretch = measure::stretch(there, &other.bodies[0].topology);
    assert!(stretch.max < 0.05, "{}", stretch.max);
}

#[test]
fn bits_depend_neither_on_instructions_nor_on_the_way_stages_are_run() {
    let hash = |island: &Island| StateHasher::new().particles(&island.bodies[0].particles).finish();
    let steps = unless_miri(30, 2);
    let expected = hash(&run(0.7, steps, whole));
    let staged = run(0.7, steps, |island, environment| {
        step::begin(island, environment).expect("valid");
        step::accumulate_forces(island, environment);
        step::detect_collisions(island, environment);
        (0..island.substeps()).for_each(|_| step::substep(island, environment));
        step::finish(island).expect("finite");
    });
    assert_eq!(hash(&staged), expected);
    for isa in Isa::available() {
        let run = run(0.7, steps, |island, environment| {
            island.isa = isa;
            whole(island, environment);
        });
        assert_eq!(hash(&run), expected, "{isa:?}");
    }
}
