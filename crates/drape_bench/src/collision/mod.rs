//! Collision detection of balls against a cloth by five methods: the comparison of Table 1 of the founding paper.
//!
//! All methods answer the same two questions about the same states. At the start of a step: which faces could a ball meet
//! within it ([`Method::begin_step`])? In each substep: which faces does it overlap now, where, along which normal and
//! how deep ([`Method::find`])? All may use knowledge that the solver has for free from its pass over all particles: the box
//! around the cloth, and the greatest motion of particles and balls within the step.
//!
//! | module | method |
//! |---|---|
//! | [`ours`] | the code that the solver runs |
//! | [`feature`] | a closest-feature query for each candidate pair |
//! | [`uniform_grid`] | spatial decomposition |
//! | [`object_space`] | a bounding-volume tree of the cloth |
//! | [`sweep_and_prune`] | sweep and prune, then GJK with cached separating axes, as in SOLID 2.0 |
//! | [`brute_force`] | every face, in double precision: the reference for the others |
//!
//! Imports nothing of this crate. Called by the experiment `table1`.

pub mod brute_force;
pub mod closest_feature;
pub mod feature;
pub mod method;
pub mod methods;
pub mod object_space;
pub mod ours;
pub mod state;
pub mod sweep_and_prune;
pub mod uniform_grid;

pub use method::{Contact, Method, Pair};
pub use methods::all;
pub use state::{Sphere, State};
