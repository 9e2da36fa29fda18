//! Colliders and bodies of Avian among cloth. Most tests are shared with the other bridges.

#[path = "../../../tests/bodies.rs"]
mod bodies;
#[path = "../../../tests/colliders.rs"]
mod colliders;
mod engine;
#[path = "../../../tests/laws.rs"]
mod laws;
mod materials;
#[path = "../../../tests/near.rs"]
mod near;
#[path = "../../../tests/operations.rs"]
mod operations;
#[path = "../../../tests/rope_laws.rs"]
mod rope_laws;
#[path = "../../../tests/ropes.rs"]
mod ropes;
#[path = "../../../tests/scene.rs"]
mod scene;
