//! The narrow phase: each file handles one kind of contact, from detection to projection and friction.
//!
//! Imports: `broad_phase` and below. A contact owns its scratch and is handed the bodies and balls that it works on.
//! Callers: `substep` and `step`.

pub(crate) mod ball_ball;
pub(crate) mod ball_cloth;
pub(crate) mod ball_cloth_query;
pub(crate) mod ball_obstacle;
pub(crate) mod body_contacts;
pub(crate) mod carried_point;
pub(crate) mod ccd;
pub(crate) mod cloth_cloth;
pub(crate) mod cloth_contact;
pub(crate) mod depenetration;
pub(crate) mod dynamic_obstacle;
pub(crate) mod effective_mass;
pub(crate) mod embedded_obstacle;
pub mod event;
pub(crate) mod face_obstacle;
pub(crate) mod hit_substeps;
pub(crate) mod impact_zone;
pub(crate) mod island_contacts;
pub(crate) mod limit_conflict;
pub(crate) mod mover;
pub(crate) mod obstacle_push;
pub(crate) mod particle_dynamic;
pub(crate) mod particle_obstacle;
pub(crate) mod particle_particle;
pub mod reaction;
pub(crate) mod report;
pub(crate) mod restitution;
pub(crate) mod triangle_pair;
pub(crate) mod triangle_triangle;
pub(crate) mod untangle;
