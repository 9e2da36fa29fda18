//! `--soak SECONDS`: a shot every second, and old balls taken away. Neither memory nor the time of a step may grow, and all
//! positions stay finite.

use std::fs;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::ball::ProjectileState;
use bevy_drape::cannon::{Cannon, CannonFired, FireCannon};
use bevy_drape::clock::DrapeClock;
use bevy_drape::contact::{BallHit, HitTarget};
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;
use serde::Serialize;

use crate::cannon_demo::arguments::Arguments;
use crate::cannon_demo::headless::task_pools;
use crate::cannon_demo::output::{Output, OutputError};
use crate::cannon_demo::plugin::CannonScenePlugin;
use crate::cannon_demo::scene::{CannonScene, Curtain, STEP};
use crate::cannon_demo::shot::Shot;

/// Time between shots, in seconds.
const INTERVAL: f64 = 1.0;
/// Age at which a ball is taken away, in seconds.
const OLD: f64 = 10.0;

/// `soak.json`.
#[derive(Clone, Debug, Serialize)]
pub struct SoakReport {
    /// Steps taken.
    pub steps: u64,
    /// Shots fired.
    pub shots: u32,
    /// Each minute of simulated time; the last may be shorter.
    pub minutes: Vec<Minute>,
    /// True if any position or velocity was not finite at the end of any step.
    pub any_nan: bool,
}

/// The measurements of one minute of simulated time.
#[derive(Clone, Debug, Serialize)]
pub struct Minute {
    /// Memory of the process at its end, in MiB; none where the system does not tell.
    pub resident_mib: Option<f64>,
    /// Median wall time of its steps, in milliseconds.
    pub median_step_ms: f64,
    /// Entities at its end.
    pub entities: u32,
    /// Hits on the curtain.
    pub hits: u32,
}

/// The state that the systems of the soak share.
#[derive(Resource, Default)]
pub struct Soak {
    shots: u32,
    /// Balls and when they were fired, oldest first.
    balls: Vec<(Entity, f64)>,
    hits: u32,
    any_nan: bool,
}

/// The demo's scene under fire.
pub fn app(scene: CannonScene, threads: u16) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins.set(task_pools(threads)), DrapePlugins::default()))
        .add_plugins(CannonScenePlugin(CannonScene { shots: 0, ..scene }))
        .init_resource::<Soak>()
        .add_systems(FixedUpdate, (fire, take_old_balls))
        .add_systems(DrapeSchedule, watch.after(DrapeSystems::Finish))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.finish();
    app.cleanup();
    app.update();
    app
}

/// Fires the demo's shots in turn.
fn fire(
    clock: Res<DrapeClock>,
    mut soak: ResMut<Soak>,
    mut cannons: Query<(Entity, &mut Cannon)>,
    mut fire: MessageWriter<FireCannon>,
) {
    if clock.elapsed() + 0.5 * STEP < INTERVAL * f64::from(soak.shots + 1) {
        return;
    }
    let shot = Shot::planned(soak.shots);
    soak.shots += 1;
    for (entity, mut cannon) in &mut cannons {
        shot.aim(&mut cannon);
        fire.write(FireCannon { cannon: entity });
    }
}

fn take_old_balls(
    mut commands: Commands,
    clock: Res<DrapeClock>,
    mut soak: ResMut<Soak>,
    mut fired: MessageReader<CannonFired>,
) {
    let now = clock.elapsed();
    soak.balls.extend(fired.read().map(|fired| (fired.projectile, now)));
    let old = soak.balls.iter().take_while(|(_, since)| now - since > OLD).count();
    for (ball, _) in soak.balls.drain(..old) {
        commands.entity(ball).despawn();
    }
}

fn watch(
    mut soak: ResMut<Soak>,
    mut hits: MessageReader<BallHit>,
    curtains: Query<&Particles, With<Curtain>>,
    balls: Query<&ProjectileState>,
) {
    soak.hits += hits.read().filter(|hit| hit.kind == HitTarget::Body).count() as u32;
    let all_finite =
        curtains.iter().all(|particles| particles.is_finite()) && balls.iter().all(|ball| ball.is_finite());
    soak.any_nan |= !all_finite;
}

/// Soaks an [`app`] for so many simulated seconds. Calls `on_step` with the time.
pub fn soak(app: &mut App, seconds: u32, mut on_step: impl FnMut(f64)) -> SoakReport {
    let steps = (f64::from(seconds) / STEP).round() as u64;
    let a_minute = (60.0 / STEP).round() as usize;
    let mut minutes = Vec::with_capacity(seconds.div_ceil(60) as usize);
    let mut walls: Vec<Duration> = Vec::with_capacity(a_minute);
    let mut hits = 0;
    for step in 1..=steps {
        let start = Instant::now();
        app.update();
        walls.push(start.elapsed());
        on_step(step as f64 * STEP);
        if walls.len() == a_minute || step == steps {
            walls.sort_unstable();
            let all_hits = app.world().resource::<Soak>().hits;
            minutes.push(Minute {
                resident_mib: resident_mib(),
                median_step_ms: walls[walls.len() / 2].as_secs_f64() * 1e3,
                entities: app.world().entities().count_spawned(),
                hits: all_hits - hits,
            });
            hits = all_hits;
            walls.clear();
        }
    }
    let &Soak { shots, any_nan, .. } = app.world().resource::<Soak>();
    SoakReport { steps, shots, minutes, any_nan }
}

/// Memory of this process in MiB; none where there is no `/proc`.
fn resident_mib() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes / 1024.0)
}

/// Soaks the scene, prints a line a minute and writes `soak.json`.
///
/// # Errors
/// An error of the output, if a file cannot be written.
pub fn run(arguments: &Arguments, seconds: u32) -> Result<(), OutputError> {
    let output = Output::create(&arguments.out, "soak.json")?;
    let report = soak(&mut app(arguments.scene(), arguments.threads), seconds, |_| {});
    for (index, minute) in report.minutes.iter().enumerate() {
        let resident = minute.resident_mib.map_or("-".to_owned(), |mib| format!("{mib:.1}"));
        println!(
            "minute {}: step {:.3} ms (median), {resident} MiB, {} entities, {} hits",
            index + 1,
            minute.median_step_ms,
            minute.entities,
            minute.hits
        );
    }
    let SoakReport { steps, shots, any_nan, .. } = &report;
    println!("{steps} steps, {shots} shots; {}", if *any_nan { "not all was finite" } else { "all finite" });
    let path = output.path("soak.json");
    let failed = |source| OutputError::File { path: path.clone(), source };
    let json = serde_json::to_string_pretty(&report).map_err(|error| failed(error.into()))?;
    fs::write(&path, json).map_err(failed)
}
