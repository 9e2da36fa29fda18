//! The page of a browser that the window is a part of: its address, and its elements that show results.

use bevy::prelude::*;
use bevy::render::render_resource::PipelineCache;
use bevy::render::{Render, RenderApp, RenderSystems};
use bevy::ui::UiScale;

/// Width of a window in pixels at which texts have their full size.
const FULL_WIDTH: f32 = 500.0;
/// Smallest size of texts, as a part of their full size.
const SMALLEST: f32 = 0.75;
/// Vertical angle of view in radians of a wide window.
const FIELD_OF_VIEW: f32 = 0.7;
/// Width of a window, as a part of its height, from which it is wide.
const WIDE: f32 = 1.2;
/// Frames without a shader to compile, after which the picture is whole.
const CALM_FRAMES: u32 = 3;

/// Tells the page when there is a picture, and makes scenes and texts fit into a narrow window.
pub struct PagePlugin;

impl Plugin for PagePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, (fit_view, fit_texts));
        if let Some(renderer) = app.get_sub_app_mut(RenderApp) {
            renderer.add_systems(Render, tell_picture.after(RenderSystems::Render));
        }
    }
}

fn document() -> Option<web_sys::Document> {
    web_sys::window()?.document()
}

/// The parameters of the address as a command line without the name of the program: `--shots 5` for `?shots=5`.
pub fn arguments() -> Vec<String> {
    let query = web_sys::window().and_then(|window| window.location().search().ok()).unwrap_or_default();
    let parameters = query.trim_start_matches('?').split('&').filter(|parameter| !parameter.is_empty());
    let mut line = Vec::new();
    for parameter in parameters {
        let (name, value) = parameter.split_once('=').unwrap_or((parameter, ""));
        line.push(format!("--{name}"));
        if !value.is_empty() {
            line.push(value.to_owned());
        }
    }
    line
}

/// The end of the address: `flag` for `#flag`.
pub fn fragment() -> String {
    let fragment = web_sys::window().and_then(|window| window.location().hash().ok()).unwrap_or_default();
    fragment.trim_start_matches('#').to_owned()
}

/// Goes to another end of the address.
pub fn set_fragment(fragment: &str) {
    if let Some(window) = web_sys::window() {
        // It fails only for addresses that cannot be read.
        window.location().set_hash(fragment).ok();
    }
}

/// Shows a text in the element of this id, if there is one.
pub fn show(id: &str, text: &str) {
    if let Some(element) = document().and_then(|document| document.get_element_by_id(id)) {
        element.set_text_content(Some(text));
    }
}

/// Gives the page's root an attribute.
pub fn mark(name: &str, value: &str) {
    if let Some(root) = document().and_then(|document| document.document_element()) {
        // It fails only for names that no attribute can have.
        root.set_attribute(name, value).ok();
    }
}

/// Marks the page as `data-drawn` once nothing is missing in the picture.
fn tell_picture(pipelines: Res<PipelineCache>, mut calm: Local<u32>) {
    if *calm == CALM_FRAMES {
        return;
    }
    let is_calm = pipelines.pipelines().next().is_some() && pipelines.waiting_pipelines().next().is_none();
    *calm = if is_calm { *calm + 1 } else { 0 };
    if *calm == CALM_FRAMES {
        mark("data-drawn", "");
    }
}

/// Shows as much across a narrow window as across the narrowest of the wide ones.
fn fit_view(windows: Query<&Window>, mut cameras: Query<&mut Projection>) {
    let height =
        windows.iter().map(|window| WIDE * window.height() / window.width().max(1.0)).fold(1.0, f32::max);
    let wanted = 2.0 * (height * (0.5 * FIELD_OF_VIEW).tan()).atan();
    for mut projection in &mut cameras {
        let is_due =
            matches!(&*projection, Projection::Perspective(perspective) if perspective.fov != wanted);
        if is_due && let Projection::Perspective(perspective) = &mut *projection {
            perspective.fov = wanted;
        }
    }
}

fn fit_texts(windows: Query<&Window, Changed<Window>>, mut scale: ResMut<UiScale>) {
    for window in &windows {
        let wanted = (window.width() / FULL_WIDTH).clamp(SMALLEST, 1.0);
        // A change lays all texts out again.
        if scale.0 != wanted {
            scale.0 = wanted;
        }
    }
}
