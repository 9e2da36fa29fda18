//! Columns of sixteen lanes, and the instruction sets that kernels run on.
//!
//! ```
//! use drape_solver::{BodySettings, ClothBuilder, Environment, Isa, Island, StateHasher, step};
//!
//! let sheet = ClothBuilder::new(1.0, 1.0, 16, 16).build(BodySettings::default())?;
//! let mut hashes = Isa::available().into_iter().map(|isa| {
//!     let mut island = Island { isa, ..Island::of_body(sheet.clone()) };
//!     step(&mut island, &Environment::default()).expect("its settings are valid");
//!     StateHasher::new().particles(&island.bodies[0].particles).finish()
//! });
//! // The bits do not depend on the instruction set.
//! let first = hashes.next();
//! assert!(hashes.all(|hash| Some(hash) == first));
//! # Ok::<(), drape_solver::BuildError>(())
//! ```
//!
//! Imports: nothing. Callers: every kernel.

pub(crate) mod cell_columns;
pub(crate) mod columns;
pub mod isa;
pub(crate) mod lanes;
#[cfg(test)]
pub(crate) mod miri;
pub(crate) mod rows;
pub(crate) mod transpose;
