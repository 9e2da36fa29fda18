//! state.

pub mod ball;
pub mod body;
pub(crate) mod grid;
pub mod hash;
pub mod island;
pub mod layers;
pub(crate) mod layout;
pub mod measure;
pub mod obstacle;
pub mod obstacles;
pub(crate) mod particle_stats;
pub mod particles;
pub(crate) mod renumbering;
pub mod rigid_body;
pub mod settings;
pub mod snapshot;
pub mod topology;
pub(crate) mod torn_grid;
