//! Cloth that is dragged: by a hand that pulls as hard as it takes, by one of little force, and by your own pointer.
//!
//! `cargo run --release --example drag --features window`; `--headless` runs without a window, with `--features meshes` at
//! least, and `--picture FILE` draws a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::gestures::Gestures;
use bevy_drape::prelude::*;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A strong hand and a weak one lift a curtain",
    controls: "",
    eye: Vec3::new(2.4, 1.35, 2.45),
    target: Vec3::new(0.0, 1.15, 0.2),
    picture_time: 2.2,
    build: |app| {
        app.add_systems(Startup, setup).add_systems(FixedUpdate, pull);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// The hands rest this long, then hold this long, in seconds.
const REST: f32 = 0.5;
const HOLD: f32 = 3.0;
/// The way from where they take hold to where they let go, in metres.
const LIFT: Vec3 = Vec3::new(0.0, 0.35, 0.7);

/// A hand of this example. Pointers have hands of their own beside it, as the curtains are [`Draggable`].
#[derive(Component)]
struct Puller {
    curtain: Entity,
    /// The point at which it takes hold.
    home: Vec3,
    /// In newtons.
    greatest_force: f32,
    is_holding: bool,
}

impl Puller {
    /// Tells it from other hands on the same curtain.
    const ID: u64 = 1;
}

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let strong = (-0.75, f32::INFINITY, Paint::rgb(0.66, 0.25, 0.20));
    let weak = (0.75, 0.8, Paint::rgb(0.22, 0.38, 0.56));
    for (x, greatest_force, paint) in [strong, weak] {
        let curtain = Cloth::new(1.2, 1.3).with_particles(40, 44);
        let draggable = Draggable { radius: 0.2, greatest_force: 20.0 };
        let curtain = commands.spawn((curtain, draggable, paint, Transform::from_xyz(x, 1.35, 0.0))).id();
        let home = Vec3::new(x, 0.95, 0.0);
        let puller = Puller { curtain, home, greatest_force, is_holding: false };
        // Only to look at: it touches nothing.
        let ball = (Obstacle::sphere(0.045), DrapeLayers::new(0, 0), Paint::rgb(0.92, 0.80, 0.66));
        commands.spawn((puller, ball, Transform::from_translation(home)));
    }
}

/// Takes hold, lifts, lets go, and again.
fn pull(time: Res<Time>, mut hands: Query<(&mut Puller, &mut Transform)>, mut commands: Commands) {
    let since = time.elapsed_secs() % (REST + HOLD) - REST;
    for (mut hand, mut transform) in &mut hands {
        let Puller { curtain, home, greatest_force, is_holding } = *hand;
        let holds = since >= 0.0;
        if holds && !is_holding {
            commands.grab(curtain, Puller::ID, home, 0.15);
        } else if is_holding && !holds {
            commands.release(curtain, Puller::ID);
        }
        transform.translation = home + LIFT * since.clamp(0.0, 1.0);
        // Nothing happens while it does not hold.
        commands.pull(curtain, Puller::ID, transform.translation, greatest_force);
        hand.is_holding = holds;
    }
}
