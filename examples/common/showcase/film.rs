//! Pictures of the window, one after another, to make a film of.
//!
//! While it records, each frame takes one picture's length of simulated time, however long drawing takes, so that the film has
//! the right pace on any machine. The texts over the picture are hidden.

use core::time::Duration;
use std::io;
use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy::window::PrimaryWindow;

/// The folder of films, one folder in it for each.
const FOLDER: &str = "target/showcase";
/// Pictures for each second.
const RATE: u32 = 30;

/// Key F begins and ends a film.
pub struct FrameRecorderPlugin;

impl Plugin for FrameRecorderPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<FrameRecorder>().add_systems(Update, (control, record).chain());
    }
}

/// The film that is recorded now.
#[derive(Resource, Default)]
struct FrameRecorder(Option<Film>);

struct Film {
    folder: PathBuf,
    pictures: u32,
    /// The settings to restore when the film ends.
    clock: TimeUpdateStrategy,
    title: String,
    hidden: Vec<(Entity, Visibility)>,
}

/// Makes a new folder in `parent`.
fn new_folder(parent: &Path) -> io::Result<PathBuf> {
    std::fs::create_dir_all(parent)?;
    let parent = parent.canonicalize()?;
    for number in 1_u32.. {
        let folder = parent.join(format!("film_{number:03}"));
        match std::fs::create_dir(&folder) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            made => return made.map(|()| folder),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

fn control(
    keys: Res<ButtonInput<KeyCode>>,
    mut recorder: ResMut<FrameRecorder>,
    mut clock: ResMut<TimeUpdateStrategy>,
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
    mut panels: Query<(Entity, &mut Visibility), (With<Node>, Without<ChildOf>)>,
) {
    if !keys.just_pressed(KeyCode::KeyF) {
        return;
    }
    let Ok(mut window) = windows.single_mut() else { return };
    if let Some(film) = recorder.0.take() {
        *clock = film.clock;
        window.title = film.title;
        for (panel, before) in film.hidden {
            if let Ok((_, mut visibility)) = panels.get_mut(panel) {
                *visibility = before;
            }
        }
        let (pictures, folder) = (film.pictures, film.folder.display());
        info!("{pictures} pictures: ffmpeg -framerate {RATE} -i {folder}/frame_%05d.png film.mp4");
        return;
    }
    let folder = match new_folder(Path::new(FOLDER)) {
        Ok(folder) => folder,
        Err(error) => {
            error!("cannot make a folder in {FOLDER}: {error}");
            return;
        }
    };
    info!("recording into {}; F ends it", folder.display());
    let title = window.title.clone();
    window.title = format!("{title}: recording, F ends it");
    let hide = |(panel, mut visibility): (Entity, Mut<Visibility>)| {
        (panel, core::mem::replace(&mut *visibility, Visibility::Hidden))
    };
    let hidden = panels.iter_mut().map(hide).collect();
    let picture = TimeUpdateStrategy::ManualDuration(Duration::from_secs(1) / RATE);
    let clock = core::mem::replace(&mut *clock, picture);
    recorder.0 = Some(Film { folder, pictures: 0, clock, title, hidden });
}

fn record(mut recorder: ResMut<FrameRecorder>, mut commands: Commands) {
    let Some(film) = &mut recorder.0 else { return };
    let path = film.folder.join(format!("frame_{:05}.png", film.pictures));
    film.pictures += 1;
    commands.spawn(Screenshot::primary_window()).observe(save_to_disk(path));
}
