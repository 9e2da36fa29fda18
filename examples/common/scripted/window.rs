//! A scene in a window: it runs, and begins anew whenever its file is saved.

use std::path::PathBuf;
use std::time::SystemTime;

use bevy::prelude::*;
use bevy::time::common_conditions::on_real_timer;
use bevy_drape::clock::DrapeClock;
use bevy_drape::prelude::*;
use bevy_drape_script::play::{ScenePlay, ScenePlugin, begin_scene};
use bevy_drape_script::{Override, SceneError, SceneScript, scene_name};
use thiserror::Error;

use crate::scripted::arguments::SceneArguments;
use crate::scripted::framing::{DIRECTION, Framing, viewpoint_of};
use crate::scripted::materials::SceneMaterialsPlugin;
use crate::scripted::suite::{SuiteError, files_of};
use crate::view::clock_keys::control_clock;
use crate::view::orbit::Orbit;
use crate::view::text_panel::TextPanel;
use crate::view::window::{WindowError, bare_app};

/// Time between two looks at the files.
const WATCH: core::time::Duration = core::time::Duration::from_millis(300);

const HELP: &str = "\
P, space  pause      O  one step     T  slow motion    R  from the beginning
C  next camera       G  strain       N  next scene     H  this help    Esc  quit
turn, zoom: right button, wheel";

/// Why a scene is not shown.
#[derive(Debug, Error)]
pub enum SceneWindowError {
    /// There is no window.
    #[error(transparent)]
    NoWindow(#[from] WindowError),
    /// There is no scene.
    #[error(transparent)]
    NoScenes(#[from] SuiteError),
}

/// Opens the window and stays until it is closed. Returns true if it was closed without an error.
///
/// # Errors
/// [`SceneWindowError`] if there is no display, no graphics adapter, or no scene.
pub fn run(arguments: &SceneArguments) -> Result<bool, SceneWindowError> {
    let files = files_of(&arguments.files)?;
    open("scenes", ShownScenes { files, overrides: arguments.overrides.clone(), ..default() })
}

/// The app with everything that windows of scenes and of recordings share.
///
/// # Errors
/// [`WindowError`] if there is no display, or nothing to draw with.
pub(crate) fn app(title: &str) -> Result<App, WindowError> {
    let mut app = bare_app(title)?;
    app.add_plugins(SceneMaterialsPlugin);
    Ok(app)
}

fn open(title: &str, show: ShownScenes) -> Result<bool, SceneWindowError> {
    let mut app = app(title)?;
    let exit = app
        .add_plugins(ScenePlugin)
        .insert_resource(show)
        .add_systems(PostStartup, open_current)
        .add_systems(Update, (control_clock, control, frame, tell).chain())
        .add_systems(Update, watch.run_if(on_real_timer(WATCH)))
        .run();
    Ok(exit.is_success())
}

/// The scenes that the window shows.
#[derive(Resource, Default)]
struct ShownScenes {
    files: Vec<PathBuf>,
    overrides: Vec<Override>,
    /// Index of the file that is shown.
    current: usize,
    /// The files that the scene is made of, and when they were saved.
    saved: Vec<(PathBuf, Option<SystemTime>)>,
    /// Index of the scene's camera that is looked through.
    view: usize,
    /// The box around all that was shown.
    framing: Framing,
    /// The last place of the camera from which all of that is seen; none for a scene with cameras of its own.
    framed: Option<Orbit>,
    /// The fault of the file, if it has one.
    fault: Option<SceneError>,
}

fn saved_at(path: &PathBuf) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|data| data.modified()).ok()
}

/// Loads the current file and begins its scene. If it cannot be loaded, the scene before it stays.
fn begin(world: &mut World) {
    world.resource_scope(|world, mut show: Mut<ShownScenes>| {
        let Some(path) = show.files.get(show.current).cloned() else { return };
        let mut watched = vec![path.clone()];
        match SceneScript::load_with(&path, &show.overrides) {
            Ok(script) => {
                let folder = path.parent().map(PathBuf::from).unwrap_or_default();
                watched.extend(script.include.iter().map(|part| folder.join(part)));
                begin_scene(world, script);
                show.fault = None;
            }
            Err(error) => {
                error!("{error}");
                show.fault = Some(error);
            }
        }
        show.saved = watched.into_iter().map(|path| (path.clone(), saved_at(&path))).collect();
    });
}

