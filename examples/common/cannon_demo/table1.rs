//! `--table1`: the founding paper's Table 1, collision detection of five shots by five methods.

use std::fs;

use drape_bench::Failure;
use drape_bench::bombardment::{Bombardment, Shot as BenchShot};
use drape_bench::table1::{CurtainReport, measure};
use drape_solver::{BallMaterial, BodySettings};
use serde::Serialize;
use thiserror::Error;

use crate::cannon_demo::arguments::Arguments;
use crate::cannon_demo::output::{Output, OutputError};
use crate::cannon_demo::scene::{
    CURTAIN_DRAG, CURTAIN_SIZE, CannonScene, MUZZLE, STEP, cannon_ball, curtain_clearance,
};
use crate::cannon_demo::shot::{SHOT_INTERVAL, Shot};

/// Why there is no table.
#[derive(Debug, Error)]
pub enum Table1Error {
    /// It could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The solver refused the scene.
    #[error(transparent)]
    Solver(#[from] Failure),
}

/// `table1.json`.
#[derive(Serialize)]
struct Table1 {
    /// The demo's curtain.
    #[serde(flatten)]
    curtain: CurtainReport,
    /// The same shots at a finer curtain.
    fine: CurtainReport,
}

/// The scene and its shots without an engine.
pub fn bombardment(scene: &CannonScene) -> Bombardment {
    let shot = |index| {
        let shot = Shot::planned(index);
        BenchShot { time: shot.time, muzzle: MUZZLE, velocity: shot.velocity().as_vec3() }
    };
    let ball = cannon_ball();
    Bombardment {
        size: CURTAIN_SIZE.to_array(),
        clearance: curtain_clearance(),
        particles: scene.particles.to_array(),
        settings: BodySettings {
            substeps: scene.substeps,
            iterations: scene.iterations,
            drag: CURTAIN_DRAG,
            ..BodySettings::default()
        },
        ball: BallMaterial {
            radius: ball.radius,
            mass: ball.mass,
            rolling_resistance: ball.rolling_resistance,
            ..BallMaterial::default()
        },
        shots: (0..scene.shots).map(shot).collect(),
        step: STEP as f32,
        gravity: *bevy_drape::prelude::DrapeGravity::default(),
        rest: SHOT_INTERVAL,
    }
}

/// Measures both curtains, prints both tables and writes `table1.json`.
///
/// # Errors
/// [`Table1Error`].
pub fn run(arguments: &Arguments) -> Result<(), Table1Error> {
    let output = Output::create(&arguments.out, "table1.json")?;
    let scene = arguments.scene();
    let measured = |scene: &CannonScene| -> Result<CurtainReport, Table1Error> {
        let report = measure(&bombardment(scene), |_| {})?;
        println!("{}\n", report.table());
        Ok(report)
    };
    let curtain = measured(&scene)?;
    let fine = measured(&CannonScene { particles: arguments.table1_fine, ..scene })?;
    let path = output.path("table1.json");
    let failed = |source| OutputError::File { path: path.clone(), source };
    let json =
        serde_json::to_string_pretty(&Table1 { curtain, fine }).map_err(|error| failed(error.into()))?;
    fs::write(&path, json).map_err(failed)?;
    println!("the figures are in {}", path.display());
    Ok(())
}
