//! Hand-built rigs: one entity per particle and per stick, compiled into bodies.

mod bad_input;
mod edits;
mod joints;
mod physics;
mod ragdoll;
mod rigid_tetrahedron;
mod support;
mod transforms;
