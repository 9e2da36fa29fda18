//! The laws of physics that the solver must keep, one file for each subject. Tests cite the rule that they guard by its id
//! (S1 to S33) in docs/design/seeds.md.
//!
//! Design: `docs/design/laws_and_mutations.md`.

mod bad_input;
mod ballistic_pendulum;
mod ballistic_range;
mod balls;
mod belts;
mod catenary;
mod chain_mode;
mod common;
mod contact;
mod continuous;
mod convergence;
mod cylinder;
mod determinism;
mod drag;
mod drape;
mod drape_coefficient;
mod dynamic_obstacles;
mod frame_motion;
mod free_flight;
mod friction;
mod galilean;
mod impact_zone;
mod intrusion;
mod lines;
mod mesh;
mod mesh_cloth;
mod momentum;
mod motion_limit;
mod obstacles;
mod pendulum;
mod property;
mod ragdoll;
#[path = "../../src/random.rs"]
mod random;
mod reactions;
mod reference;
mod relaxation;
mod reports;
mod rest;
mod rest_shape;
mod restitution;
mod rigid_tetrahedron;
mod self_contact;
mod self_contact_rest;
mod self_contact_triangles;
mod soft;
mod stability;
mod stick_bounds;
mod stiffness;
mod symmetry;
mod tearing;
mod terminal_velocity;
mod tethers;
mod tetrahedron_spin;
mod thrown_cloths;
mod timestep;
mod touch;
mod weave;
mod wind;
