//! The scene: a curtain, the ground, a cannon twelve metres away, and a plan of shots, as
//! `assets/scenes/cannon.scene.ron` has them.

use std::sync::LazyLock;

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape_script::play::{ScenePlay, ScenePlugin, begin_scene};
use bevy_drape_script::scene::{Action, Body, Event, Positive, Repeat, SceneScript, Seconds, Whole};
use bevy_drape_script::{Override, SceneError};
use drape_solver::motion::ballistics;

/// Length of a step in seconds.
pub const STEP: f64 = 1.0 / 60.0;

/// The file as it is.
static FILE: LazyLock<SceneScript> = LazyLock::new(|| {
    SceneScript::parse(include_str!("../../assets/scenes/cannon.scene.ron"))
        .expect("a test reads the file that comes with the demo")
});

/// Names in the file.
const CURTAIN: &str = "curtain";
const GROUND: &str = "ground";
const CANNON: &str = "cannon";

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

impl CannonScene {
    /// The file with what was chosen, without its expectations and its end.
    ///
    /// # Errors
    /// [`SceneError`] if something chosen is out of range.
    pub fn script(&self) -> Result<SceneScript, SceneError> {
        let [columns, rows] = self.particles.to_array();
        let mut script = FILE.clone().with(&[
            Override::new("particles", vec![columns, rows]),
            Override::new("substeps", self.substeps),
            Override::new("iterations", self.iterations),
        ])?;
        script.expectations.clear();
        script.settings.duration = Seconds::new(Seconds::GREATEST).unwrap_or(script.settings.duration);
        let plan = plan();
        let round = plan.len() as u32;
        script.timeline.retain_mut(|event| {
            let Some(time) = event.at else { return false };
            let shot = plan.iter().position(|shot| shot.time == time.get()).unwrap_or(0) as u32;
            // The plan is fired again and again.
            let times = (self.shots + round - 1 - shot) / round;
            event.repeat = repeat(shot_interval() * f64::from(round), times);
            times > 0
        });
        Ok(script)
    }

    /// The curtain as it is spawned.
    pub fn curtain(&self) -> impl Bundle {
        let file = file_curtain();
        let settings = SolverSettings {
            substeps: self.substeps,
            iterations: self.iterations,
            ..file.solver.over(SolverSettings::default())
        };
        let cloth = Cloth { particles: self.particles, ..Cloth::from(file) };
        (Curtain, cloth, settings, Transform::from_translation(file.at.get()), Name::new(CURTAIN))
    }
}

fn repeat(every: f64, times: u32) -> Option<Repeat> {
    (times > 1)
        .then(|| Some(Repeat { every: Positive::new(every as f32).ok()?, times: Whole::new(times).ok()? }))?
}

fn file_curtain() -> &'static bevy_drape_script::scene::Cloth {
    match FILE.bodies.get(CURTAIN) {
        Some(Body::Cloth(cloth)) => cloth,
        _ => panic!("the demo's scene has a cloth called {CURTAIN}"),
    }
}

fn file_cannon() -> &'static bevy_drape_script::scene::Cannon {
    FILE.cannons.get(CANNON).expect("the demo's scene has a cannon")
}

/// Width and height of the curtain in metres.
pub fn curtain_size() -> Vec2 {
    Cloth::from(file_curtain()).size
}

/// Height of the curtain's lower edge above the ground in metres.
pub fn curtain_clearance() -> f32 {
    file_curtain().at.y - 0.5 * curtain_size().y
}

/// Drag of the curtain in 1/s: it hangs quietly again between two shots.
pub fn curtain_drag() -> f32 {
    file_curtain().solver.over(SolverSettings::default()).drag
}

/// Where the muzzle is, in front of the curtain, which hangs in the plane z = 0.
pub fn muzzle() -> Vec3 {
    file_cannon().at.get()
}

