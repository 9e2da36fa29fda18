//! Prints what a bridge costs: a curtain among the colliders of an engine, in two apps side by side, with and without the bridge.
//!
//! Words of its command line choose scenes, and the numbers of static, kinematic and dynamic colliders: `avian_cost bridge`, `avian_cost 0+0+1000`.

use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::environment::Gusts;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeStep;

use crate::engine::*;

const WARM_UP: usize = 60;
const STEPS: usize = 300;

/// The system that begins to take the time of a step of cloth, which is to run after the engine's step.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct StartClock;

/// Prints the costs. `order` orders [`StartClock`].
pub fn print_all(order: fn(&mut App)) {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| word == name);
    let far = [
        (0, 0, 0),
        (1_000, 0, 0),
        (10_000, 0, 0),
        (0, 0, 100),
        (0, 0, 1_000),
        (0, 1_000, 0),
        (1_000, 0, 100),
    ];
    println!("microseconds, medians (least) of {STEPS} steps: the step of the cloth, and all of a frame");
    println!(
        "{:47} {:>39}  {:>28}",
        "colliders", "step: without, with, more by", "frame: without, with, more"
    );
    for (statics, kinematics, dynamics) in far {
        if is_wanted("far") || is_wanted(&format!("{statics}+{kinematics}+{dynamics}")) {
            print_costs(Scene { statics, kinematics, dynamics, is_around: false }, order);
        }
    }
    if is_wanted("bridge") {
        print_costs(Scene { statics: 1_000, kinematics: 0, dynamics: 100, is_around: true }, order);
    }
}

/// A curtain of 48 x 48 particles among boxes.
#[derive(Clone, Copy)]
struct Scene {
    statics: usize,
    kinematics: usize,
    dynamics: usize,
    /// True if the curtain hangs among them; else they are far away.
    is_around: bool,
}

fn print_costs(scene: Scene, order: fn(&mut App)) {
    let [without, with] = time_steps(scene, order);
    let Scene { statics, kinematics, dynamics, is_around } = scene;
    let place = if is_around { "around it" } else { "far away " };
    let [step, step_with] = [without.step, with.step].map(Span::of);
    let [frame, frame_with] = [without.frame, with.frame].map(Span::of);
    println!(
        "{statics:>6} static {kinematics:>5} kinematic {dynamics:>5} dynamic {place}  {step} {step_with} {:7.1} {:5.1} %  {frame} {frame_with} {:7.1}",
        step_with.median - step.median,
        (step_with.median / step.median - 1.0) * 100.0,
        frame_with.median - frame.median,
    );
}

/// Times without and with the bridge, of steps that the two apps take in turn.
fn time_steps(scene: Scene, order: fn(&mut App)) -> [Times; 2] {
    let mut apps = [false, true].map(|is_bridged| app(scene, is_bridged, order));
    for _ in 0..WARM_UP + STEPS {
        for app in &mut apps {
            let start = Instant::now();
            app.update();
            let took = start.elapsed();
            app.world_mut().resource_mut::<Times>().frame.push(took);
        }
    }
    apps.map(|mut app| std::mem::take(&mut *app.world_mut().resource_mut::<Times>()))
}

fn app(
    Scene { statics, kinematics, dynamics, is_around }: Scene,
    is_bridged: bool,
    order: fn(&mut App),
) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(15_625)))
        // Gusts keep the curtain awake.
        .insert_resource(Wind { gusts: Gusts { speed: 1.0, ..default() }, ..Wind::new(Vec3::Z) })
        .init_resource::<Times>();
    add_engine(&mut app);
    if is_bridged {
        add_bridge(&mut app);
    }
    order(&mut app);
    let start = |mut times: ResMut<Times>| times.start = Some(Instant::now());
    let stop = |mut times: ResMut<Times>| {
        let took = times.start.map(|start| start.elapsed());
        times.step.extend(took);
    };
    app.add_systems(FixedPostUpdate, (start.in_set(StartClock).before(DrapeStep), stop.after(DrapeStep)));
    let world = app.world_mut();
    world.spawn((Cloth::new(2.0, 2.0).with_particles(48, 48), Transform::from_xyz(0.0, 2.0, 0.0)));
    let cube = || cuboid(Vec3::ONE);
    for place in places(statics, is_around) {
        world.spawn((STATIC, cube(), Transform::from_translation(place + Vec3::Y * 0.5)));
    }
    for (body, count) in [(KINEMATIC, kinematics), (DYNAMIC, dynamics)] {
        for place in places(count, is_around) {
            // Adrift: nothing sleeps.
            let adrift = (GravityScale(0.0), moving(Vec3::Y, Vec3::ZERO), sleepless());
            let up = Transform::from_translation(place + Vec3::Y * 2.0);
            world.spawn((body, cube(), up, adrift));
        }
    }
    app.finish();
    app.cleanup();
    app
}

/// The places of boxes: a square field around the curtain, with a gap for it, or beside it.
fn places(count: usize, is_around: bool) -> impl Iterator<Item = Vec3> {
    let side = (count as f32).sqrt().ceil();
    let middle = if is_around { Vec3::ZERO } else { Vec3::X * (side + 20.0) };
    let corner = middle - Vec3::new(side, 0.0, side);
    (0..count)
        .map(move |i| corner + 2.0 * Vec3::new(i as f32 % side, 0.0, (i as f32 / side).floor()))
        .filter(|place| place.length() > 2.5)
}

#[derive(Resource, Default)]
struct Times {
    start: Option<Instant>,
    step: Vec<Duration>,
    frame: Vec<Duration>,
}

/// Median and least of some times, in microseconds.
#[derive(Clone, Copy)]
struct Span {
    median: f64,
    least: f64,
}

impl Span {
    fn of(mut times: Vec<Duration>) -> Self {
        times.drain(..WARM_UP);
        times.sort_unstable();
        let [median, least] = [times[times.len() / 2], times[0]].map(|time| time.as_secs_f64() * 1e6);
        Self { median, least }
    }
}

impl std::fmt::Display for Span {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{:7.1} ({:6.1})", self.median, self.least)
    }
}
