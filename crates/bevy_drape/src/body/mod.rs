//! The components of a simulated body.
//!
//! Data only: particles, settings, layers and marks. Imports root files such as `clock` and `refusal`; every feature above
//! reads these components.

pub mod activity;
pub(crate) mod body_state;
pub mod contact_events;
pub mod layers;
pub mod particles;
pub(crate) mod plugin;
pub mod pressure;
pub mod settings;
pub mod tearable;
