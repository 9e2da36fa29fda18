//! Prints what the bridge costs: the step of a curtain among colliders that are far away, and without them.
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml --example cost` (with `--ignore-rust-version` on an old Rust)

use std::time::{Duration, Instant};

use avian3d::prelude::*;
use avian3d::schedule::PhysicsSystems;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_drape::prelude::*;
use bevy_drape::schedule::DrapeStep;
use bevy_drape_avian::AvianDrapePlugin;

const STEPS: usize = 300;

fn main() {
    println!("microseconds in DrapeStep, median (least) of {STEPS} steps");
    for (statics, dynamics) in [(0, 0), (1_000, 0), (10_000, 0), (0, 100), (0, 1_000), (1_000, 100)] {
        let (median, least) = time_steps(statics, dynamics);
        println!("{statics:>6} static, {dynamics:>4} dynamic colliders: {median:7.1} ({least:.1})");
    }
}

/// Times of the step of a curtain of 48 x 48 particles, in microseconds.
fn time_steps(statics: usize, dynamics: usize) -> (f64, f64) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, PhysicsPlugins::default()))
        .add_plugins((DrapePlugins::default(), AvianDrapePlugin::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_micros(15_625)))
        .insert_resource(Wind::new(Vec3::X * 3.0))
        .init_resource::<Times>();
    // Between Avian's step and the end of ours.
    let start = |mut times: ResMut<Times>| times.start = Some(Instant::now());
    let stop = |mut times: ResMut<Times>| {
        let took = times.start.map(|start| start.elapsed().as_secs_f64() * 1e6);
        times.all.extend(took);
    };
    app.add_systems(
        FixedPostUpdate,
        (start.after(PhysicsSystems::Last).before(DrapeStep), stop.after(DrapeStep)),
    );
    let world = app.world_mut();
    world.spawn((Cloth::new(2.0, 2.0).with_particles(48, 48), Transform::from_xyz(0.0, 2.0, 0.0)));
    let place = |i: usize| Transform::from_xyz(20.0 + (i % 100) as f32 * 2.0, 0.5, (i / 100) as f32 * 2.0);
    for i in 0..statics {
        world.spawn((RigidBody::Static, Collider::cuboid(1.0, 1.0, 1.0), place(i)));
    }
    for i in 0..dynamics {
        // Adrift: nothing sleeps.
        let velocity = (GravityScale(0.0), LinearVelocity(Vec3::Y), SleepingDisabled);
        let up = Transform::from_translation(place(i).translation + Vec3::Y * 9.0);
        world.spawn((RigidBody::Dynamic, Collider::cuboid(1.0, 1.0, 1.0), up, velocity));
    }
    app.finish();
    app.cleanup();
    for _ in 0..STEPS + 60 {
        app.update();
    }
    let mut all = app.world_mut().remove_resource::<Times>().map_or_else(Vec::new, |times| times.all);
    all.drain(..60);
    all.sort_by(f64::total_cmp);
    (all[all.len() / 2], all[0])
}

#[derive(Resource, Default)]
struct Times {
    start: Option<Instant>,
    all: Vec<f64>,
}
