//! The showcase in the page of a browser: the end of the address names the example, and the page has the list.

use bevy::prelude::*;

use crate::showcase::panel::Sliders;
use crate::showcase::selection::Showcase;
use crate::view::page::{fragment, mark, set_fragment};

/// Width of a window in pixels from which there is room for sliders.
const ROOM: f32 = 700.0;

/// Follows the address, marks the page with the name of the example that has begun, and hides sliders from a narrow window.
pub struct ShowcasePagePlugin;

impl Plugin for ShowcasePagePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, ((tell_example, follow_address).chain(), hide_sliders));
    }
}

fn follow_address(mut showcase: ResMut<Showcase>, mut known: Local<String>) {
    let wanted = fragment();
    let (shown, _) = showcase.features[showcase.current];
    if wanted == *known {
        if shown != *known {
            set_fragment(shown);
            shown.clone_into(&mut known);
        }
        return;
    }
    if let Some(index) = showcase.features.iter().position(|(name, _)| *name == wanted) {
        showcase.current = index;
        showcase.is_due = true;
    }
    *known = wanted;
}

fn tell_example(showcase: Res<Showcase>, mut told: Local<Option<usize>>) {
    if !showcase.is_due && *told != Some(showcase.current) {
        *told = Some(showcase.current);
        mark("data-example", showcase.features[showcase.current].0);
    }
}

fn hide_sliders(
    windows: Query<&Window, Changed<Window>>,
    mut sliders: Query<&mut Visibility, With<Sliders>>,
) {
    for window in &windows {
        let wanted = if window.width() < ROOM { Visibility::Hidden } else { Visibility::Inherited };
        for mut visibility in &mut sliders {
            visibility.set_if_neq(wanted);
        }
    }
}
