//! Prints what the bridge costs among Rapier's colliders:
//!
//! `cargo run --release --manifest-path bridges/Cargo.toml -p bevy_drape_rapier --example rapier_cost` (with `--ignore-rust-version` on an old Rust)

#[path = "../../../tests/cost.rs"]
mod cost;
#[expect(dead_code, unused_imports, reason = "the tests use the rest of it")]
#[path = "../../tests/rapier/engine.rs"]
mod engine;

fn main() {
    // Rapier steps in `FixedUpdate`.
    cost::print_all(|_| {});
}
