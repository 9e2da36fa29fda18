//! The scene: a curtain, the ground, a cannon twelve metres away, and a plan of shots.

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use drape_solver::ballistics;

/// Width and height of the curtain in metres.
pub const CURTAIN_SIZE: Vec2 = Vec2::new(4.0, 3.0);
/// Height of the curtain's lower edge above the ground in metres.
pub const CURTAIN_CLEARANCE: f32 = 0.3;
/// Drag of the curtain in 1/s: it hangs quietly again between two shots.
pub const CURTAIN_DRAG: f32 = 2.0;
/// Where the muzzle is: twelve metres in front of the curtain, which hangs in the plane z = 0.
pub const MUZZLE: Vec3 = Vec3::new(0.0, 1.0, 12.0);
/// Radius of a ball in metres.
pub const BALL_RADIUS: f32 = 0.15;
/// Mass of a ball in kilograms.
pub const BALL_MASS: f32 = 2.0;
/// Rolling resistance of a ball: the ground is a lawn, on which it comes to rest in some ten seconds.
pub const ROLLING_RESISTANCE: f32 = 0.1;
/// Time of the first shot in seconds.
pub const FIRST_SHOT: f64 = 1.0;
/// Time between shots in seconds.
pub const SHOT_INTERVAL: f64 = 3.0;
/// Length of a step in seconds.
pub const STEP: f64 = 1.0 / 60.0;

/// Points of the resting curtain that are aimed at, and the speeds of the shots, in metres and m/s. More shots
/// start over.
const PLAN: [(f32, f32, f32); 5] =
    [(0.0, 1.5, 15.0), (-1.0, 1.2, 18.0), (0.9, 1.8, 12.0), (0.3, 1.3, 25.0), (-0.5, 1.0, 21.0)];

/// What can be chosen about the scene.
#[derive(Resource, Clone, Debug, PartialEq)]
pub struct CannonScene {
    /// Particles of the curtain in a row and in a column.
    pub particles: UVec2,
    /// Substeps of the curtain in a step.
    pub substeps: u32,
    /// Relaxation iterations in a substep.
    pub iterations: u32,
    /// Number of shots; 0 leaves the cannon to the player.
    pub shots: u32,
}

impl Default for CannonScene {
    fn default() -> Self {
        Self { particles: UVec2::new(64, 48), substeps: 16, iterations: 2, shots: 5 }
    }
}

/// One shot of the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// When, in seconds of simulated time.
    pub time: f64,
    /// Angle above the horizon in radians.
    pub elevation: f32,
    /// Angle to the left in radians.
    pub azimuth: f32,
    /// Speed in m/s.
    pub speed: f32,
}

impl Shot {
    /// Shot number `index`, aimed by the ballistic formula at its point of the resting curtain.
    pub fn planned(index: u32) -> Self {
        let (x, y, speed) = PLAN[index as usize % PLAN.len()];
        let to_target = DVec3::new(f64::from(x), f64::from(y), 0.0) - MUZZLE.as_dvec3();
        let distance = (to_target.x * to_target.x + to_target.z * to_target.z).sqrt();
        let gravity = f64::from(-DrapeGravity::default().y);
        let elevation = ballistics::elevation_for(distance, to_target.y, f64::from(speed), gravity);
        Self {
            time: FIRST_SHOT + SHOT_INTERVAL * f64::from(index),
            // All points of the plan are in range; a level shot is the fallback for a plan that is not.
            elevation: elevation.unwrap_or(0.0) as f32,
            azimuth: libm::atan2(-to_target.x, -to_target.z) as f32,
            speed,
        }
    }

    /// Velocity at the muzzle in m/s.
    pub fn velocity(&self) -> DVec3 {
        ballistics::direction(f64::from(self.elevation), f64::from(self.azimuth)) * f64::from(self.speed)
    }

    /// Seconds from the shot to the touch of the resting curtain's plane, ball radius included.
    pub fn predicted_hit_time(&self) -> f64 {
        f64::from(MUZZLE.z - BALL_RADIUS) / -self.velocity().z
    }

    /// The ball's centre `time` seconds after the shot, by the closed form.
    pub fn position_at(&self, time: f64) -> DVec3 {
        let gravity = DrapeGravity::default().as_dvec3();
        ballistics::position_at(MUZZLE.as_dvec3(), self.velocity(), gravity, time)
    }
}

/// Marks the curtain.
#[derive(Component)]
pub struct Curtain;

/// Marks the ground.
#[derive(Component)]
pub struct Ground;

/// Builds the scene and fires the planned shots.
pub struct CannonScenePlugin(pub CannonScene);

impl Plugin for CannonScenePlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.0.clone())
            .insert_resource(Time::<Fixed>::from_seconds(STEP))
            .add_systems(Startup, spawn_scene)
            .add_systems(FixedUpdate, fire_planned_shots);
    }
}

/// The curtain as the scene has it.
pub fn curtain(scene: &CannonScene) -> impl Bundle {
    let middle = CURTAIN_CLEARANCE + CURTAIN_SIZE.y * 0.5;
    (
        Curtain,
        Cloth::new(CURTAIN_SIZE.x, CURTAIN_SIZE.y).with_particles(scene.particles.x, scene.particles.y),
        SolverSettings {
            substeps: scene.substeps,
            iterations: scene.iterations,
            drag: CURTAIN_DRAG,
            ..default()
        },
        Transform::from_xyz(0.0, middle, 0.0),
        Name::new("curtain"),
    )
}

fn spawn_scene(mut commands: Commands, scene: Res<CannonScene>) {
    commands.spawn(curtain(&scene));
    commands.spawn((Ground, Obstacle::ground(), Name::new("ground")));
    let ball = Projectile {
        radius: BALL_RADIUS,
        mass: BALL_MASS,
        rolling_resistance: ROLLING_RESISTANCE,
        ..default()
    };
    let first = Shot::planned(0);
    let cannon = Cannon {
        elevation: first.elevation,
        azimuth: first.azimuth,
        muzzle_speed: first.speed,
        ball,
        ..default()
    };
    commands.spawn((cannon, Transform::from_translation(MUZZLE), Name::new("cannon")));
}

/// Aims and fires at the start of the step in which a shot is due.
fn fire_planned_shots(
    scene: Res<CannonScene>,
    clock: Res<DrapeClock>,
    mut cannons: Query<(Entity, &mut Cannon)>,
    mut fire: MessageWriter<FireCannon>,
    mut fired: Local<u32>,
) {
    if *fired >= scene.shots {
        return;
    }
    let shot = Shot::planned(*fired);
    // Half a step of slack: the clock sums up rounded steps.
    if clock.elapsed() + 0.5 * STEP < shot.time {
        return;
    }
    *fired += 1;
    for (entity, mut cannon) in &mut cannons {
        cannon.elevation = shot.elevation;
        cannon.azimuth = shot.azimuth;
        cannon.muzzle_speed = shot.speed;
        fire.write(FireCannon { cannon: entity });
    }
}
