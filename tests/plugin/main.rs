//! The Bevy plugin, with exact time: sixty steps a second, one in each update.

mod bad_components;
mod bad_resources;
mod bad_states;
mod cannons;
mod clock;
mod common;
mod components;
mod contact_events;
mod culling;
mod despawning;
mod drape;
mod dynamic_obstacles;
mod hits;
mod isolation;
mod layered_clothes;
mod layers;
mod logging;
mod pins;
mod reflection;
mod schedule;
mod simulates;
mod sleeping;
mod soft;
mod tearing;
mod threads;
mod waking;
