//! Colliders and bodies of Avian among cloth.

mod bodies;
mod colliders;
mod common;
mod laws;
mod operations;