/// What is shot. The ground is a lawn, on which it comes to rest in some ten seconds.
pub fn ball() -> Projectile {
    (&file_cannon().ball).into()
}

/// Time of the first shot in seconds.
pub fn first_shot() -> f64 {
    plan()[0].time
}

/// Time between shots in seconds.
pub fn shot_interval() -> f64 {
    plan()[1].time - plan()[0].time
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

/// The shots that the file's timeline aims.
fn plan() -> &'static [Shot] {
    static PLAN: LazyLock<Vec<Shot>> = LazyLock::new(|| FILE.timeline.iter().filter_map(aimed).collect());
    &PLAN
}

fn aimed(event: &Event) -> Option<Shot> {
    let Action::Aim { aim, speed, .. } = &event.action else { return None };
    let mut cannon = file_cannon().clone();
    cannon.aim = aim.clone();
    cannon.speed = speed.unwrap_or(cannon.speed);
    let Cannon { elevation, azimuth, muzzle_speed: speed, .. } = cannon.component(FILE.settings.gravity);
    Some(Shot { time: event.at?.get(), elevation, azimuth, speed })
}

impl Shot {
    /// Shot number `index`; after the last of the plan it starts over.
    pub fn planned(index: u32) -> Self {
        let shot = plan()[index as usize % plan().len()];
        Self { time: first_shot() + shot_interval() * f64::from(index), ..shot }
    }

    /// Velocity at the muzzle in m/s.
    pub fn velocity(&self) -> DVec3 {
        ballistics::direction(f64::from(self.elevation), f64::from(self.azimuth)) * f64::from(self.speed)
    }

    /// Seconds from the shot to the touch of the resting curtain's plane, ball radius included.
    pub fn predicted_hit_time(&self) -> f64 {
        f64::from(muzzle().z - ball().radius) / -self.velocity().z
    }

    /// The ball's centre `time` seconds after the shot, by the closed form.
    pub fn position_at(&self, time: f64) -> DVec3 {
        let gravity = DrapeGravity::default().as_dvec3();
        ballistics::position_at(muzzle().as_dvec3(), self.velocity(), gravity, time)
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
        app.add_plugins(ScenePlugin)
            .insert_resource(self.0.clone())
            .insert_resource(Time::<Fixed>::from_seconds(STEP))
            .add_systems(Startup, begin);
    }
}

/// Begins the scene, in place of the one that is there: a new curtain, a new plan, no balls.
pub fn begin(world: &mut World) {
    match world.resource::<CannonScene>().script() {
        Ok(script) => {
            begin_scene(world, script);
            mark(world, CURTAIN, Curtain);
            mark(world, GROUND, Ground);
        }
        Err(error) => error!("{error}"),
    }
}

fn mark(world: &mut World, name: &str, mark: impl Component) {
    if let Some(&entity) = world.resource::<ScenePlay>().entities(name).first() {
        world.entity_mut(entity).insert(mark);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_what_the_demo_needs() {
        assert!((FILE.settings.dt.get() - STEP).abs() < 1e-12);
        assert_eq!(plan().len(), 5);
        assert!(FILE.obstacles.get(GROUND).is_some());
        assert!(curtain_clearance() > 0.0 && ball().mass > 0.0);
        for particles in [UVec2::splat(2), UVec2::splat(4096)] {
            let scene = CannonScene { particles, substeps: 256, iterations: 1024, shots: 0 };
            scene.script().expect("in range");
        }
    }

    #[test]
    fn as_many_shots_as_are_asked_for() {
        for shots in [0, 1, 4, 5, 6, 12, 100] {
            let script = CannonScene { shots, ..CannonScene::default() }.script().expect("in range");
            let fired = script.timeline.iter().filter(|event| matches!(event.action, Action::Fire(_)));
            let times = fired.map(|event| event.repeat.map_or(1, |repeat| repeat.times.get()));
            assert_eq!(times.sum::<u32>(), shots);
        }
    }
}
