//! The report that a headless run writes.

use serde::Serialize;

/// Version of the report's schema; grows when a field changes its meaning or goes away.
pub const VERSION: u32 = 1;

/// `report.json`. All units are SI; stretch is the fraction `|length / rest length - 1|` of structural sticks.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of this schema.
    pub version: u32,
    /// The scene.
    pub scene: SceneReport,
    /// The result of each shot.
    pub shots: Vec<ShotReport>,
    /// The state of the curtain.
    pub curtain: CurtainReport,
    /// Bodies in each state, once a second.
    pub activity: Vec<ActivitySample>,
    /// The cost of the run.
    pub timing: TimingReport,
    /// Hash of all positions and velocities at the end, as 16 hexadecimal digits.
    pub state_hash: String,
}

/// The scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    /// Particles of the curtain.
    pub particles: usize,
    /// Sticks of the curtain.
    pub sticks: usize,
    /// Substeps in a step.
    pub substeps: u32,
    /// Relaxation iterations in a substep.
    pub iterations: u32,
    /// Length of a step.
    pub dt: f64,
}

/// The result of one shot.
#[derive(Clone, Debug, Serialize)]
pub struct ShotReport {
    /// Number of the shot, from 0.
    pub index: u32,
    /// When it was fired.
    pub time_s: f64,
    /// Angle above the horizon.
    pub elevation_deg: f64,
    /// Angle to the left.
    pub azimuth_deg: f64,
    /// Speed at the muzzle.
    pub speed_m_s: f64,
    /// True if the ball touched the curtain.
    pub hit: bool,
    /// From the shot to the first touch, interpolated within the substep.
    pub hit_time_s: Option<f64>,
    /// From the shot to the resting curtain's plane less the ball's radius, by the closed form.
    pub predicted_hit_time_s: f64,
    /// Distance of the ball's centre from the closed-form path at the first touch.
    pub path_error_m: Option<f64>,
    /// Farthest that a particle of the curtain was from where it hung before the first shot.
    pub curtain_max_deflection_m: f64,
    /// Speed of the ball at the first touch.
    pub ball_speed_before_m_s: Option<f64>,
    /// Speed of the ball when it left the cloth, or half a second after the first touch.
    pub ball_speed_after_m_s: Option<f64>,
    /// `active`, `resting` or `culled` at the end of the run.
    pub ball_final_state: &'static str,
    /// Wall time spent on searching for collisions from this shot to the next, or to the end.
    pub collision_ms: f64,
}

/// The state of the curtain.
#[derive(Clone, Debug, Serialize)]
pub struct CurtainReport {
    /// Greatest stretch at the end of the run.
    pub max_stretch: f64,
    /// Root mean square stretch at the end of the run.
    pub rms_stretch: f64,
    /// Greatest stretch at the end of any step.
    pub peak_stretch: f64,
    /// From the last hit to the curtain's falling asleep; none if it never did.
    pub rest_time_s: Option<f64>,
    /// Deepest that a particle was in the ground or in a ball at the end of any step.
    pub max_penetration_m: f64,
}

/// Bodies in each state.
#[derive(Clone, Debug, Serialize)]
pub struct ActivitySample {
    /// When.
    pub time_s: f64,
    /// Simulated.
    pub active: usize,
    /// Asleep.
    pub resting: usize,
    /// Out of the play area or of sight.
    pub culled: usize,
}

/// The cost of the run.
#[derive(Clone, Debug, Serialize)]
pub struct TimingReport {
    /// Number of steps.
    pub steps: usize,
    /// Median wall time of a step.
    pub wall_ms_median: f64,
    /// 99th percentile of the wall time of a step.
    pub wall_ms_p99: f64,
    /// Simulated time over wall time.
    pub realtime_factor: f64,
    /// Threads that islands were solved on.
    pub threads: u16,
}
