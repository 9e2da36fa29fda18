//! Hides culled bodies.

use bevy::prelude::*;

use crate::body::activity::Activity;

/// Visibility of a culled body before it was hidden.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct HiddenByCulling(Visibility);

impl HiddenByCulling {
    /// Hides an entity, and keeps its visibility.
    pub fn hide(visibility: &mut Mut<Visibility>) -> Self {
        let before = **visibility;
        visibility.set_if_neq(Visibility::Hidden);
        Self(before)
    }

    /// Restores the visibility, unless it was changed by hand.
    pub fn show(self, visibility: &mut Mut<Visibility>) {
        visibility.set_if_neq(if **visibility == Visibility::Hidden { self.0 } else { **visibility });
    }
}

/// Hides culled bodies, and shows them again when they return. Bodies that were hidden by hand stay hidden.
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
