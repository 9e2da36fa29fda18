//! A world of bodies, balls and obstacles: forms islands, steps them, puts to sleep, wakes and culls.
//!
//! `world_step.rs` has the order of a step. `members.rs` wakes and culls and `world_step.rs` puts to sleep, by the rules of
//! `waking.rs` and `activity_rules.rs`.
//!
//! The top floor: it may import all others, and nothing in this crate imports it. [`World`] is for whoever uses the
//! solver without an engine. An engine with a store of its own, such as the Bevy plugin, calls the pieces instead: they
//! decide over keys, boxes and flags, and own no body. `docs/design/world.md` tells why.
//!
//! ```
//! use drape_solver::glam::Vec3;
//! use drape_solver::{Activity, BodySettings, ClothBuilder, Obstacle, World};
//!
//! let mut world = World::new();
//! world.add_obstacle(Obstacle::ground());
//! let sheet = ClothBuilder::new(1.0, 1.0, 8, 8).placed(Vec3::Y * 0.1, Vec3::X, Vec3::Z);
//! let sheet = world.add_body(sheet.build(BodySettings { drag: 2.0, ..BodySettings::default() })?);
//! // It falls, lies still, and sleeps; from then on it costs next to nothing.
//! for _ in 0..600 {
//!     world.step()?;
//! }
//! assert_eq!(world.activity(sheet), Some(Activity::Resting));
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

pub mod activity;
pub mod activity_rules;
pub mod bounds;
pub mod bounds_list;
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
