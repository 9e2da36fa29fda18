//! The texts over the picture of a scene, recording or example.

use bevy::prelude::*;

use crate::view::IN_PAGE;

/// The texts; H hides the help.
#[derive(Resource, Default)]
pub struct TextPanel {
    text: String,
    help: String,
}

impl TextPanel {
    /// Shows these from now on.
    pub fn show(&mut self, text: &str, help: &str) {
        if self.text != text {
            self.text = text.to_string();
        }
        if self.help != help {
            self.help = help.to_string();
        }
    }
}

/// How texts are laid out, and how wide their panels can be: in a page they have to fit into a narrow window.
pub(crate) fn layout() -> (TextLayout, Val) {
    if IN_PAGE { (TextLayout::default(), percent(94)) } else { (TextLayout::no_wrap(), Val::Auto) }
}

#[derive(Component)]
pub(crate) enum Line {
    State,
    Help,
}

/// Spawns the texts.
pub fn spawn_panel(mut commands: Commands) {
    let (layout, max_width) = layout();
    let panel = |line: Line, node: Node| {
        (
            line,
            Text::default(),
            TextFont { font_size: 15.0.into(), ..default() },
            layout,
            TextColor(Color::srgb(0.95, 0.95, 0.92)),
            BackgroundColor(Color::srgba(0.05, 0.05, 0.07, 0.6)),
            Node { position_type: PositionType::Absolute, padding: UiRect::all(px(8)), max_width, ..node },
        )
    };
    commands.spawn(panel(Line::State, Node { top: px(10), left: px(10), ..default() }));
    let help = if IN_PAGE { Visibility::Hidden } else { Visibility::Inherited };
    commands.spawn((panel(Line::Help, Node { bottom: px(44), left: px(10), ..default() }), help));
    commands.init_resource::<TextPanel>();
}

/// Brings the texts up to date.
pub fn write_panel(
    panel: Res<TextPanel>,
    keys: Res<ButtonInput<KeyCode>>,
    mut lines: Query<(&Line, &mut Text, &mut Visibility)>,
) {
    for (line, mut text, mut visibility) in &mut lines {
        let wanted = match line {
            Line::State => &panel.text,
            Line::Help => &panel.help,
        };
        if text.0 != *wanted {
            text.0.clone_from(wanted);
        }
        if matches!(line, Line::Help) && keys.just_pressed(KeyCode::KeyH) {
            visibility.toggle_inherited_hidden();
        }
    }
}
