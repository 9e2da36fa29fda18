//! Messages about contacts: hits of balls, beginnings and ends of contacts.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::contact::{BallHit, DrapeContactStarted};
//!
//! fn listen(mut hits: MessageReader<BallHit>, mut started: MessageReader<DrapeContactStarted>) {
//!     // Every hit of a ball; contacts where one of the two has `ContactEvents`.
//!     for hit in hits.read() {
//!         println!("{} hits {} with {} N s", hit.projectile, hit.target, hit.impulse);
//!     }
//!     for contact in started.read() {
//!         println!("{} touches {} at {}", contact.body, contact.other, contact.point);
//!     }
//! }
//! # App::new().add_plugins((MinimalPlugins, TransformPlugin, DrapePlugins::default())).add_systems(Update, listen).update();
//! ```
//!
//! Reads the contacts that the solver has left in the islands of `step/`. The plugin runs these systems after the substeps.
//!
//! Design: `docs/design/contact_reports.md` and `docs/design/dynamic_obstacles.md`.

pub(crate) mod contact_pairs;
pub(crate) mod events;
pub(crate) mod hit;
pub(crate) mod plugin;
pub(crate) mod reactions;
pub(crate) mod report_hits;
pub(crate) mod send_contacts;

pub use events::{
    ContactFeature, DrapeContact, DrapeContactCounts, DrapeContactEnded, DrapeContactHit,
    DrapeContactSettings, DrapeContactStarted,
};
pub use hit::{BallHit, HitTarget};
