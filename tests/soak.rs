//! Under fire for long, nothing grows.

use std::alloc::System;

use bevy::prelude::*;
use drape_examples::cannon_demo::scene::CannonScene;
use drape_examples::cannon_demo::soak::{app, soak};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Bytes that are in use on the heap.
fn heap() -> i64 {
    let stats = ALLOCATOR.stats();
    stats.bytes_allocated as i64 - stats.bytes_deallocated as i64
}

#[test]
fn twenty_seconds_of_fire_leave_the_memory_as_it_was() {
    let mut app = app(CannonScene { particles: UVec2::new(24, 18), ..default() }, 1);
    // Until old balls are taken away, and every list has been as long as it gets.
    let before = soak(&mut app, 14, |_| {});
    let heap_before = heap();
    let after = soak(&mut app, 6, |_| {});
    let grown = heap() - heap_before;
    assert!(grown < 100_000, "the heap has grown by {grown} bytes");
    assert!(!after.any_nan);
    assert!(after.shots >= 19, "{} shots", after.shots);
    let (before, after) = (&before.minutes[0], &after.minutes[0]);
    assert!(before.hits >= 5 && after.hits >= 5, "{before:?} {after:?}");
    assert!(after.entities <= before.entities + 1, "{before:?} {after:?}");
}
