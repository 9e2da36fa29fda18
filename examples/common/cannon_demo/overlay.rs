//! The texts over the window's picture: keys and live figures.

use core::time::Duration;

use bevy::prelude::*;
use bevy::time::common_conditions::on_real_timer;
use bevy_drape::body::Sticks;
use bevy_drape::cannon::Cannon;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape::schedule::StepTimes;
use bevy_drape::sleep::ActivityCounts;
use drape_solver::state::measure;

use crate::cannon_demo::controls::{Blowing, ClothView};
use crate::cannon_demo::scene::Curtain;
use crate::view::IN_PAGE;
use crate::view::text_panel::layout;

const HELP: &str = "\
arrows, WASD      aim                    V  wind
+ -               muzzle speed           P  pause         O    one step
space, click      fire                   T  slow motion   R    reset
drag the cloth    left mouse button      G  strain, wireframe
turn, zoom        right button, wheel    H  this help     Esc  quit";

/// Time between two updates of the figures.
const INTERVAL: Duration = Duration::from_millis(250);

/// Shows help and figures.
pub struct OverlayPlugin;

impl Plugin for OverlayPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Rates>()
            .add_systems(Startup, spawn)
            .add_systems(Update, (count, toggle_help))
            .add_systems(Update, update_figures.after(count).run_if(on_real_timer(INTERVAL)));
    }
}

#[derive(Component)]
struct Help;

#[derive(Component)]
struct Figures;

/// Counts since the last update of the figures.
#[derive(Resource, Default)]
struct Rates {
    frames: u32,
    steps_before: u64,
    since: Duration,
}

fn spawn(mut commands: Commands) {
    let (layout, max_width) = layout();
    let panel = |node: Node| {
        let font = TextFont { font_size: 15.0.into(), ..default() };
        (
            Node { position_type: PositionType::Absolute, padding: UiRect::all(px(8)), max_width, ..node },
            BackgroundColor(Color::srgba(0.05, 0.05, 0.07, 0.6)),
            font,
            layout,
            TextColor(Color::srgb(0.95, 0.95, 0.92)),
        )
    };
    let top = Node { top: px(10), left: px(10), ..default() };
    let bottom = Node { bottom: px(10), left: px(10), ..default() };
    commands.spawn((Figures, Text::default(), panel(top)));
    let help = if IN_PAGE { Visibility::Hidden } else { Visibility::Inherited };
    commands.spawn((Help, Text::new(HELP), panel(bottom), help));
}

fn toggle_help(keys: Res<ButtonInput<KeyCode>>, mut help: Query<&mut Visibility, With<Help>>) {
    if keys.just_pressed(KeyCode::KeyH) {
        for mut visibility in &mut help {
            visibility.toggle_inherited_hidden();
        }
    }
}

fn count(mut rates: ResMut<Rates>, time: Res<Time<Real>>) {
    rates.frames += 1;
    rates.since += time.delta();
}

fn update_figures(
    mut figures: Query<&mut Text, With<Figures>>,
    mut rates: ResMut<Rates>,
    clock: Res<DrapeClock>,
    times: Res<StepTimes>,
    counts: Res<ActivityCounts>,
    blowing: Res<Blowing>,
    view: Res<ClothView>,
    cannons: Query<&Cannon>,
    curtains: Query<(&Particles, &Sticks), With<Curtain>>,
) {
    let seconds = rates.since.as_secs_f64().max(1e-3);
    let frame_rate = f64::from(rates.frames) / seconds;
    let step_rate = clock.steps().saturating_sub(rates.steps_before) as f64 / seconds;
    *rates = Rates { steps_before: clock.steps(), ..default() };
    let stretch = curtains.iter().map(|(particles, sticks)| measure::stretch(particles, sticks).max);
    let stretch = stretch.fold(0.0, f64::max) * 100.0;
    let aim = cannons.iter().next().map_or_else(String::new, |cannon| {
        let (elevation, azimuth) = (cannon.elevation.to_degrees(), cannon.azimuth.to_degrees());
        let speed = cannon.muzzle_speed;
        // The default font has no degree sign. Adding zero makes a zero of a negative zero.
        format!("elevation {elevation:.1} deg  azimuth {:.1} deg  speed {speed:.1} m/s", azimuth + 0.0)
    });
    let mut state = Vec::new();
    if clock.paused {
        state.push("paused");
    }
    if clock.time_scale < 1.0 {
        state.push("slow motion");
    }
    if blowing.0 {
        state.push("wind");
    }
    match *view {
        ClothView::Cloth => {}
        ClothView::Strain => state.push("strain"),
        ClothView::Wireframe => state.push("wireframe"),
    }
    let ActivityCounts { active, resting, culled, .. } = *counts;
    let cost = times.step.as_secs_f64() * 1e3;
    let text = format!(
        "{aim}\n\
         {frame_rate:.1} frames/s  {step_rate:.0} steps/s  {cost:.1} ms a step\n\
         bodies: {active} active, {resting} resting, {culled} culled\n\
         max stretch {stretch:.2} %\n\
         {}",
        state.join(", ")
    );
    for mut figures in &mut figures {
        figures.0.clone_from(&text);
    }
}
