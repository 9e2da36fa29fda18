//! Culled bodies are not drawn.

use bevy::prelude::*;

use crate::activity::Activity;

/// On a body that was hidden because it is culled: what its visibility was before.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct HiddenByCulling(Visibility);

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
                commands.entity(entity).insert(HiddenByCulling(*visibility));
                visibility.set_if_neq(Visibility::Hidden);
            }
            (false, Some(&HiddenByCulling(before))) => {
                commands.entity(entity).remove::<HiddenByCulling>();
                if *visibility == Visibility::Hidden {
                    *visibility = before;
                }
            }
            _ => {}
        }
    }
}
