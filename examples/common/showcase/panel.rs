//! The showcase's list, sliders and figures.

use core::time::Duration;

use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore, FrameTimeDiagnosticsPlugin};
use bevy::prelude::*;
use bevy::time::common_conditions::on_real_timer;
use bevy_drape::body::DefaultSolverSettings;
use bevy_drape::clock::DrapeClock;
use bevy_drape::diagnostics::DrapeDiagnosticsPlugin;
use bevy_drape::prelude::*;

use crate::feature::example::Feature;
use crate::showcase::selection::Showcase;
use crate::view::IN_PAGE;
use crate::view::slider::{Slider, SliderPlugin};
use crate::view::text_panel::TextPanel;
use crate::view::touch::Press;

/// Time between two updates of the figures.
const INTERVAL: Duration = Duration::from_millis(200);

const HELP: &str = "\
left, right  the example before, the next     R  again      P, O, T  pause, one step, slow motion
G  strain    F  record a film    drag, turn, zoom: left button, right button, wheel    H  this help";

/// The setting that a slider changes.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
enum Setting {
    Substeps,
    Iterations,
    Gravity,
    Wind,
    Pace,
}

const SETTINGS: [(Setting, &str, f32, f32); 5] = [
    (Setting::Substeps, "substeps", 1.0, 32.0),
    (Setting::Iterations, "iterations", 1.0, 16.0),
    (Setting::Gravity, "gravity, m/s2", 0.0, 20.0),
    (Setting::Wind, "wind, m/s", 0.0, 15.0),
    (Setting::Pace, "pace", 0.0, 2.0),
];

/// An example in the list.
#[derive(Component)]
struct Entry(usize);

/// Marks the panel of the sliders.
#[derive(Component)]
pub struct Sliders;

/// The number beside a slider.
#[derive(Component)]
struct Reading(Setting);

/// Shows them and applies them.
pub struct ShowcasePanelPlugin;

impl Plugin for ShowcasePanelPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((SliderPlugin, DrapeDiagnosticsPlugin, FrameTimeDiagnosticsPlugin::default()))
            .add_systems(Startup, (spawn_list.run_if(|| !IN_PAGE), spawn_sliders))
            .add_systems(Update, (choose, set, read).chain())
            .add_systems(Update, tell.run_if(on_real_timer(INTERVAL)));
    }
}

fn words(text: &str) -> impl Bundle {
    let font = TextFont { font_size: 14.0.into(), ..default() };
    (Text::new(text), font, TextColor(Color::srgb(0.95, 0.95, 0.92)), TextLayout::no_wrap())
}

fn column(node: Node) -> impl Bundle {
    let node = Node {
        position_type: PositionType::Absolute,
        flex_direction: FlexDirection::Column,
        row_gap: px(4),
        padding: UiRect::all(px(8)),
        ..node
    };
    (node, BackgroundColor(Color::srgba(0.05, 0.05, 0.07, 0.6)))
}

fn spawn_list(mut commands: Commands, showcase: Res<Showcase>) {
    commands.spawn(column(Node { top: px(120), left: px(10), ..default() })).with_children(|list| {
        for (index, (name, _)) in showcase.features.iter().enumerate() {
            list.spawn((Entry(index), words(name)));
        }
    });
}

fn spawn_sliders(mut commands: Commands) {
    let place = Node { top: px(10), right: px(10), ..default() };
    commands.spawn((Sliders, column(place))).with_children(|rows| {
        for (setting, name, from, to) in SETTINGS {
            rows.spawn((Reading(setting), words(name)));
            let bar = Node { width: px(220), height: px(16), ..default() };
            rows.spawn((setting, Slider::new(from, to), bar));
        }
    });
}

