//! The laws that hold in all engines, with obstacles of cloth itself.

mod engine;
#[path = "../../../tests/laws.rs"]
mod laws;
#[path = "../../../tests/rope_laws.rs"]
mod rope_laws;
#[expect(dead_code, reason = "tests of engines use the rest of it")]
#[path = "../../../tests/scene.rs"]
mod scene;
