//! A feature's example in a window: turn, zoom, drag, pause.

use bevy::prelude::*;
use bevy_drape::prelude::*;
use bevy_drape::sleep::ActivityCounts;

use crate::feature::example::Feature;
use crate::feature::materials::FeatureMaterialsPlugin;
use crate::feature::picture::FIELD_OF_VIEW;
use crate::view::clock_keys::control_clock;
use crate::view::orbit::Orbit;
use crate::view::pointer::PointerPlugin;
use crate::view::text_panel::TextPanel;
use crate::view::viewpoint::Viewpoint;
use crate::view::window::{WindowError, bare_app};

const HELP: &str = "\
left button  drag             P, O, T  pause, one step, slow motion
right button, wheel  turn, zoom        G  strain     H  this help     Esc  quit";

/// The example that the window shows.
#[derive(Resource)]
struct Shown(Feature);

/// Opens the window and stays until it is closed.
///
/// # Errors
/// [`WindowError`] if there is no display, or nothing to draw with.
pub fn open(feature: &Feature) -> Result<(), WindowError> {
    let build = feature.build;
    let mut app = bare_app(feature.title)?;
    app.add_plugins((FeatureMaterialsPlugin, PointerPlugin, build))
        .insert_resource(Shown(*feature))
        .add_systems(PostStartup, look)
        .add_systems(Update, (control_clock, show_strain, tell));
    app.run();
    Ok(())
}

fn look(shown: Res<Shown>, mut cameras: Query<(&mut Orbit, &mut Transform, &mut Projection)>) {
    let Feature { eye, target, .. } = shown.0;
    let view = Viewpoint { eye, target, field_of_view: FIELD_OF_VIEW };
    for (mut orbit, mut transform, mut projection) in &mut cameras {
        *orbit = view.orbit();
        view.apply(&mut transform, &mut projection);
    }
}

fn show_strain(keys: Res<ButtonInput<KeyCode>>, mut gizmos: ResMut<GizmoConfigStore>) {
    if keys.just_pressed(KeyCode::KeyG) {
        let drape = gizmos.config_mut::<DrapeGizmos>().0;
        drape.enabled = !drape.enabled;
    }
}

fn tell(shown: Res<Shown>, counts: Res<ActivityCounts>, mut panel: ResMut<TextPanel>) {
    let Feature { title, controls, .. } = shown.0;
    let ActivityCounts { active, resting, culled, frozen } = *counts;
    let counts = format!("bodies: {active} active, {resting} resting, {culled} culled, {frozen} frozen");
    let lines = [title, controls, &counts];
    let told: Vec<&str> = lines.into_iter().filter(|line| !line.is_empty()).collect();
    panel.show(&told.join("\n"), HELP);
}