/// Shows the example that is pressed in the list, and marks the one that is shown.
fn choose(
    mut entries: Query<(&Entry, &ComputedNode, &UiGlobalTransform, &mut TextColor)>,
    mut showcase: ResMut<Showcase>,
    press: Press,
) {
    let pressed = press.place().filter(|_| press.has_begun());
    for (&Entry(index), node, transform, mut colour) in &mut entries {
        if pressed.is_some_and(|pointer| node.contains_point(*transform, pointer)) {
            showcase.current = index;
            showcase.is_due = true;
        }
        let is_shown = index == showcase.current;
        let shade = if is_shown { Color::srgb(1.0, 0.75, 0.3) } else { Color::srgb(0.85, 0.85, 0.82) };
        colour.set_if_neq(TextColor(shade));
    }
}

/// Applies the slider that is held to all bodies; the others show the current settings.
fn set(
    mut sliders: Query<(&mut Slider, &Setting)>,
    mut settings: ResMut<DefaultSolverSettings>,
    mut own: Query<&mut SolverSettings>,
    mut gravity: ResMut<DrapeGravity>,
    mut wind: ResMut<Wind>,
    mut clock: ResMut<DrapeClock>,
) {
    for (mut slider, setting) in &mut sliders {
        if !slider.is_held {
            let value = match setting {
                Setting::Substeps => settings.substeps as f32,
                Setting::Iterations => settings.iterations as f32,
                Setting::Gravity => -gravity.0.y,
                Setting::Wind => wind.velocity.length(),
                Setting::Pace => clock.time_scale,
            };
            if slider.value != value {
                slider.value = value;
            }
            continue;
        }
        let whole = slider.value.round().max(1.0) as u32;
        match setting {
            Setting::Substeps => {
                settings.substeps = whole;
                own.iter_mut().for_each(|mut own| own.substeps = whole);
            }
            Setting::Iterations => {
                settings.iterations = whole;
                own.iter_mut().for_each(|mut own| own.iterations = whole);
            }
            Setting::Gravity => gravity.0 = Vec3::NEG_Y * slider.value,
            Setting::Wind => wind.velocity = wind.velocity.normalize_or(Vec3::X) * slider.value,
            Setting::Pace => clock.time_scale = slider.value,
        }
    }
}

/// Writes the numbers beside the sliders.
fn read(sliders: Query<(Ref<Slider>, &Setting)>, mut readings: Query<(&Reading, &mut Text)>) {
    for (slider, &setting) in &sliders {
        if !slider.is_changed() {
            continue;
        }
        let is_whole = matches!(setting, Setting::Substeps | Setting::Iterations);
        let digits = if is_whole { 0 } else { 1 };
        let name = SETTINGS.iter().find(|known| known.0 == setting).map_or("", |known| known.1);
        for (reading, mut text) in &mut readings {
            if reading.0 == setting {
                text.0 = format!("{name}: {:.digits$}", slider.value);
            }
        }
    }
}

/// Writes the title of the example and its cost.
fn tell(showcase: Res<Showcase>, diagnostics: Res<DiagnosticsStore>, mut panel: ResMut<TextPanel>) {
    type Told = DrapeDiagnosticsPlugin;
    let smoothed = |path: &DiagnosticPath| {
        diagnostics.get(path).and_then(bevy::diagnostic::Diagnostic::smoothed).unwrap_or_default()
    };
    let [step, detect, relax] = [Told::STEP, Told::DETECT, Told::RELAX].map(|path| smoothed(&path));
    let [active, resting, culled] = [Told::ACTIVE, Told::RESTING, Told::CULLED].map(|path| smoothed(&path));
    let Feature { title, controls, .. } = showcase.feature();
    panel.show(
        &format!(
            "{title}\n{controls}\nstep {step:.2} ms: search {detect:.2}, substeps {relax:.2}\n\
             {active} active, {resting} resting, {culled} culled, {} particles, {:.0} frames/s",
            smoothed(&Told::PARTICLES),
            smoothed(&FrameTimeDiagnosticsPlugin::FPS),
        ),
        HELP,
    );
}
