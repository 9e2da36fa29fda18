//! A recording in a window: played, paused, stepped, and scrubbed by a bar.

use std::path::Path;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_drape_script::recording::{Cursor, Recording, RecordingError, Track, TrackKind};
use thiserror::Error;

use crate::scripted::replay::{ReplayError, load};
use crate::scripted::window::app;
use crate::view::shape_meshes::{material_of, mesh_of};
use crate::view::shared_materials::{EARTH, SharedMaterials};
use crate::view::slider::{Slider, SliderPlugin};
use crate::view::text_panel::TextPanel;
use crate::view::tubes;
use crate::view::window::WindowError;

const HELP: &str = "\
drag the bar: any step      P, space: play and pause      left, right: a step, with shift ten
home, end: first and last step      right button, wheel: turn and zoom      H: this help      Esc: quit";

/// Why a recording is not shown.
#[derive(Debug, Error)]
pub enum ReplayWindowError {
    /// There is no window.
    #[error(transparent)]
    NoWindow(#[from] WindowError),
    /// There is no recording.
    #[error(transparent)]
    NoRecording(#[from] ReplayError),
}

/// Opens the window and stays until it is closed. Returns true if it was closed without an error.
///
/// # Errors
/// [`ReplayWindowError`] if there is no display, no graphics adapter, or no recording.
pub fn run(path: &Path) -> Result<bool, ReplayWindowError> {
    let recording = load(path)?;
    let mut app = app(&format!("{}: {}", path.display(), recording.header().scene))?;
    let exit = app
        .add_plugins(SliderPlugin)
        .insert_resource(Replay::new(recording))
        .add_systems(Startup, (spawn_bar, spawn_tracks))
        .add_systems(Update, (control, scrub, play, show, tell).chain())
        .run();
    Ok(exit.is_success())
}

/// The state of the replay.
#[derive(Resource)]
struct Replay {
    cursor: Cursor<Recording>,
    /// Those of the recording, which is busy while a frame of it is looked at.
    tracks: Vec<Track>,
    frame: usize,
    /// Of the step after that frame, in seconds, that have passed.
    overtime: f32,
    is_playing: bool,
    fault: Option<RecordingError>,
}

impl Replay {
    fn new(recording: Recording) -> Self {
        let tracks = recording.tracks().to_vec();
        Self {
            cursor: recording.into_cursor(),
            tracks,
            frame: 0,
            overtime: 0.0,
            is_playing: true,
            fault: None,
        }
    }

    /// The index of the last frame.
    fn last(&self) -> usize {
        self.cursor.recording().frame_count().saturating_sub(1)
    }

    fn step(&mut self, by: isize) {
        self.frame = self.frame.saturating_add_signed(by).min(self.last());
        self.is_playing = false;
    }
}

/// Shows a track.
#[derive(Component)]
struct ShownTrack(usize);

/// The bar at the bottom.
#[derive(Component)]
struct Bar;

fn spawn_bar(mut commands: Commands, replay: Res<Replay>) {
    let bar = Node {
        position_type: PositionType::Absolute,
        bottom: px(10),
        left: percent(1),
        width: percent(98),
        height: px(24),
        ..default()
    };
    commands.spawn((Bar, Slider::new(0.0, replay.last().max(1) as f32), bar));
}

fn spawn_tracks(
    mut commands: Commands,
    replay: Res<Replay>,
    shared: Res<SharedMaterials>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (index, track) in replay.cursor.recording().tracks().iter().enumerate() {
        let mut entity = commands.spawn((ShownTrack(index), Transform::default(), Visibility::Hidden));
        match &track.kind {
            TrackKind::Body { particles, faces, .. } => {
                if faces.is_empty() {
                    entity.insert((
                        Mesh3d(meshes.add(tubes::empty())),
                        MeshMaterial3d(materials.add(tubes::material())),
                        bevy::camera::visibility::NoFrustumCulling,
                    ));
                    continue;
                }
                let usage = RenderAssetUsages::default();
                let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, usage);
                mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; *particles as usize]);
                mesh.insert_indices(Indices::U32(faces.as_flattened().to_vec()));
                let fabric = StandardMaterial {
                    base_color: Color::srgb(0.62, 0.16, 0.14),
                    perceptual_roughness: 0.85,
                    double_sided: true,
                    cull_mode: None,
                    ..default()
                };
                entity.insert((
                    Mesh3d(meshes.add(mesh)),
                    MeshMaterial3d(materials.add(fabric)),
                    bevy::camera::visibility::NoFrustumCulling,
                ));
            }
            TrackKind::Ball { radius } => {
                entity.with_child((
                    Mesh3d(shared.sphere.clone()),
                    MeshMaterial3d(shared.ball.clone()),
                    Transform::from_scale(Vec3::splat(*radius)),
                ));
            }
            TrackKind::Obstacle { form } => {
                if let Some((mesh, transform)) = mesh_of(*form) {
                    entity.with_child((
                        Mesh3d(meshes.add(mesh)),
                        MeshMaterial3d(materials.add(material_of(*form, EARTH))),
                        transform,
                    ));
                }
            }
        }
    }
}

