//! Tears and cuts: stretched sticks tear, blades cut, and bodies separate into pieces.
//!
//! `tear.rs` and `cut.rs` choose the cracks, `split.rs` splits particles there and decides which sticks stay (`joined`),
//! `pieces.rs` and `piece_topology.rs` build the bodies. `frayed_edges.rs` tells how torn edges are to be drawn.
//!
//! ```
//! use drape_solver::glam::Vec3;
//! use drape_solver::{BodySettings, ClothBuilder};
//!
//! // A sheet in the plane z = 0, and a blade that stands upright in its middle.
//! let mut sheet = ClothBuilder::new(1.0, 1.0, 9, 9)
//!     .placed(Vec3::new(-0.5, 1.0, 0.0), Vec3::X, Vec3::NEG_Y)
//!     .build(BodySettings::default())?;
//! let blade = [Vec3::new(0.05, -9.0, -9.0), Vec3::new(0.05, 9.0, -9.0), Vec3::new(0.05, 0.0, 9.0)];
//! let torn = sheet.cut(&[blade])?.expect("the blade goes right through");
//! let piece = &torn.pieces[0].body;
//! // The particles of the squares that the blade crosses are there twice.
//! assert_eq!(sheet.particles.len() + piece.particles.len(), 9 * 9 + 2 * 9);
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Imports: `build` and everything below. Callers: users and the plugin, between steps.

pub(crate) mod blade;
pub mod cut;
pub(crate) mod elements;
pub mod frayed_edges;
pub(crate) mod piece_topology;
pub mod pieces;
pub(crate) mod split;
pub(crate) mod stroke;
pub mod tear;
pub(crate) mod tether_crossing;
pub mod torn_topology;
