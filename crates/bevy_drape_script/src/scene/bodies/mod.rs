//! Bodies: cloths, ropes, soft balls, soft solids, hand-built rigs, and balls.
//!
//! Import `value` and `mesh`; [`Body`] gathers the kinds. Called by `scene_script`, the checks and `play`.

mod balls;
mod body;
mod cloth;
mod cloth_mesh;
mod copies;
mod mesh_source;
mod paint_channel;
mod rig;
mod rope;
mod soft_ball;
mod soft_body;
mod tearable;

pub use balls::Balls;
pub use body::Body;
pub use cloth::{Cloth, Pins};
pub use cloth_mesh::ClothMesh;
pub use copies::Copies;
pub use mesh_source::MeshSource;
pub use paint_channel::PaintChannel;
pub use rig::{Rig, RigParticle, RigStick, StickBound, StickKind};
pub use rope::Rope;
pub use soft_ball::SoftBall;
pub use soft_body::SoftBody;
pub use tearable::Tearable;