fn control(keys: Res<ButtonInput<KeyCode>>, mut replay: ResMut<Replay>) {
    if keys.any_just_pressed([KeyCode::KeyP, KeyCode::Space]) {
        replay.is_playing = !replay.is_playing;
        // From the beginning, if it is at the end.
        if replay.is_playing && replay.frame == replay.last() {
            replay.frame = 0;
        }
    }
    let stride = if keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]) { 10 } else { 1 };
    if keys.just_pressed(KeyCode::ArrowLeft) {
        replay.step(-stride);
    }
    if keys.just_pressed(KeyCode::ArrowRight) {
        replay.step(stride);
    }
    if keys.just_pressed(KeyCode::Home) {
        replay.step(isize::MIN);
    }
    if keys.just_pressed(KeyCode::End) {
        replay.step(isize::MAX);
    }
}

/// Goes to where the bar is held; where it is not, the bar goes along.
fn scrub(mut bars: Query<&mut Slider, With<Bar>>, mut replay: ResMut<Replay>) {
    for mut bar in &mut bars {
        if bar.is_held {
            replay.frame = bar.value.round() as usize;
            replay.is_playing = false;
        } else if bar.value != replay.frame as f32 {
            bar.value = replay.frame as f32;
        }
    }
}

fn play(time: Res<Time<Real>>, mut replay: ResMut<Replay>) {
    let dt = replay.cursor.recording().header().dt;
    if !replay.is_playing || replay.frame >= replay.last() || dt.is_nan() || dt <= 0.0 {
        replay.overtime = 0.0;
        return;
    }
    replay.overtime += time.delta_secs();
    let steps = (replay.overtime / dt).floor();
    replay.overtime -= steps * dt;
    replay.frame = (replay.frame + steps as usize).min(replay.last());
}

fn show(
    mut replay: ResMut<Replay>,
    mut shown: Query<(&ShownTrack, &mut Transform, &mut Visibility, Option<&Mesh3d>)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let Replay { cursor, tracks, frame: index, fault, .. } = &mut *replay;
    let frame = match cursor.seek(*index) {
        Ok(frame) => frame,
        Err(error) => {
            *fault = Some(error);
            return;
        }
    };
    for (track, mut transform, mut visibility, mesh) in &mut shown {
        let Some(state) = frame.state(track.0) else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        visibility.set_if_neq(Visibility::Inherited);
        if let TrackKind::Body { sticks, faces, .. } = &tracks[track.0].kind {
            let places: Vec<Vec3> = state.positions().collect();
            let Some(mut mesh) = mesh.and_then(|mesh| meshes.get_mut(mesh)) else { continue };
            if faces.is_empty() {
                let place = |end: u32| places.get(end as usize).copied().unwrap_or_default();
                let ends = sticks.iter().map(|ends| ends.map(place));
                tubes::write(&mut mesh, ends, tubes::RADIUS);
            } else {
                mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, places);
                mesh.compute_smooth_normals();
            }
        } else if let Some((centre, rotation)) =
            state.ball().filter(|_| matches!(tracks[track.0].kind, TrackKind::Ball { .. }))
        {
            *transform = Transform::from_translation(centre).with_rotation(rotation);
        } else if let Some(matrix) = state.obstacle() {
            *transform = Transform::from_matrix(matrix.into());
        }
    }
}

fn tell(replay: Res<Replay>, mut panel: ResMut<TextPanel>) {
    let (frame, last) = (replay.frame, replay.last());
    let header = replay.cursor.recording().header();
    let state = if replay.is_playing { "" } else { ", paused" };
    let mut text = format!("{}\nstep {frame} of {last}{state}\n", header.scene);
    if let Some(fault) = &replay.fault {
        text += &fault.to_string();
    }
    panel.show(&text, HELP);
}
