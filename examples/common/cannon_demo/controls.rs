//! The keys of the window: aim, fire, wind, reset, pause, views.

use bevy::prelude::*;
use bevy_drape::cannon::{Cannon, FireCannon};
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;

use crate::cannon_demo::plugin::begin;
use crate::cannon_demo::scene::Curtain;
use crate::view::clock_keys::control_clock;
use crate::view::window::quit;

/// Speed at which the barrel turns, in rad/s.
const TURN_RATE: f32 = 0.35;
/// Rate at which the muzzle speed changes, in m/s^2.
const SPEED_RATE: f32 = 12.0;
/// Least and greatest elevation in radians.
const ELEVATION: (f32, f32) = (-0.03, 0.9);
/// Greatest azimuth to either side in radians.
const AZIMUTH: f32 = 0.6;
/// Least and greatest muzzle speed in m/s.
const SPEED: (f32, f32) = (5.0, 40.0);
/// Mean velocity of the wind in m/s.
const WIND: Vec3 = Vec3::new(0.5, 0.0, -1.8);

/// Strain at which a stick is drawn red. Sticks reach it for a moment after a hit.
const FULL_STRAIN: f32 = 0.01;

/// The view of the cloth.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ClothView {
    /// The cloth.
    #[default]
    Cloth,
    /// The cloth, and its sticks coloured by strain.
    Strain,
    /// The sticks alone.
    Wireframe,
}

/// True while the wind blows.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blowing(pub bool);

/// Reads the keys.
pub struct ControlsPlugin;

impl Plugin for ControlsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ClothView>()
            .init_resource::<Blowing>()
            .add_systems(Update, (aim, fire, reset, control_clock, toggle_wind, choose_view, quit))
            .add_systems(Update, (show_view.after(choose_view), preview_path))
            .add_systems(FixedUpdate, blow);
    }
}

/// -1, 0 or 1, for keys of opposite directions.
fn axis(keys: &ButtonInput<KeyCode>, less: &[KeyCode], more: &[KeyCode]) -> f32 {
    let pressed = |codes: &[KeyCode]| f32::from(u8::from(keys.any_pressed(codes.iter().copied())));
    pressed(more) - pressed(less)
}

fn aim(mut cannons: Query<&mut Cannon>, keys: Res<ButtonInput<KeyCode>>, time: Res<Time<Real>>) {
    use KeyCode::{
        ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Equal, KeyA, KeyD, KeyS, KeyW, Minus, NumpadAdd,
        NumpadSubtract,
    };
    let rise = axis(&keys, &[ArrowDown, KeyS], &[ArrowUp, KeyW]);
    let turn = axis(&keys, &[ArrowRight, KeyD], &[ArrowLeft, KeyA]);
    let speed = axis(&keys, &[Minus, NumpadSubtract], &[Equal, NumpadAdd]);
    if (rise, turn, speed) == (0.0, 0.0, 0.0) {
        return;
    }
    // A slow frame must not turn the barrel far.
    let seconds = time.delta_secs().min(0.1);
    for mut cannon in &mut cannons {
        let elevation = cannon.elevation + rise * TURN_RATE * seconds;
        cannon.elevation = elevation.clamp(ELEVATION.0, ELEVATION.1);
        cannon.azimuth = (cannon.azimuth + turn * TURN_RATE * seconds).clamp(-AZIMUTH, AZIMUTH);
        cannon.muzzle_speed = (cannon.muzzle_speed + speed * SPEED_RATE * seconds).clamp(SPEED.0, SPEED.1);
    }
}

fn fire(
    keys: Res<ButtonInput<KeyCode>>,
    cannons: Query<Entity, With<Cannon>>,
    mut fire: MessageWriter<FireCannon>,
) {
    if keys.just_pressed(KeyCode::Space) {
        fire.write_batch(cannons.iter().map(|cannon| FireCannon { cannon }));
    }
}

/// Takes all balls away and hangs a new curtain.
fn reset(mut commands: Commands, keys: Res<ButtonInput<KeyCode>>) {
    if keys.just_pressed(KeyCode::KeyR) {
        commands.queue(begin);
    }
}

fn toggle_wind(keys: Res<ButtonInput<KeyCode>>, mut blowing: ResMut<Blowing>, mut wind: ResMut<Wind>) {
    if keys.just_pressed(KeyCode::KeyV) {
        blowing.0 = !blowing.0;
        wind.velocity = if blowing.0 { WIND } else { Vec3::ZERO };
    }
}

/// Gusts.
fn blow(blowing: Res<Blowing>, clock: Res<DrapeClock>, mut wind: ResMut<Wind>) {
    if blowing.0 {
        let time = clock.elapsed();
        let gust = 1.0 + 0.45 * (1.3 * time).sin() + 0.25 * (3.7 * time).sin();
        wind.velocity = WIND * gust as f32;
    }
}

fn choose_view(keys: Res<ButtonInput<KeyCode>>, mut view: ResMut<ClothView>) {
    if keys.just_pressed(KeyCode::KeyG) {
        *view = match *view {
            ClothView::Cloth => ClothView::Strain,
            ClothView::Strain => ClothView::Wireframe,
            ClothView::Wireframe => ClothView::Cloth,
        };
    }
}

fn show_view(
    view: Res<ClothView>,
    mut store: ResMut<GizmoConfigStore>,
    mut curtains: Query<&mut Visibility, With<Curtain>>,
) {
    let (config, drape) = store.config_mut::<DrapeGizmos>();
    config.enabled = *view != ClothView::Cloth;
    config.line.width = 1.0;
    drape.full_strain = FULL_STRAIN;
    let visibility = if *view == ClothView::Wireframe { Visibility::Hidden } else { Visibility::Inherited };
    for mut curtain in &mut curtains {
        curtain.set_if_neq(visibility);
    }
}

/// Draws the path of a shot, up to the ground.
fn preview_path(mut gizmos: Gizmos, cannons: Query<(&Cannon, &GlobalTransform)>, gravity: Res<DrapeGravity>) {
    for (cannon, transform) in &cannons {
        let start = cannon.muzzle(transform);
        let velocity = transform.rotation() * cannon.direction() * cannon.muzzle_speed;
        let at = |time: f32| start + velocity * time + gravity.0 * (0.5 * time * time);
        // Dashes of 40 ms.
        for dash in 0..60 {
            let [from, to] = [0.01, 0.03].map(|offset| at(0.04 * dash as f32 + offset));
            if to.y < 0.0 {
                break;
            }
            gizmos.line(from, to, Color::srgba(0.1, 0.1, 0.1, 0.5));
        }
    }
}
