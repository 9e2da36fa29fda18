//! Culled bodies are not drawn.

use bevy::prelude::*;

use crate::body::activity::Activity;

/// On a body that was hidden because it is culled: what its visibility was before.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct HiddenByCulling(Visibility);

impl HiddenByCulling {
    /// Hides something.
    pub fn hide(visibility: &mut Mut<Visibility>) -> Self {
        let before = **visibility;
        visibility.set_if_neq(Visibility::Hidden);
        Self(before)
    }

    /// Shows it as before, unless somebody else has changed it.
    pub fn show(self, visibility: &mut Mut<Visibility>) {
        visibility.set_if_neq(if **visibility == Visibility::Hidden { self.0 } else { **visibility });
    }
}

/// Hides what was culled, and shows it again when it comes back. What somebody else hid stays hidden.
pub(crate) fn hide_culled(
    mut commands: Commands,
    mut bodies: Query<
        (Entity, &Activity, &mut Visibility, Option<&HiddenByCulling>),
        Or<(Changed<Activity>, Added<Visibility>)>,
    >,
) {
    for (entity, activity, mut visibility, hidden) in &mut bodies {
        match (*activity == Activity::Culled, hidden) {
            (true, None) => {
                commands.entity(entity).insert(HiddenByCulling::hide(&mut visibility));
            }
            (false, Some(hidden)) => {
                commands.entity(entity).remove::<HiddenByCulling>();
                hidden.show(&mut visibility);
            }
            _ => {}
        }
    }
}
