//! Run conditions for the propagation of transforms.
//!
//! Bevy's systems of propagation visit every entity. These conditions skip them in steps without a change.

use bevy::prelude::*;

use crate::change_detection::has_changed;

/// True if an entity with a parent or children has moved, or has gained or lost one.
pub(crate) fn have_hierarchies_moved(
    moved: Query<Ref<Transform>, Or<(With<ChildOf>, With<Children>)>>,
    hung: Query<Ref<ChildOf>>,
    mut orphaned: RemovedComponents<ChildOf>,
) -> bool {
    // All three are evaluated, so that none reports an old change the next time.
    [has_changed(&moved), has_changed(&hung), orphaned.read().count() > 0].contains(&true)
}

/// True if an entity without parent and children has moved, or has just lost its parent.
pub(crate) fn have_unparented_moved(
    moved: Query<Ref<Transform>, (Without<ChildOf>, Without<Children>)>,
    mut orphaned: RemovedComponents<ChildOf>,
) -> bool {
    [has_changed(&moved), orphaned.read().count() > 0].contains(&true)
}
