//! Damping along the sticks: it takes energy and neither momentum nor angular momentum, whatever a body's sticks are stored as, and a
//! damped body takes the same steps in sweeps, by stages and on any number of threads.

use drape_solver::glam::Vec3;
use drape_solver::step::step_on;
use drape_solver::{
    Body, BodySettings, ClothBuilder, ClothMaterial, Environment, Island, Preset, Shape, StickBound,
    StickKind, StickMaterial,
};

use crate::common::*;
use crate::determinism::Fresh;

/// Settings with which nothing but sticks acts.
fn alone() -> BodySettings {
    BodySettings { substeps: 4, tethers: false, ..bare() }
}

fn sheet() -> ClothBuilder {
    ClothBuilder::new(1.0, 0.9, 24, 21)
}

/// Sticks that do nothing but damp.
fn damped(damping: f32) -> ClothMaterial {
    let [stretch_stiffness, shear_stiffness, bend_stiffness] = [0.0; 3];
    ClothMaterial { stretch_stiffness, shear_stiffness, bend_stiffness, damping, ..ClothMaterial::default() }
}

/// The same sheet by families of a grid, by listed sticks, and with loose ones beside a slit.
fn sheets(material: ClothMaterial) -> [(&'static str, Body); 3] {
    let grid = || sheet().material(material).build(alone()).expect("valid");
    let mut torn = grid();
    let cut = torn.cut(&blade(Vec3::new(0.4, 0.1, 0.0), Vec3::new(0.6, -0.5, 0.0))).expect("valid");
    assert!(cut.is_some(), "the blade opens a slit");
    [("grid", grid()), ("listed", mesh_of(sheet(), material, alone())), ("torn", torn)]
}

#[test]
fn damping_takes_energy_and_keeps_momentum_however_sticks_are_stored() {
    let end = |mut body: Body, name: &str| {
        let mut dice = Dice::new(3);
        (0..body.particles.len()).for_each(|i| body.particles.set_velocity(i, dice.vector(1.0)));
        let mut island = Island::of_body(body);
        let [before, turning] = [momentum(&island), angular_momentum(&island)];
        let scale = (2.0 * kinetic_energy(&island) * 0.1).sqrt();
        run(&mut island, &weightless(FRAME), 0.2);
        let error = (momentum(&island) - before).length() / scale;
        assert!(error < 1e-5, "{name}: momentum is off by {error}");
        let error = (angular_momentum(&island) - turning).length() / scale;
        assert!(error < 1e-5, "{name}: angular momentum is off by {error}");
        kinetic_energy(&island)
    };
    for ((name, free), (_, braked)) in sheets(damped(0.0)).into_iter().zip(sheets(damped(20.0))) {
        let [free, braked] = [end(free, name), end(braked, name)];
        assert!(braked < 0.3 * free, "{name}: {braked} J are left of {free} J");
    }
}

/// A sheet of cotton that is large enough for sweeps falls on a moving sphere; one of its corners is dragged, if it `is_dragged`.
fn hash_of_cotton(is_dragged: bool, take: impl Fn(&mut Island, &Environment)) -> u64 {
    let material = Preset::Cotton.material();
    assert!(material.damping > 0.0, "every preset is damped");
    let cotton = ClothBuilder::new(2.0, 2.0, 100, 90)
        .placed(Vec3::new(-1.0, 1.0, -1.0), Vec3::X, Vec3::Z)
        .material(material)
        .pin(0)
        .pin(99)
        .build(BodySettings { substeps: 4, ..swept() })
        .expect("valid");
    let mut island = Island::of_body(cotton);
    let mut environment = gravity(FRAME);
    let sphere = Shape::Sphere { radius: 0.5 };
    environment.obstacles = vec![obstacle(sphere, Vec3::new(0.0, 0.3, 0.0), 0.5)].into();
    for _ in 0..30 {
        if is_dragged {
            let particles = &mut island.bodies[0].particles;
            particles.set_pin_target(99, particles.position(99) + Vec3::X * 0.01);
        }
        take(&mut island, &environment);
    }
    hash(&island)
}

/// Damping was a loop over single sticks, and a damped body went stage by stage: a cloth of any preset took 17 to 32 times as long as one
/// without damping.
#[test]
fn a_damped_cloth_takes_the_same_steps_in_sweeps_by_stages_and_on_threads() {
    for is_dragged in [false, true] {
        let swept = hash_of_cotton(is_dragged, step_whole);
        assert_eq!(hash_of_cotton(is_dragged, step_staged), swept, "by stages, dragged: {is_dragged}");
        let shared = hash_of_cotton(is_dragged, |island, environment| {
            step_on(island, environment, &Fresh(3)).expect("finite");
        });
        assert_eq!(shared, swept, "three threads, dragged: {is_dragged}");
    }
}

/// Damping of ties, which act at one side: within a thousandth of their bound only. Far from it the ends part as they like.
#[test]
fn what_is_slack_is_not_damped() {
    let rigid = StickMaterial::rigid(StickKind::Structural);
    let material = StickMaterial { damping: 50.0, bound: StickBound::AtMost, ..rigid };
    let mut body = joined_by(material, &[Vec3::ZERO, Vec3::X], &[1.0, 1.0], &[[0, 1]], alone());
    body.particles.set_position(1, Vec3::X * 0.5);
    body.particles.set_velocity(1, Vec3::X);
    let mut island = Island::of_body(body);
    run(&mut island, &weightless(FRAME), 0.1);
    let speed = particles(&island).velocity(1).x;
    assert!((speed - 1.0).abs() < 1e-5, "{speed} m/s of 1");
}
