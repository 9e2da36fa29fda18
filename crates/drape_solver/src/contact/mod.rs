//! contact.

pub(crate) mod ball_ball;
pub(crate) mod ball_cloth;
pub(crate) mod ball_cloth_query;
pub(crate) mod ball_obstacle;
pub(crate) mod ccd;
pub(crate) mod cloth_cloth;
pub(crate) mod depenetration;
pub(crate) mod dynamic_obstacle;
pub(crate) mod effective_mass;
pub(crate) mod embedded_obstacle;
pub mod event;
pub(crate) mod face_obstacle;
pub(crate) mod friction;
pub(crate) mod impact_zone;
pub(crate) mod particle_dynamic;
pub(crate) mod particle_obstacle;
pub(crate) mod particle_particle;
pub mod reaction;
pub(crate) mod report;
pub(crate) mod restitution;
pub(crate) mod triangle_triangle;
pub(crate) mod untangle;
