//! Cloth that is cut: a blade slashes a curtain, and what is cut off falls.
//!
//! `cargo run --release --example cut --features window`; `--headless` runs without a window, and `--picture FILE` draws
//! a picture with `--features render`.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::tear::CutCloth;
use drape_examples::feature::{Feature, Paint};

/// The example.
pub const FEATURE: Feature = Feature {
    title: "A blade goes through a curtain",
    controls: "space  slash",
    eye: Vec3::new(1.2, 1.3, 2.9),
    target: Vec3::new(0.0, 1.02, 0.0),
    picture_time: 0.9,
    build: |app| {
        app.add_systems(FixedUpdate, slash).add_systems(Startup, setup);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// When the first and the second slash come, in seconds.
const SLASHES: [f32; 2] = [0.4, 0.7];

fn setup(mut commands: Commands) {
    commands.spawn(Obstacle::ground());
    let curtain = Cloth::new(1.8, 1.5).with_particles(60, 50);
    // The part that falls lies in folds.
    let settings = SolverSettings { self_contact: SelfContact::On, ..default() };
    commands.spawn((curtain, settings, Paint::rgb(0.24, 0.42, 0.34), Transform::from_xyz(0.0, 1.25, 0.0)));
}

/// Slashes from the left, then from the right, and the space bar once more.
fn slash(
    clock: Res<Time<Fixed>>,
    keys: Res<ButtonInput<KeyCode>>,
    mut slashes: Local<usize>,
    mut cuts: MessageWriter<CutCloth>,
) {
    let is_due = SLASHES.get(*slashes).is_some_and(|&time| clock.elapsed_secs() >= time);
    if is_due || keys.just_pressed(KeyCode::Space) {
        let side = if (*slashes).is_multiple_of(2) { 1.0 } else { -1.0 };
        let blade = |x: f32, y: f32| [Vec3::new(side * x, y, -1.0), Vec3::new(side * x, y, 1.0)];
        cuts.write(CutCloth::sweep(blade(-1.1, 1.2), blade(0.5, 0.7)));
        *slashes += 1;
    }
}
