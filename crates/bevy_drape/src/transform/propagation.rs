//! Global transforms, up to date within the fixed loop.
//!
//! Bevy brings them up to date after it, which is too late for a step. Its systems look at every entity; these
//! conditions tell whether they have anything to do.

use bevy::prelude::*;

use crate::change_detection::has_changed;

/// Whether an entity with a parent or children has moved, or was given or has lost them.
pub(crate) fn have_hierarchies_moved(
    moved: Query<Ref<Transform>, Or<(With<ChildOf>, With<Children>)>>,
    hung: Query<Ref<ChildOf>>,
    mut orphaned: RemovedComponents<ChildOf>,
) -> bool {
    // All of them are asked, so that none reports an old change the next time.
    [has_changed(&moved), has_changed(&hung), orphaned.read().count() > 0].contains(&true)
}

/// Whether an entity without parent and children has moved, or has just become one.
pub(crate) fn have_unparented_moved(
    moved: Query<Ref<Transform>, (Without<ChildOf>, Without<Children>)>,
    mut orphaned: RemovedComponents<ChildOf>,
) -> bool {
    [has_changed(&moved), orphaned.read().count() > 0].contains(&true)
}
