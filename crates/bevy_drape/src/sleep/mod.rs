//! Sleeping, waking and culling, by the rules of the solver's `world/activity_rules.rs` and `world/waking.rs`.
//!
//! ```
//! # use bevy::prelude::*;
//! # use bevy_drape::prelude::*;
//! use bevy_drape::sleep::{ActivityCounts, SceneManager};
//!
//! fn setup(mut scene: ResMut<SceneManager>) {
//!     scene.sleep_time = 1.0; // as long at rest, then it costs nothing
//!     scene.play_area_min.y = -20.0; // what falls lower is culled
//! }
//!
//! fn report(counts: Res<ActivityCounts>) {
//!     println!("{} bodies move, {} rest", counts.active, counts.resting);
//! }
//! # let mut app = App::new();
//! # app.init_resource::<SceneManager>().init_resource::<ActivityCounts>();
//! # app.add_systems(Startup, setup).add_systems(Update, report).update();
//! ```
//!
//! `waking.rs`, `cull.rs` and `fall_asleep.rs` have one system each. `candidates.rs` lists the bodies that they check. `move_obstacles.rs`
//! does little for obstacles out of everything's reach.
//!
//! Imports bodies, balls and the environment. The plugin runs these systems before the islands are formed and after they have
//! been stepped.
//!
//! Design: `docs/design/rest_and_islands.md`.

pub(crate) mod activity_counts;
pub(crate) mod candidates;
pub(crate) mod cull;
pub(crate) mod fall_asleep;
pub(crate) mod messages;
pub(crate) mod move_obstacles;
pub(crate) mod plugin;
pub mod reach;
pub(crate) mod scene_manager;
pub(crate) mod waking;

pub use activity_counts::ActivityCounts;
pub use messages::{BodySlept, BodyWoken};
pub use scene_manager::SceneManager;
