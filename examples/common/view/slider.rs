//! A bar that is held with the pointer to choose a number.

use bevy::prelude::*;

use crate::view::touch::Press;

/// Colour of the part of a bar that is chosen.
const CHOSEN: Color = Color::srgb(0.85, 0.55, 0.2);
/// Colour of the rest.
const REST: Color = Color::srgba(0.05, 0.05, 0.07, 0.6);

/// A bar that stands for the numbers from one to another.
#[derive(Component, Clone, Copy, Debug)]
pub struct Slider {
    /// The number at the left end.
    pub from: f32,
    /// The number at the right end.
    pub to: f32,
    /// The number that is chosen.
    pub value: f32,
    /// True while the pointer holds the bar.
    pub is_held: bool,
}

impl Slider {
    /// From one number to another, at the first.
    pub fn new(from: f32, to: f32) -> Self {
        Self { from, to, value: from, is_held: false }
    }

    /// The part of the bar that is chosen, from 0 to 1.
    fn part(&self) -> f32 {
        ((self.value - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }
}

/// The part of a bar that is chosen.
#[derive(Component)]
struct Chosen;

/// Follows the pointer along [`Slider`]s.
pub struct SliderPlugin;

impl Plugin for SliderPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, hold).add_systems(PostUpdate, fill).add_observer(dress);
    }
}

/// Adds the bars of a new slider.
fn dress(added: On<Add<Slider>>, mut commands: Commands) {
    let chosen = Node { width: percent(0), height: percent(100), ..default() };
    commands.entity(added.entity).insert(BackgroundColor(REST)).with_child((
        Chosen,
        chosen,
        BackgroundColor(CHOSEN),
    ));
}

/// Takes the number at which a bar is held.
fn hold(mut sliders: Query<(&mut Slider, &ComputedNode, &UiGlobalTransform)>, press: Press) {
    let pointer = press.place();
    for (mut slider, node, transform) in &mut sliders {
        let place = pointer.and_then(|pointer| node.normalize_point(*transform, pointer));
        let is_over = pointer.is_some_and(|pointer| node.contains_point(*transform, pointer));
        let begins = is_over && press.has_begun();
        let is_held = place.is_some() && (begins || slider.is_held && press.is_down());
        if let Some(place) = place.filter(|_| is_held) {
            let part = (place.x + 0.5).clamp(0.0, 1.0);
            slider.value = slider.from + part * (slider.to - slider.from);
        }
        if slider.is_held != is_held {
            slider.is_held = is_held;
        }
    }
}

fn fill(sliders: Query<(&Slider, &Children), Changed<Slider>>, mut chosen: Query<&mut Node, With<Chosen>>) {
    for (slider, children) in &sliders {
        for child in children {
            if let Ok(mut node) = chosen.get_mut(*child) {
                node.width = percent(100.0 * slider.part());
            }
        }
    }
}
