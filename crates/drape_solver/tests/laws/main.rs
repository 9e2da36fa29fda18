//! The laws of physics that the solver must keep, one file a subject. Tests cite what they guard by its id
//! (S1 to S33) in the digest of the founding papers.

mod bad_input;
mod balls;
mod belts;
mod common;
mod contact;
mod continuous;
mod determinism;
mod drag;
mod drape;
mod dynamic_obstacles;
mod free_flight;
mod friction;
mod impact_zone;
mod intrusion;
mod lines;
mod mesh;
mod momentum;
mod obstacles;
mod property;
mod reactions;
mod reference;
mod relaxation;
mod reports;
mod restitution;
mod rope;
mod self_contact;
mod self_contact_triangles;
mod stability;
mod stiffness;
mod tethers;
mod timestep;
mod touch;
