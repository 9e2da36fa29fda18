//! Prints what the bridge costs among Avian's colliders:
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml -p bevy_drape_avian --example avian_cost` (with `--ignore-rust-version` on an old Rust)

#[path = "../../../tests/cost.rs"]
mod cost;
#[expect(dead_code, unused_imports, reason = "the tests use the rest of it")]
#[path = "../../tests/avian/engine.rs"]
mod engine;

use avian3d::schedule::PhysicsSystems;
use bevy::prelude::*;

use crate::cost::StartClock;

fn main() {
    cost::print_all(|app| _ = app.configure_sets(FixedPostUpdate, StartClock.after(PhysicsSystems::Last)));
}
