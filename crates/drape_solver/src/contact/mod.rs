//! The narrow phase. A file for each kind of contact has its detection, projection and friction:
//!
//! ```text
//! particle_obstacle   particles against obstacles, sixteen at a time
//! particle_dynamic    particles against obstacles that contacts push
//! face_obstacle       faces and links against obstacles that slip between particles
//! embedded_obstacle   corners of a rigid body's collision mesh against obstacles
//! ball_obstacle       balls against obstacles
//! ball_ball           balls against balls
//! ball_cloth          balls against cloth and ropes
//! impact_zone         the last stage of balls and cloth: nothing has passed through a face
//! surface/            cloth and ropes against themselves and each other: corners, faces and edges
//! ```
//!
//! The other files help them:
//!
//! ```text
//! island_contacts, body_contacts                 the kinds of an island, and of a body with obstacles
//! carried_point                                  a contact of face_obstacle and embedded_obstacle
//! face_search, face_sides, face_lanes            parts of face_obstacle: its search, the sides of faces, its kernels
//! ccd                                            what passes something within a substep
//! mover, dynamic_obstacle, obstacle_push         obstacles that contacts push
//! joint                                          particles that are held at points of such obstacles
//! depenetration, effective_mass, restitution     formulas
//! hit_substeps                                   the substeps that fast or heavy things need
//! event, report, reaction                        what contacts report
//! ball_cloth_query, limit_conflict               overlaps that are only counted or listed
//! ```
//!
//! ```
//! use drape_solver::contact::event::{Other, Party};
//! use drape_solver::glam::Vec3;
//! use drape_solver::{BodySettings, ClothBuilder, Environment, Island, Obstacle, step};
//!
//! // A sheet falls flat from one centimetre.
//! let sheet = ClothBuilder::new(1.0, 1.0, 8, 8).placed(Vec3::Y * 0.01, Vec3::X, Vec3::Z);
//! let mut island = Island::of_body(sheet.build(BodySettings::default())?);
//! island.bodies[0].reports_contacts = true;
//! let ground = Environment { obstacles: [Obstacle::ground()].into(), ..Environment::default() };
//! for _ in 0..30 {
//!     step(&mut island, &ground)?;
//! }
//! let contact = island.contacts[0];
//! assert_eq!(contact.pair(), (Party::Body(0), Other::Obstacle(0)));
//! assert!(contact.impulse > 0.0 && contact.normal == Vec3::Y);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
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
pub(crate) mod depenetration;
pub(crate) mod dynamic_obstacle;
pub(crate) mod effective_mass;
pub(crate) mod embedded_obstacle;
pub mod event;
pub(crate) mod face_lanes;
pub(crate) mod face_obstacle;
pub(crate) mod face_search;
pub(crate) mod face_sides;
pub(crate) mod hit_substeps;
pub(crate) mod impact_zone;
pub(crate) mod island_contacts;
pub(crate) mod joint;
pub(crate) mod limit_conflict;
pub(crate) mod mover;
pub(crate) mod obstacle_push;
pub(crate) mod particle_dynamic;
pub(crate) mod particle_obstacle;
pub mod reaction;
pub(crate) mod report;
pub(crate) mod restitution;
pub(crate) mod support;
pub(crate) mod surface;
pub(crate) mod surfaces_nearby;
pub(crate) mod tether_pull;
