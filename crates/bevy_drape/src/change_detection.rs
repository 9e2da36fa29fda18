//! Reads change ticks as columns.
//!
//! Any system may change a component, and only the change tick shows it. So each step reads the ticks of all bodies.
//! They lie side by side: as slices, those of ten thousand bodies take a few microseconds, and nothing else of a
//! resting body is touched.
//!
//! ```
//! # use bevy::prelude::*;
//! use bevy_drape::change_detection::collect_changed;
//!
//! #[derive(Component)]
//! struct Door;
//!
//! fn find_opened(doors: Query<(Entity, Ref<Door>)>, mut opened: Local<Vec<Entity>>) {
//!     opened.clear();
//!     collect_changed(&doors, &mut opened);
//! }
//! # App::new().add_systems(Update, find_opened).update();
//! ```

use core::ops::Range;

use bevy::ecs::change_detection::{ContiguousComponentTicksRef, ContiguousRef, MAX_CHANGE_AGE, Tick};
use bevy::ecs::query::ArchetypeFilter;
use bevy::prelude::*;

/// Rows that are tested at once.
const BLOCK: usize = 64;

/// Appends to `found` the entities of all rows of a table for which `is_any` holds. `is_any` returns true if a
/// condition holds for any of a range of rows; whole blocks are tested first.
pub(crate) fn collect_rows(
    entities: &[Entity],
    is_any: impl Fn(Range<usize>) -> bool,
    found: &mut Vec<Entity>,
) {
    for_rows(entities.len(), is_any, |row| found.push(entities[row]));
}

/// Calls `visit` with each of `count` rows for which `is_any` holds; whole blocks are tested first.
pub(crate) fn for_rows(count: usize, is_any: impl Fn(Range<usize>) -> bool, mut visit: impl FnMut(usize)) {
    for start in (0..count).step_by(BLOCK) {
        let block = start..(start + BLOCK).min(count);
        if is_any(block.clone()) {
            block.filter(|&row| is_any(row..row + 1)).for_each(&mut visit);
        }
    }
}

/// True if any of these rows was added or changed since the system last ran.
pub(crate) fn is_any_changed(ticks: &ContiguousComponentTicksRef, rows: Range<usize>) -> bool {
    let now = ticks.this_run().get();
    let age_of_last_run = now.wrapping_sub(ticks.last_run().get()).min(MAX_CHANGE_AGE);
    // The same as `Tick::is_newer_than`, for many ticks at once.
    let is_newer = |tick: &Tick| now.wrapping_sub(tick.get()) < age_of_last_run;
    ticks.changed()[rows].iter().fold(false, |any, tick| any | is_newer(tick))
}

/// Appends to `found` the entities whose `C` was added or changed since the system last ran: as a query for [`Changed`], in a
/// tenth of its time. Finds none if `C` is not stored in tables.
pub fn collect_changed<C: Component, F: ArchetypeFilter>(
    query: &Query<(Entity, Ref<C>), F>,
    found: &mut Vec<Entity>,
) {
    for (entities, components) in query.contiguous_iter().into_iter().flatten() {
        let (_, ticks) = ContiguousRef::split(components);
        collect_rows(entities, |rows| is_any_changed(&ticks, rows), found);
    }
}

/// Keeps those of `found` from place `first` on for which `is_kept` holds.
pub(crate) fn retain_from(found: &mut Vec<Entity>, first: usize, mut is_kept: impl FnMut(Entity) -> bool) {
    let mut place = 0;
    found.retain(|&entity| {
        place += 1;
        place <= first || is_kept(entity)
    });
}

/// True if any `C` was added or changed since the system last ran.
pub(crate) fn has_changed<C: Component, F: ArchetypeFilter>(query: &Query<Ref<C>, F>) -> bool {
    query.contiguous_iter().into_iter().flatten().any(|components| {
        let (components, ticks) = ContiguousRef::split(components);
        is_any_changed(&ticks, 0..components.len())
    })
}