/// Begins the scene of the current file and places the camera.
fn open_current(world: &mut World) {
    begin(world);
    world.resource_mut::<ShownScenes>().framing = Framing::default();
    let _ = world.run_system_cached(look);
}

/// Begins the scene anew when one of its files has been saved.
fn watch(show: Res<ShownScenes>, mut commands: Commands) {
    if show.saved.iter().any(|(path, saved)| saved_at(path) != *saved) {
        commands.queue(begin);
    }
}

/// Looks through the chosen camera of the scene, or at all of a scene that has none.
fn look(
    mut show: ResMut<ShownScenes>,
    play: Option<Res<ScenePlay>>,
    mut cameras: Query<(&mut Orbit, &mut Transform, &mut Projection)>,
) {
    let Some(play) = play else { return };
    let views = &play.script().cameras;
    let view = views.values().nth(show.view % views.len().max(1)).map(viewpoint_of);
    for (mut orbit, mut transform, mut projection) in &mut cameras {
        let Some(view) = view else {
            show.framed = Some(*orbit);
            continue;
        };
        show.framed = None;
        *orbit = view.orbit();
        view.apply(&mut transform, &mut projection);
    }
}

/// Keeps all of a scene without cameras in sight, until the player turns away.
fn frame(world: &mut World) {
    world.resource_scope(|world, mut show: Mut<ShownScenes>| {
        let Some(framed) = show.framed else { return };
        show.framing.note(world);
        let view = show.framing.view();
        let (target, distance) = show.framing.middle_and_distance();
        let mut cameras = world.query::<(&mut Orbit, &mut Transform, &mut Projection)>();
        for (mut orbit, mut transform, mut projection) in cameras.iter_mut(world) {
            if *orbit != framed {
                show.framed = None;
                return;
            }
            *orbit = Orbit { target, yaw: DIRECTION.0, pitch: DIRECTION.1, distance };
            show.framed = Some(*orbit);
            view.apply(&mut transform, &mut projection);
        }
    });
}

fn control(
    keys: Res<ButtonInput<KeyCode>>,
    mut show: ResMut<ShownScenes>,
    mut clock: ResMut<DrapeClock>,
    mut gizmos: ResMut<GizmoConfigStore>,
    mut commands: Commands,
) {
    if keys.just_pressed(KeyCode::Space) {
        clock.paused = !clock.paused;
    }
    if keys.just_pressed(KeyCode::KeyN) && !show.files.is_empty() {
        show.current = (show.current + 1) % show.files.len();
        show.view = 0;
        commands.queue(open_current);
    }
    if keys.just_pressed(KeyCode::KeyR) {
        commands.queue(begin);
    }
    if keys.just_pressed(KeyCode::KeyC) {
        show.view += 1;
        commands.run_system_cached(look);
    }
    if keys.just_pressed(KeyCode::KeyG) {
        let drape = gizmos.config_mut::<DrapeGizmos>().0;
        drape.enabled = !drape.enabled;
    }
}

/// Writes the time of the scene and the verdicts of its expectations.
fn tell(
    show: Res<ShownScenes>,
    play: Option<Res<ScenePlay>>,
    clock: Res<DrapeClock>,
    mut panel: ResMut<TextPanel>,
) {
    let name = show.files.get(show.current).map(|path| scene_name(path)).unwrap_or_default();
    let mut text = format!("{name}\n");
    if let Some(play) = &play {
        let (steps, settings) = (play.steps(), &play.script().settings);
        let (now, end) = (steps as f64 * settings.dt.get(), settings.duration.get());
        let state = match (play.is_over(), clock.paused) {
            (true, _) => ", over",
            (_, true) => ", paused",
            _ => "",
        };
        text += &format!("{now:.2} of {end:.2} s, step {steps}{state}\n");
        if play.is_over() {
            for verdict in play.verdicts() {
                text += &format!("{verdict}\n");
            }
        }
        for problem in play.problems() {
            text += &format!("FAIL {problem}\n");
        }
    }
    if let Some(fault) = &show.fault {
        text += &format!("{fault}\n");
    }
    panel.show(&text, HELP);
}
