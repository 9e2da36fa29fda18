//! Watches the scene step by step, for the report and the plot.

use std::time::Duration;

use bevy::prelude::*;
use bevy_drape::ball::ProjectileState;
use bevy_drape::body::{Activity, Sticks};
use bevy_drape::cannon::CannonFired;
use bevy_drape::clock::DrapeClock;
use bevy_drape::contact::BallHit;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeSchedule;
use bevy_drape::schedule::StepTimes;
use bevy_drape::sleep::ActivityCounts;
use drape_solver::StateHasher;
use drape_solver::state::measure;

use crate::cannon_demo::report::{
    ActivitySample, CurtainReport, Report, SceneReport, ShotReport, TimingReport, VERSION,
};
use crate::cannon_demo::scene::{CannonScene, Curtain, STEP, cannon_ball};
use crate::cannon_demo::shot::Shot;

/// If the ball stays in the cloth, its speed is taken this long after the first touch, in seconds.
const SPEED_AFTER: f64 = 0.5;

/// Records every step.
pub struct RecorderPlugin;

impl Plugin for RecorderPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Recorder>().add_systems(DrapeSchedule, record.after(DrapeSystems::Finish));
    }
}

/// One step, for the plot.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Simulated time in seconds.
    pub time: f64,
    /// Speed of the fastest ball in m/s.
    pub ball_speed: f64,
    /// Kinetic energy of the curtain in joules.
    pub kinetic_energy: f64,
    /// Greatest stretch of a structural stick.
    pub max_stretch: f64,
    /// Farthest that a particle is from where it hung before the first shot, in metres.
    pub deflection: f64,
}

/// A shot that was fired.
struct ShotRecord {
    shot: Shot,
    ball: Entity,
    fired_at: f64,
    hit: Option<BallHit>,
    speed_after: Option<f64>,
    deflection: f64,
    collision: Duration,
}

/// The record of the run so far.
#[derive(Resource, Default)]
pub struct Recorder {
    samples: Vec<Sample>,
    shots: Vec<ShotRecord>,
    activity: Vec<ActivitySample>,
    walls: Vec<Duration>,
    /// The curtain before the first shot.
    hanging: Vec<Vec3>,
    peak_stretch: f64,
    max_penetration: f64,
    last_hit: f64,
    asleep_at: Option<f64>,
}

fn record(
    mut recorder: ResMut<Recorder>,
    clock: Res<DrapeClock>,
    times: Res<StepTimes>,
    counts: Res<ActivityCounts>,
    mut fired: MessageReader<CannonFired>,
    mut hits: MessageReader<BallHit>,
    curtains: Query<(Entity, &Particles, &Sticks, &Activity), With<Curtain>>,
    balls: Query<(&ProjectileState, &Activity)>,
) {
    let Ok((curtain, particles, sticks, activity)) = curtains.single() else {
        return;
    };
    let recorder = &mut *recorder;
    let time = clock.elapsed() + f64::from(clock.delta());
    for fired in fired.read() {
        if recorder.hanging.is_empty() {
            recorder.hanging.extend(particles.positions());
        }
        recorder.shots.push(ShotRecord {
            shot: Shot::planned(recorder.shots.len() as u32),
            ball: fired.projectile,
            fired_at: clock.elapsed(),
            hit: None,
            speed_after: None,
            deflection: 0.0,
            collision: Duration::ZERO,
        });
    }
    for hit in hits.read().filter(|hit| hit.target == curtain) {
        let of_ball = |shot: &&mut ShotRecord| shot.ball == hit.projectile;
        if let Some(shot) = recorder.shots.iter_mut().find(of_ball) {
            shot.hit.get_or_insert(*hit);
            recorder.last_hit = hit.time;
        }
    }
    recorder.note_speeds_after(particles, &balls, time);
    let stretch = measure::stretch(particles, sticks);
    let moved = particles.positions().zip(&recorder.hanging).map(|(now, then)| now.distance(*then));
    let deflection = f64::from(moved.fold(0.0, f32::max));
    if let Some(shot) = recorder.shots.last_mut() {
        shot.deflection = shot.deflection.max(deflection);
        shot.collision += times.detect_collisions;
    }
    recorder.peak_stretch = recorder.peak_stretch.max(stretch.max);
    let penetration = f64::from(deepest(particles, &balls));
    recorder.max_penetration = recorder.max_penetration.max(penetration);
    recorder.asleep_at = match activity {
        Activity::Active => None,
        _ => recorder.asleep_at.or(Some(time)),
    };
    let speeds = balls.iter().filter(|(_, activity)| **activity == Activity::Active);
    recorder.samples.push(Sample {
        time,
        ball_speed: speeds.map(|(ball, _)| f64::from(ball.velocity().length())).fold(0.0, f64::max),
        kinetic_energy: measure::kinetic_energy(particles),
        max_stretch: stretch.max,
        deflection,
    });
    if recorder.activity.last().is_none_or(|last| time - last.time_s > 1.0 - 0.5 * STEP) {
        let ActivityCounts { active, resting, culled, .. } = *counts;
        recorder.activity.push(ActivitySample { time_s: time, active, resting, culled });
    }
}

