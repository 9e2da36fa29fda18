//! Ten thousand flags in a gusty wind (a thousand without a graphics card), solved on the GPU and drawn from there, and a wave that goes round
//! the stands.
//!
//! `cargo run --release --example stadium --features window`; `--picture FILE` draws a picture with `--features render`. The slider, or the keys
//! 1 to 9 and 0, choose the number of flags.

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;
use bevy_drape::environment::Gusts;
use bevy_drape::gpu::SolveOnGpu;
use bevy_drape::prelude::*;
use drape_examples::feature::Feature;
use wgpu::DeviceType;

/// The example.
pub const FEATURE: Feature = Feature {
    title: "Ten thousand flags on the GPU",
    controls: "1 to 9, 0: from one thousand flags to ten",
    eye: Vec3::new(-31.0, 4.6, 7.0),
    target: Vec3::new(-18.0, 3.4, -24.0),
    picture_time: 1.2,
    build: |app| {
        app.insert_resource(FlagCount(1_000))
            .add_systems(Startup, (setup, fill))
            .add_systems(Update, (count_flags, choose));
        #[cfg(feature = "window")]
        app.add_plugins(slider::FlagSliderPlugin);
        app.add_systems(FixedUpdate, wave);
    },
};

/// Runs it.
pub fn main() -> std::process::ExitCode {
    FEATURE.run()
}

/// Flags at most.
const MOST: usize = 10_000;
/// Flags that are raised in a frame at most.
const AT_ONCE: usize = 2_500;
/// Rows of seats.
const ROWS: usize = 40;
/// Height of a pole in metres.
const POLE: f32 = 1.7;
/// Height of a flag's middle above the foot of its pole.
const MIDDLE: f32 = POLE - 0.36;
/// The wave in radians a second.
const WAVE: f32 = 0.5;

/// The number of flags that there should be.
#[derive(Resource)]
struct FlagCount(usize);

/// A flag, and where it hangs while the wave is elsewhere.
#[derive(Component)]
struct Flag {
    number: usize,
    /// Its place round the field in radians.
    angle: f32,
    /// Height of its middle in metres.
    height: f32,
}

/// The looks that all flags share.
#[derive(Resource)]
struct Looks {
    pole: Mesh3d,
    wood: MeshMaterial3d<StandardMaterial>,
    fabrics: [MeshMaterial3d<StandardMaterial>; 4],
}

/// Raises all flags where there is a graphics card: in software each takes milliseconds.
fn fill(mut count: ResMut<FlagCount>, adapter: Option<Res<RenderAdapterInfo>>) {
    if adapter.is_some_and(|adapter| adapter.device_type != DeviceType::Cpu) {
        count.0 = MOST;
    }
}

fn setup(
    mut commands: Commands,
    mut wind: ResMut<Wind>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    *wind = Wind {
        lift_coefficient: 1.0,
        gusts: Gusts { speed: 2.5, ..default() },
        ..Wind::new(Vec3::new(6.0, 0.0, 1.5))
    };
    commands.spawn(Obstacle::ground());
    let mut fabric = |colour: Color| {
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: colour,
            perceptual_roughness: 0.8,
            reflectance: 0.25,
            double_sided: true,
            cull_mode: None,
            ..default()
        }))
    };
    let fabrics = [
        fabric(Color::srgb(0.75, 0.15, 0.15)),
        fabric(Color::srgb(0.93, 0.78, 0.25)),
        fabric(Color::srgb(0.15, 0.30, 0.60)),
        fabric(Color::srgb(0.85, 0.85, 0.82)),
    ];
    let wood = MeshMaterial3d(materials.add(Color::srgb(0.35, 0.27, 0.2)));
    let concrete = MeshMaterial3d(materials.add(Color::srgb(0.5, 0.5, 0.52)));
    let grass = MeshMaterial3d(materials.add(Color::srgb(0.22, 0.42, 0.18)));
    for row in 0..ROWS {
        let (inner, height) = (radii(row) - 0.7, floor(row));
        let step = Annulus::new(inner.x, inner.x + 1.4);
        let ring = Extrusion::new(step, height.max(0.1));
        let oval = Vec3::new(1.0, inner.y / inner.x, 1.0);
        let level = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
        let place = Transform::from_xyz(0.0, 0.5 * height, 0.0).with_rotation(level).with_scale(oval);
        commands.spawn((Mesh3d(meshes.add(ring)), concrete.clone(), place));
    }
    let field = Plane3d::default().mesh().size(52.0, 34.0);
    commands.spawn((Mesh3d(meshes.add(field)), grass, Transform::from_xyz(0.0, 0.02, 0.0)));
    let pole = Mesh3d(meshes.add(Cylinder::new(0.02, POLE).mesh().resolution(6)));
    commands.insert_resource(Looks { pole, wood, fabrics });
}

