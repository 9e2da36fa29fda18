//! Prints what the bridge costs: a curtain among Avian's colliders, in two apps side by side, with and without the bridge.
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml --example cost` (with `--ignore-rust-version` on an old Rust)
//!
//! Words of its command line choose scenes, and the numbers of colliders: `cost bridge`, `cost 0+1000`.

use std::time::{Duration, Instant};

use avian3d::prelude::*;
use avian3d::schedule::PhysicsSystems;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::environment::Gusts;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeStep;
use bevy_drape_avian::AvianDrapePlugin;

const WARM_UP: usize = 60;
const STEPS: usize = 300;

fn main() {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| word == name);
    let far = [(0, 0), (1_000, 0), (10_000, 0), (0, 100), (0, 1_000), (1_000, 100)];
    println!("microseconds, medians (least) of {STEPS} steps: the step of the cloth, and all of a frame");
    println!(
        "{:32} {:>39}  {:>28}",
        "colliders", "step: without, with, more by", "frame: without, with, more"
    );
    for (statics, dynamics) in far {
        if is_wanted("far") || is_wanted(&format!("{statics}+{dynamics}")) {
            print_costs(Scene { statics, dynamics, is_around: false });
        }
    }
    if is_wanted("bridge") {
        print_costs(Scene { statics: 1_000, dynamics: 100, is_around: true });
    }
}

/// A curtain of 48 x 48 particles among boxes.
#[derive(Clone, Copy)]
struct Scene {
    statics: usize,
    dynamics: usize,
    /// True if the curtain hangs among them; else they are far away.
    is_around: bool,
}

fn print_costs(scene: Scene) {
    let [without, with] = time_steps(scene);
    let Scene { statics, dynamics, is_around } = scene;
    let place = if is_around { "around it" } else { "far away " };
    let [step, step_with] = [without.step, with.step].map(Span::of);
    let [frame, frame_with] = [without.frame, with.frame].map(Span::of);
    println!(
        "{statics:>6} static {dynamics:>5} dynamic {place}  {step} {step_with} {:7.1} {:5.1} %  {frame} {frame_with} {:7.1}",
        step_with.median - step.median,
        (step_with.median / step.median - 1.0) * 100.0,
        frame_with.median - frame.median,
    );
}

/// Times without and with the bridge, of steps that the two apps take in turn.
fn time_steps(scene: Scene) -> [Times; 2] {
    let mut apps = [false, true].map(|is_bridged| app(scene, is_bridged));
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

fn app(Scene { statics, dynamics, is_around }: Scene, is_bridged: bool) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, PhysicsPlugins::default()))
        .add_plugins(DrapePlugins::default())
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(15_625)))
        // Gusts keep the curtain awake.
        .insert_resource(Wind { gusts: Gusts { speed: 1.0, ..default() }, ..Wind::new(Vec3::Z) })
        .init_resource::<Times>();
    if is_bridged {
        app.add_plugins(AvianDrapePlugin::default());
    }
    // Between Avian's step and the end of ours.
    let start = |mut times: ResMut<Times>| times.start = Some(Instant::now());
    let stop = |mut times: ResMut<Times>| {
        let took = times.start.map(|start| start.elapsed());
        times.step.extend(took);
    };
    app.add_systems(
        FixedPostUpdate,
        (start.after(PhysicsSystems::Last).before(DrapeStep), stop.after(DrapeStep)),
    );
    let world = app.world_mut();
    world.spawn((Cloth::new(2.0, 2.0).with_particles(48, 48), Transform::from_xyz(0.0, 2.0, 0.0)));
    let cube = || Collider::cuboid(1.0, 1.0, 1.0);
    for place in places(statics, is_around) {
        world.spawn((RigidBody::Static, cube(), Transform::from_translation(place + Vec3::Y * 0.5)));
    }
    for place in places(dynamics, is_around) {
        // Adrift: nothing sleeps.
        let adrift = (GravityScale(0.0), LinearVelocity(Vec3::Y), SleepingDisabled);
        let up = Transform::from_translation(place + Vec3::Y * 2.0);
        world.spawn((RigidBody::Dynamic, cube(), up, adrift));
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