/// Deepest that a particle lies in the ground or a ball, in metres.
fn deepest(particles: &Particles, balls: &Query<(&ProjectileState, &Activity)>) -> f32 {
    let radius = cannon_ball().radius;
    let mut deepest = 0.0_f32;
    for position in particles.positions() {
        deepest = deepest.max(-position.y);
        for (ball, _) in balls {
            deepest = deepest.max(radius - position.distance(ball.position()));
        }
    }
    deepest
}

impl Recorder {
    /// Notes how long the last step took on the wall clock.
    pub fn note_wall_time(&mut self, wall: Duration) {
        self.walls.push(wall);
    }

    /// True if, at `time`, a shot is still to be fired or its ball to hit.
    pub fn is_waiting(&self, scene: &CannonScene, time: f64) -> bool {
        let recent = |shot: &ShotRecord| shot.hit.is_none() && time - shot.fired_at < 3.0;
        self.shots.len() < scene.shots as usize || self.shots.iter().any(recent)
    }

    /// Time of the last hit, or of the start.
    pub fn last_hit(&self) -> f64 {
        self.last_hit
    }

    /// All steps.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Times of the hits, in seconds.
    pub fn hit_times(&self) -> impl Iterator<Item = f64> + '_ {
        self.shots.iter().filter_map(|shot| shot.hit.map(|hit| hit.time))
    }

    fn note_speeds_after(
        &mut self,
        particles: &Particles,
        balls: &Query<(&ProjectileState, &Activity)>,
        time: f64,
    ) {
        for shot in &mut self.shots {
            let (Some(hit), None, Ok((ball, _))) = (shot.hit, shot.speed_after, balls.get(shot.ball)) else {
                continue;
            };
            // Twice the greatest distance that a face's corners can be from a touching ball.
            let near = cannon_ball().radius + 0.1;
            let has_left = particles.positions().all(|p| p.distance(ball.position()) > near);
            if has_left || time - hit.time >= SPEED_AFTER {
                shot.speed_after = Some(f64::from(ball.velocity().length()));
            }
        }
    }

    /// The report, at the end of the run.
    pub fn report(&self, world: &mut World, threads: u16) -> Option<Report> {
        let scene = world.resource::<CannonScene>().clone();
        let mut curtains = world.query_filtered::<(&Particles, &Sticks), With<Curtain>>();
        let (particles, sticks) = curtains.single(world).ok()?;
        let stretch = measure::stretch(particles, sticks);
        let mut hasher = StateHasher::new();
        hasher.particles(particles);
        let mut shots = Vec::new();
        for (index, shot) in self.shots.iter().enumerate() {
            if let Some(ball) = world.get::<ProjectileState>(shot.ball) {
                hasher.ball(ball);
            }
            shots.push(shot.report(index as u32, world.get::<Activity>(shot.ball)));
        }
        let mut walls = self.walls.clone();
        walls.sort_unstable();
        let percentile = |part: f64| {
            let index = (part * walls.len().saturating_sub(1) as f64).round() as usize;
            walls.get(index).map_or(0.0, |wall| wall.as_secs_f64() * 1e3)
        };
        let wall: Duration = walls.iter().sum();
        Some(Report {
            version: VERSION,
            scene: SceneReport {
                particles: particles.len(),
                sticks: sticks.stick_count(),
                substeps: scene.substeps,
                iterations: scene.iterations,
                dt: STEP,
            },
            shots,
            curtain: CurtainReport {
                max_stretch: stretch.max,
                rms_stretch: stretch.rms,
                peak_stretch: self.peak_stretch,
                rest_time_s: self.asleep_at.map(|time| time - self.last_hit),
                max_penetration_m: self.max_penetration,
            },
            activity: self.activity.clone(),
            timing: TimingReport {
                steps: self.samples.len(),
                wall_ms_median: percentile(0.5),
                wall_ms_p99: percentile(0.99),
                realtime_factor: self.samples.len() as f64 * STEP / wall.as_secs_f64().max(1e-9),
                threads,
            },
            state_hash: format!("{:016x}", hasher.finish()),
        })
    }
}

impl ShotRecord {
    fn report(&self, index: u32, state: Option<&Activity>) -> ShotReport {
        let Self { shot, hit, .. } = self;
        let hit_time = hit.map(|hit| hit.time - self.fired_at);
        let path_error = hit
            .zip(hit_time)
            .map(|(hit, time)| hit.ball_position.as_dvec3().distance(shot.position_at(time)));
        ShotReport {
            index,
            time_s: self.fired_at,
            elevation_deg: f64::from(shot.elevation).to_degrees(),
            azimuth_deg: f64::from(shot.azimuth).to_degrees(),
            speed_m_s: f64::from(shot.speed),
            hit: hit.is_some(),
            hit_time_s: hit_time,
            predicted_hit_time_s: shot.predicted_hit_time(),
            path_error_m: path_error,
            curtain_max_deflection_m: self.deflection,
            ball_speed_before_m_s: hit.map(|hit| f64::from(hit.ball_velocity.length())),
            ball_speed_after_m_s: self.speed_after,
            ball_final_state: match state {
                Some(Activity::Active) => "active",
                Some(Activity::Resting) => "resting",
                Some(Activity::Frozen) => "frozen",
                Some(Activity::Culled) | None => "culled",
            },
            collision_ms: self.collision.as_secs_f64() * 1e3,
        }
    }
}