/// Half axes of the oval of a row.
fn radii(row: usize) -> Vec2 {
    Vec2::new(36.0, 26.0) + 1.4 * row as f32
}

/// Height of a row's floor.
fn floor(row: usize) -> f32 {
    0.8 + 0.55 * row as f32
}

/// Angle and row of a flag. The lowest row is filled first, evenly at any number.
fn seat(number: usize) -> (f32, usize) {
    let (mut place, mut row) = (number, 0);
    while row + 1 < ROWS && place >= seats(row) {
        place -= seats(row);
        row += 1;
    }
    // Steps of the golden ratio fill a circle evenly.
    let turn = place as f32 * 0.618_034 + row as f32 * 0.37;
    (turn.fract() * core::f32::consts::TAU, row)
}

/// Flags in a row: one and a half metres apart, ten thousand in all.
fn seats(row: usize) -> usize {
    (4.288 * 0.5 * (radii(row).x + radii(row).y)) as usize
}

/// Raises and takes down flags.
fn count_flags(
    mut commands: Commands,
    flags: Query<(Entity, &Flag)>,
    count: Res<FlagCount>,
    looks: Res<Looks>,
) {
    let there = flags.iter().len();
    for number in there..count.0.min(there + AT_ONCE) {
        let flag = Cloth::new(1.0, 0.7).with_particles(12, 8).with_pins(ClothPins::Left);
        let fabric = looks.fabrics[number * 7 / 3 % looks.fabrics.len()].clone();
        let (angle, row) = seat(number);
        let foot = radii(row) * Vec2::from_angle(angle);
        let height = floor(row) + MIDDLE;
        let place = Transform::from_xyz(foot.x + 0.5, height, foot.y);
        let pole = Transform::from_xyz(-0.5, 0.5 * POLE - MIDDLE, 0.0);
        commands.spawn((Flag { number, angle, height }, flag, SolveOnGpu, fabric, place)).with_child((
            looks.pole.clone(),
            looks.wood.clone(),
            pole,
        ));
    }
    for (entity, flag) in &flags {
        if flag.number >= count.0 {
            commands.entity(entity).despawn();
        }
    }
}

/// Lifts the flags where the wave is.
fn wave(mut flags: Query<(&Flag, &mut Transform)>, time: Res<Time>) {
    let crest = WAVE * time.elapsed_secs();
    for (flag, mut transform) in &mut flags {
        let behind = (flag.angle - crest).rem_euclid(core::f32::consts::TAU);
        // A tenth of the way round.
        let lift =
            if behind < 0.6 { (behind / 0.6 * core::f32::consts::PI).sin().powi(2) * 0.9 } else { 0.0 };
        let height = flag.height + lift;
        if transform.translation.y != height {
            transform.translation.y = height;
        }
    }
}

/// Chooses the number of flags by a key.
fn choose(keys: Res<ButtonInput<KeyCode>>, mut count: ResMut<FlagCount>) {
    use KeyCode::*;
    let digits = [Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8, Digit9, Digit0];
    if let Some(thousands) = digits.iter().position(|&digit| keys.just_pressed(digit)) {
        count.0 = (thousands + 1) * 1_000;
    }
}

#[cfg(feature = "window")]
mod slider {
    use bevy::prelude::*;
    use drape_examples::view::slider::{Slider, SliderPlugin};

    use super::{FlagCount, MOST};

    /// A slider for the number of flags.
    pub(super) struct FlagSliderPlugin;

    impl Plugin for FlagSliderPlugin {
        fn build(&self, app: &mut App) {
            app.add_plugins(SliderPlugin).add_systems(Startup, spawn).add_systems(Update, follow);
        }
    }

    fn spawn(mut commands: Commands) {
        let place = Node { position_type: PositionType::Absolute, bottom: px(20), left: px(20), ..default() };
        let size = Node { width: px(300), height: px(18), ..place };
        commands.spawn((Slider::new(0.0, MOST as f32), size));
    }

    /// Takes the number from the slider while it is held, and shows it there else.
    fn follow(mut sliders: Query<&mut Slider>, mut count: ResMut<FlagCount>) {
        for mut slider in &mut sliders {
            if slider.is_held {
                count.0 = slider.value as usize;
            } else if slider.value != count.0 as f32 {
                slider.value = count.0 as f32;
            }
        }
    }
}
