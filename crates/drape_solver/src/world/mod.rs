//! A world of bodies, balls and obstacles: forms islands, steps them, puts to sleep, wakes and culls.
//!
//! `world_step.rs` has the order of a step. `members.rs` wakes and culls and `world_step.rs` puts to sleep, by the rules of
//! `waking.rs` and `activity_rules.rs`.
//!
//! The top floor: it may import all others, and nothing in this crate imports it. [`World`] is for whoever uses the
//! solver without an engine. An engine with a store of its own, such as the Bevy plugin, calls the pieces instead: they
//! decide over keys, boxes and flags, and own no body. `docs/design/world.md` tells why.

pub mod activity;
pub mod activity_rules;
pub mod bounds;
pub mod events;
pub mod extent;
pub mod grouping;
pub mod id;
mod interface;
pub mod kind;
pub(crate) mod members;
pub(crate) mod obstacle_list;
pub mod resting_tree;
pub(crate) mod slots;
pub mod staged_island;
pub mod waking;
mod world_step;

pub use interface::World;
