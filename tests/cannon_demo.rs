//! The founding experiment as a test: five shots at the curtain, and what must come of them.

use bevy::prelude::*;
use bevy_drape::cannon::Cannon;
use bevy_drape::prelude::*;
use bevy_drape_script::scene::{Action, Body, SceneScript};
use drape_examples::cannon_demo::headless::{app, run_to_rest};
use drape_examples::cannon_demo::recorder::Recorder;
use drape_examples::cannon_demo::report::Report;
use drape_examples::cannon_demo::scene::{CannonScene, MUZZLE, STEP, cannon_ball, curtain_clearance};
use drape_examples::cannon_demo::shot::Shot;

fn run(scene: CannonScene) -> Report {
    let mut app = app(scene.clone(), 2);
    run_to_rest(&mut app, &scene, |_| {});
    let recorder = app.world_mut().remove_resource::<Recorder>().expect("the recorder");
    recorder.report(app.world_mut(), 2).expect("a curtain")
}

#[test]
fn five_shots_hit_and_the_curtain_finds_its_rest_again() {
    let report = run(CannonScene::default());
    assert_eq!(report.shots.len(), 5);
    for shot in &report.shots {
        let name = format!("shot {}", shot.index);
        assert!(shot.hit, "{name} missed");
        let (hit, predicted) = (shot.hit_time_s.expect("a time"), shot.predicted_hit_time_s);
        assert!((hit / predicted - 1.0).abs() < 0.03, "{name} hit after {hit} s, predicted {predicted} s");
        let off = shot.path_error_m.expect("a path");
        assert!(off < 0.01, "{name} was {off} m off its parabola");
        let (before, after) = (shot.ball_speed_before_m_s, shot.ball_speed_after_m_s);
        let (before, after) = (before.expect("a hit"), after.expect("a hit"));
        assert!(after < 0.8 * before, "{name}: the curtain took {before} m/s to {after} m/s only");
        assert_ne!(shot.ball_final_state, "active", "{name} never ends");
    }
    let deflection = report.shots.iter().map(|shot| shot.curtain_max_deflection_m).fold(0.0, f64::max);
    assert!(deflection > 0.2, "the curtain moved {deflection} m only");
    let curtain = &report.curtain;
    assert!(curtain.rest_time_s.expect("the curtain comes to rest") < 30.0);
    assert!(curtain.rms_stretch < 0.01, "rms stretch {}", curtain.rms_stretch);
    assert!(curtain.max_stretch < 0.05, "max stretch {}", curtain.max_stretch);
    assert!(curtain.max_penetration_m < 0.005, "penetration {}", curtain.max_penetration_m);

    // The same bits in debug and release, on any machine, with any number of threads.
    let golden = include_str!("golden/cannon.hash").trim();
    assert_eq!(
        report.state_hash, golden,
        "the cannon scene ends in other bits than it used to. If that is meant, write the new hash to \
         tests/golden/cannon.hash and give the reason in the commit message"
    );
}

fn small() -> CannonScene {
    CannonScene { particles: UVec2::new(20, 15), shots: 1, ..default() }
}

#[test]
fn two_runs_end_in_the_same_bits_and_another_scene_in_others() {
    let first = run(small());
    assert_eq!(first.state_hash, run(small()).state_hash);
    let finer = CannonScene { substeps: 20, ..small() };
    assert_ne!(first.state_hash, run(finer).state_hash);
}

#[test]
fn particles_substeps_and_iterations_override_the_scene() {
    let scene = CannonScene { substeps: 5, iterations: 3, ..small() };
    let report = run(scene).scene;
    assert_eq!((report.particles, report.substeps, report.iterations), (300, 5, 3));
}

#[test]
fn a_shot_that_is_never_fired_leaves_the_curtain_hanging() {
    let scene = CannonScene { shots: 0, ..small() };
    let report = run(scene);
    assert!(report.shots.is_empty());
    assert!(report.curtain.rest_time_s.is_some());
}

#[test]
fn few_substeps_do_not_let_the_ball_through() {
    let scene = CannonScene { substeps: 1, shots: 5, particles: UVec2::new(24, 18), ..default() };
    let report = run(scene);
    for shot in &report.shots {
        let (before, after) = (shot.ball_speed_before_m_s, shot.ball_speed_after_m_s);
        assert!(after.expect("a hit") < 0.8 * before.expect("a hit"), "shot {}", shot.index);
    }
}

/// The scene runner runs the same experiment from a file.
#[test]
fn the_scene_file_describes_the_demo() {
    let file = include_str!("../assets/scenes/cannon.scene.ron");
    let script =
        SceneScript::parse(file).and_then(|script| script.with(&[])).expect("a scene and its defaults");
    let (demo, settings) = (CannonScene::default(), &script.settings);
    assert!((settings.dt.get() - STEP).abs() < 1e-12);
    assert_eq!(settings.gravity.get(), DrapeGravity::default().0);
    assert!(script.obstacles.get("ground").is_some());
    let Some(Body::Cloth(curtain)) = script.bodies.get("curtain") else { panic!("no curtain") };
    assert_eq!(Cloth::from(curtain), demo.cloth());
    let surface = curtain.surface.over(settings.surface.over(BodySurface::default()));
    assert_eq!(Fabric::from(curtain).with_surface(surface), demo.fabric());
    assert_eq!(curtain.at.y - 0.5 * demo.cloth().size.y, curtain_clearance());
    let solver = curtain.solver.over(settings.solver.over(SolverSettings::default()));
    assert_eq!(solver, demo.settings());
    let cannon = script.cannons.get("cannon").expect("a cannon");
    assert_eq!((cannon.at.get(), Projectile::from(&cannon.ball)), (MUZZLE, cannon_ball()));
    let aims = script.timeline.iter().filter_map(|event| match &event.action {
        Action::Aim { aim, speed, .. } => Some((event.at?.get(), aim, *speed)),
        _ => None,
    });
    let mut shots = Vec::new();
    for (time, aim, speed) in aims {
        let mut aimed = cannon.clone();
        aimed.aim = aim.clone();
        aimed.speed = speed.unwrap_or(aimed.speed);
        let Cannon { elevation, azimuth, muzzle_speed: speed, .. } = aimed.component(settings.gravity);
        shots.push(Shot { time, elevation, azimuth, speed });
    }
    assert!(shots.into_iter().eq((0..demo.shots).map(Shot::planned)));
}

#[test]
fn the_demo_fires_no_more_shots_than_are_asked_for() {
    for shots in [2, 6] {
        let report = run(CannonScene { particles: UVec2::new(8, 6), shots, ..default() });
        assert_eq!(report.shots.len(), shots as usize);
    }
}
